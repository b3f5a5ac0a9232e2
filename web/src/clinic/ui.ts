import { h, say } from '../console/dom';
import type { EventT } from '../protocol';
import { fill } from '../shared/i18n';
import { Refused, Silent } from './api';
import { texts } from './i18n';
import { hashOf, type Route } from './routes';

/** A part of the page that fills it below the header. */
export interface Screen {
  readonly element: HTMLElement;
  /** Who and what for the header; names only while they may be shown. */
  readonly who?: () => readonly [string, string];
  readonly what?: () => readonly [string, string];
  /** Whether Start may be pressed here; without it there is no Start. */
  readonly startable?: () => boolean;
  /** It shows what is shown once: the page leaves it alone. */
  readonly stays?: boolean;
  refresh?(): void;
  draw?(): void;
  /** What the station renders and says, for screens that show it. */
  sceneChanged?(): void;
  take?(events: readonly EventT[]): void;
  close?(): void;
}

/** Why something was refused, in the person's language where it has words for it. */
export function problemWords(problem: unknown): string {
  const t = texts();
  if (problem instanceof Silent) return t.silentNow;
  if (!(problem instanceof Refused)) return String(problem);
  const own = t.refusals[problem.code];
  const values = Object.fromEntries(Object.entries({ ...problem.more, why: problem.why }).map(([key, value]) => [key, String(value)]));
  return own ? fill(own, values) : problem.why;
}

export function button(words: string, test: string, press: () => unknown, kind = ''): HTMLButtonElement {
  return h('button', { type: 'button', class: `b ${kind}`.trim(), 'data-testid': test, onclick: () => void press() }, words);
}

export const link = (words: string, to: Route, test = ''): HTMLElement => h('a', { class: 'b', href: hashOf(to), ...(test === '' ? {} : { 'data-testid': test }) }, words);

export function panel(title: string, kind: string, ...children: (Node | string | null)[]): HTMLElement {
  return h('section', { class: `panel ${kind}`.trim(), 'aria-label': title }, h('div', { class: 'hd' }, h('h2', {}, title)), ...children);
}

/** Adds to the line of a panel's title. */
export function besideTitle(of: HTMLElement, ...parts: (Node | null)[]): HTMLElement {
  of.querySelector('.hd')!.append(...parts.filter((part): part is Node => part !== null));
  return of;
}

/** A place where a refusal is said. It is there from the start, so that a screen reader hears it. */
export class Said {
  readonly element = h('p', { class: 'said', role: 'alert' });
  say(words: string): void { say(this.element, words); }
  problem(problem: unknown): void { this.say(problemWords(problem)); }
}

let fieldNumber = 0;

/** A field with its name above and what is wrong with it below. */
export class Field<Input extends HTMLInputElement | HTMLTextAreaElement | HTMLSelectElement = HTMLInputElement> {
  readonly element: HTMLElement;
  private readonly wrong: HTMLElement;

  constructor(words: string, readonly input: Input, { hint = '', wide = false }: { readonly hint?: string; readonly wide?: boolean } = {}) {
    const id = `field-${fieldNumber += 1}`;
    input.id = id;
    this.wrong = h('span', { class: 'wrong', id: `${id}-wrong`, role: 'alert' });
    input.setAttribute('aria-describedby', `${id}-wrong`);
    this.element = h('div', { class: wide ? 'field wide' : 'field' }, h('label', { for: id }, words, hint === '' ? null : h('small', {}, ` ${hint}`)), input, this.wrong);
  }

  /** Says what is wrong; nothing, that nothing is. What was typed stays. */
  refuse(words: string): void {
    say(this.wrong, words);
    this.input.setAttribute('aria-invalid', String(words !== ''));
  }
}

export const textInput = (test: string, value = '', attributes: Readonly<Record<string, string | number | boolean>> = {}): HTMLInputElement =>
  h('input', { type: 'text', class: 'in', 'data-testid': test, value, autocomplete: 'off', spellcheck: 'false', ...attributes });

/** Lets a button act once at a time; it stays where it is and says that it works. */
export async function once(of: HTMLButtonElement, act: () => Promise<void>): Promise<void> {
  if (of.getAttribute('aria-busy') === 'true') return;
  of.setAttribute('aria-busy', 'true');
  try { await act(); } finally { of.removeAttribute('aria-busy'); }
}

/** What cannot be taken back is pressed twice; `sure` says what the second press does. */
export function twice(words: string, sure: string, test: string, said: Said, act: () => Promise<unknown>, then: () => void): HTMLButtonElement {
  const press = button(words, test, () => {
    const yes = button(sure, `${test}-yes`, () => once(yes, async () => {
      try {
        await act();
        yes.replaceWith(press);
        then();
      } catch (problem) { said.problem(problem); }
    }), 'danger');
    press.replaceWith(yes);
    yes.focus();
  });
  return press;
}
