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

  /** @param look class of a button */
  constructor(look: string, answer: (chosen: Chosen) => void) {
    this.buttons = ([1, 2] as const).map((chosen) => h('button', { class: look, type: 'button', 'data-testid': `answer-${chosen}`, onclick: () => answer(chosen) }));
    this.element = h('div', { class: 'answers', hidden: true }, ...this.buttons);
  }

  /** @param may whether an answer is accepted from here */
  show(panel: ExercisePanel, state: WorldStateT, may: boolean): void {
    this.element.hidden = !may || !panel.answering(state);
    setText(this.buttons[0]!, text('answer.first'));
    setText(this.buttons[1]!, text('answer.second'));
  }
}
