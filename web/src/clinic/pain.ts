import { h, setAttribute } from '../console/dom';
import { fill } from '../shared/i18n';
import { texts } from './i18n';

export type PainTime = 'before' | 'after';
export type Pain = number | null;

/** Pain in words: 0 is an answer and differs from "not asked". */
export const painWords = (pain: Pain | undefined): string => (pain === null || pain === undefined ? texts().pain.unasked : String(pain));

/** Buttons for pain from 0 to 10, or "not asked". */
export class PainChoice {
  readonly element: HTMLElement;
  private readonly buttons: readonly HTMLButtonElement[];

  constructor(when: PainTime, private chosen: Pain, private readonly onChoice: (pain: Pain) => void) {
    const t = texts().pain;
    this.buttons = ([null, ...Array.from({ length: 11 }, (_, n) => n)] as Pain[]).map((pain) => {
      const words = pain === null ? t.notAsked : String(pain);
      return h('button', { type: 'button', class: 'b', 'data-testid': `pain-${when}-${pain ?? 'none'}`, 'aria-label': pain === null ? t.notAsked : fill(t.of, { n: pain }), onclick: () => this.choose(pain) }, words);
    });
    this.element = h('div', { class: 'pain', role: 'group', 'aria-label': t[when] }, ...this.buttons);
    this.show();
  }

  private choose(pain: Pain): void {
    this.chosen = pain;
    this.show();
    this.onChoice(pain);
  }

  private show(): void {
    this.buttons.forEach((button, i) => setAttribute(button, 'aria-pressed', String((i === 0 ? null : i - 1) === this.chosen)));
  }
}
