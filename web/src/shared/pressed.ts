// A press is seen at once: before the program has answered, and whether or not it does.
const SHOWN_MS = 300;

/** Shows a button as pressed for a moment. */
export function showPressed(button: Element): void {
  button.classList.add('pressed');
  setTimeout(() => button.classList.remove('pressed'), SHOWN_MS);
}

/** Every button below, by pointer and by key. */
export function answerPresses(root: Document): void {
  const answer = (event: Event): void => {
    const button = event.target instanceof Element ? event.target.closest('button') : null;
    if (button && !button.disabled) showPressed(button);
  };
  root.addEventListener('pointerdown', answer);
  root.addEventListener('click', answer);
}
