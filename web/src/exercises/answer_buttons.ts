// The answers of an exercise that compares two things, shown while it waits for one (value "answering").
import type { WorldStateT } from '../protocol';
import { h, setText } from '../shared/dom';
import { text } from '../shared/i18n';
import type { ExercisePanel } from './panel';

/** The first or the second was more. */
export type Chosen = 1 | 2;

/** Keys of the first and the second, `KeyboardEvent.code`. */
const KEYS: readonly (readonly string[])[] = [['Digit1', 'Numpad1'], ['Digit2', 'Numpad2']];

const isTypedInto = (target: EventTarget | null): boolean => target instanceof Element && target.closest('input, select, textarea, [contenteditable]') !== null;

/** Two buttons, and the keys 1 and 2. */
export class AnswerButtons {
  readonly element: HTMLElement;
  private readonly buttons: readonly HTMLButtonElement[];

  /** @param look class of a button */
  constructor(look: string, answer: (chosen: Chosen) => void) {
    this.buttons = ([1, 2] as const).map((chosen) => h('button', { class: look, type: 'button', 'data-testid': `answer-${chosen}`, 'aria-keyshortcuts': String(chosen), onclick: () => answer(chosen) }, h('span'), ' ', h('kbd', {}, String(chosen))));
    this.element = h('div', { class: 'answers', hidden: true }, ...this.buttons);
    const press = (event: KeyboardEvent): void => {
      if (!this.element.isConnected) return document.removeEventListener('keydown', press);   // the page has replaced it
      const chosen = KEYS.findIndex((codes) => codes.includes(event.code));
      if (chosen < 0 || this.element.hidden || event.repeat || event.ctrlKey || event.altKey || event.metaKey || isTypedInto(event.target)) return;
      answer(chosen === 0 ? 1 : 2);
    };
    document.addEventListener('keydown', press);
  }

  /** @param may whether an answer is accepted from here */
  show(panel: ExercisePanel, state: WorldStateT, may: boolean): void {
    this.element.hidden = !may || !panel.answering(state);
    for (const [i, key] of (['answer.first', 'answer.second'] as const).entries()) setText(this.buttons[i]!.firstElementChild!, text(key));
  }
}
