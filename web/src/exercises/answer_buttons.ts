// The answers of an exercise that compares two things, shown while it waits for one (value "answering").
import type { WorldStateT } from '../protocol';
import { h, setText } from '../shared/dom';
import { text } from '../shared/i18n';
import type { ExercisePanel } from './panel';

/** The first or the second was more. */
export type Chosen = 1 | 2;

export class AnswerButtons {
  readonly element: HTMLElement;
  private readonly buttons: readonly HTMLButtonElement[];

  constructor(answer: (chosen: Chosen) => void) {
    this.buttons = ([1, 2] as const).map((chosen) => h('button', { class: 'button', type: 'button', 'data-testid': `answer-${chosen}`, onclick: () => answer(chosen) }));
    this.element = h('div', { class: 'answers', hidden: true }, ...this.buttons);
  }

  show(panel: ExercisePanel, state: WorldStateT): void {
    this.element.hidden = !panel.answering(state);
    setText(this.buttons[0]!, text('answer.first'));
    setText(this.buttons[1]!, text('answer.second'));
  }
}
