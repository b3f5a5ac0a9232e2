// A press is shown at once, before the program has answered, and even if it never does.
const SHOWN_MS = 300;

/** Shows a button as pressed for a moment. */
export function showPressed(button: Element): void {
  button.classList.add('pressed');
  setTimeout(() => button.classList.remove('pressed'), SHOWN_MS);
}

/** Shows presses on every button below `root`, by pointer and by key. */
export function answerPresses(root: Document): void {
  const answer = (event: Event): void => {
    const button = event.target instanceof Element ? event.target.closest('button') : null;
    if (button && !button.disabled) showPressed(button);
  };
  root.addEventListener('pointerdown', answer);
  root.addEventListener('click', answer);
}
