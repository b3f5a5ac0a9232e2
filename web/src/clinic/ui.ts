import { h, setText } from '../console/dom';
import type { EventT } from '../protocol';
import { fill } from '../shared/i18n';
import { RefusalError, NoAnswerError } from './api';
import { texts } from './i18n';
import { hashOf, type Route } from './routes';

/** A screen of the page below the header. */
export interface Screen {
  readonly element: HTMLElement;
  /** Two lines for the header, person and exercise; names only while they may be shown. */
  readonly who?: () => readonly [string, string];
  readonly what?: () => readonly [string, string];
  /** Whether Start may be pressed; a screen without this has no Start. */
  readonly startable?: () => boolean;
  /** The screen shows something that appears only once: the page does not replace it. */
  readonly stays?: boolean;
  refresh?(): void;
  draw?(): void;
  /** Notifications of the station's scene and events, for screens that show them. */
  sceneChanged?(): void;
  take?(events: readonly EventT[]): void;
  close?(): void;
}

/** The reason of a refusal, in the page's language where it has a translation. */
export function problemWords(problem: unknown): string {
  const t = texts();
  if (problem instanceof NoAnswerError) return t.silentNow;
  if (!(problem instanceof RefusalError)) return String(problem);
  const own = t.refusals[problem.code];
  const values = Object.fromEntries(Object.entries({ ...problem.more, why: problem.why }).map(([key, value]) => [key, String(value)]));
  return own ? fill(own, values) : problem.why;
}

export function button(words: string, test: string, press: () => unknown, kind = '', attributes: Readonly<Record<string, string | boolean>> = {}): HTMLButtonElement {
  return h('button', { type: 'button', class: `b ${kind}`.trim(), 'data-testid': test, onclick: () => void press(), ...attributes }, words);
}

export const link = (words: string, to: Route, test = ''): HTMLElement => h('a', { class: 'b', href: hashOf(to), ...(test === '' ? {} : { 'data-testid': test }) }, words);

export function panel(title: string, kind: string, ...children: (Node | string | null)[]): HTMLElement {
  return h('section', { class: `panel ${kind}`.trim(), 'aria-label': title }, h('div', { class: 'hd' }, h('h2', {}, title)), ...children);
}

/** Adds elements to the title line of a panel. */
export function besideTitle(of: HTMLElement, ...parts: (Node | null)[]): HTMLElement {
  of.querySelector('.hd')!.append(...parts.filter((part): part is Node => part !== null));
  return of;
}

/** A place for error messages. It exists from the start, so that a screen reader announces changes. */
export class StatusMessage {
  readonly element = h('p', { class: 'said', role: 'alert' });
  show(words: string): void { setText(this.element, words); }
  showProblem(problem: unknown): void { this.show(problemWords(problem)); }
}

/** Draws an element again; the control that has the focus keeps it. */
export function redraw(of: HTMLElement, ...children: (Node | string)[]): void {
  const focused = of.contains(document.activeElement) ? document.activeElement?.getAttribute('data-testid') : undefined;
  of.replaceChildren(...children);
  if (focused) of.querySelector<HTMLElement>(`[data-testid="${focused}"]`)?.focus();
}

let fieldNumber = 0;

/** An input with its label above and an error message below. */
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

  /** Shows an error; an empty text clears it. Typed text is kept. */
  refuse(words: string): void {
    setText(this.wrong, words);
    this.input.setAttribute('aria-invalid', String(words !== ''));
  }
}

export const textInput = (test: string, value = '', attributes: Readonly<Record<string, string | number | boolean>> = {}): HTMLInputElement =>
  h('input', { type: 'text', class: 'in', 'data-testid': test, value, autocomplete: 'off', spellcheck: 'false', ...attributes });

/** Lets a button act once at a time; the button stays in place and is marked as busy. */
export async function once(of: HTMLButtonElement, act: () => Promise<void>): Promise<void> {
  if (of.getAttribute('aria-busy') === 'true') return;
  of.setAttribute('aria-busy', 'true');
  try { await act(); } finally { of.removeAttribute('aria-busy'); }
}

/** Acts; the reason of a failure is shown. */
export async function tried(message: StatusMessage, act: () => unknown): Promise<void> {
  try { await act(); } catch (problem) { message.showProblem(problem); }
}

/** A button that acts once at a time; the reason of a failure is shown. */
export function action(words: string, test: string, message: StatusMessage, act: () => unknown, kind = ''): HTMLButtonElement {
  const press = button(words, test, () => once(press, () => tried(message, act)), kind);
  return press;
}

export const submitButton = (words: string, test: string, kind = ''): HTMLButtonElement => h('button', { type: 'submit', class: `b ${kind}`.trim(), 'data-testid': test }, words);

/** A form that is sent once at a time, by its button or by Enter; the reason of a failure is shown. */
export function form(attributes: Readonly<Record<string, string | boolean>>, submit: HTMLButtonElement, message: StatusMessage, act: () => Promise<void>, ...children: (Node | null)[]): HTMLFormElement {
  return h('form', { ...attributes, onsubmit: (event) => { event.preventDefault(); void once(submit, () => tried(message, act)); } }, ...children);
}

/** Marks every field that has a mistake, and focuses the first one. @return whether there is one */
export function refused(...fields: readonly (readonly [field: Field, mistake: string])[]): boolean {
  for (const [field, mistake] of fields) field.refuse(mistake);
  const first = fields.find(([, mistake]) => mistake !== '');
  first?.[0].input.focus();
  return first !== undefined;
}

/** A button for an action that cannot be undone: it needs a second press. @param sure the label of the second press */
export function twice(words: string, sure: string, test: string, message: StatusMessage, act: () => Promise<unknown>, then: () => void): HTMLButtonElement {
  const press = button(words, test, () => {
    const yes = action(sure, `${test}-yes`, message, async () => {
      await act();
      yes.replaceWith(press);
      then();
    }, 'danger');
    press.replaceWith(yes);
    yes.focus();
  });
  return press;
}
