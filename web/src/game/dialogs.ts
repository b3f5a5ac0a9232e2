// What lies over the play: welcome, praise, help, and what to say when something is in the way.
import { trapFocus } from '../shared/a11y';
import { h } from '../shared/dom';
import { hasText, language, LANGUAGES, nameOf, text, type Language, type TextKey } from '../shared/i18n';
import { buttonPicture, cupPicture, octagonPicture, plugPicture, starPicture, stepPicture } from './pictures';
import { clock, type Praise } from './view';

export type Tone = 'porcelain' | 'honey' | 'bronze' | 'umber' | 'glove';
export const TONES: Readonly<Record<Tone, string>> = { porcelain: '#EBC3A6', honey: '#CF9F80', bronze: '#A86C46', umber: '#6E4430', glove: '#DCE5E6' };

export interface HelpSection { readonly way: string; readonly name: string; readonly lines: readonly { readonly keys: readonly string[]; readonly does: string }[] }

/** One thing at a time lies over the play. It has the focus, but for what stays reachable beside it. */
export class Overlay {
  private release: (() => void) | null = null;
  private onEscape: (() => void) | null = null;
  private readonly element = h('div', { class: 'overlay', hidden: true });

  /** `beside`: the strip with Stop, which stays reachable from every dialog that does not cover it. */
  constructor(root: HTMLElement, private readonly beside: HTMLElement) {
    root.append(this.element);
    document.addEventListener('keydown', (event) => { if (event.key === 'Escape') this.onEscape?.(); });
  }

  open(kind: string, card: HTMLElement, options: { first?: HTMLElement | null; alone?: boolean; onEscape?: () => void } = {}): void {
    const had = this.element.contains(document.activeElement);
    if (had) (document.activeElement as HTMLElement).blur();
    this.release?.();
    this.element.className = `overlay ${kind}`;
    this.element.replaceChildren(card);
    this.element.hidden = false;
    this.onEscape = options.onEscape ?? null;
    this.release = trapFocus(options.alone ? [this.element] : [this.element, this.beside], options.first ?? card);
  }

  /** The focus goes back, or to the play. */
  close(focus: HTMLElement): void {
    if (this.element.hidden) return;
    this.release?.();
    this.release = this.onEscape = null;
    this.element.hidden = true;
    this.element.replaceChildren();
    focus.focus();
  }
}

const pressable = (label: string, pressed: boolean, onclick: () => void, extra: Record<string, string> = {}): HTMLButtonElement =>
  h('button', { type: 'button', class: 'choice', 'aria-pressed': String(pressed), onclick, ...extra }, label);

/** What the keys of a way do, as a list. */
export function helpList(section: HelpSection): HTMLElement {
  return h('ul', { class: 'help-list t-s' }, ...section.lines.map((line) =>
    h('li', {}, ...line.keys.map((key) => h('kbd', {}, key)), ` ${line.does}`)));
}

export interface WelcomeContent {
  readonly ways: readonly HelpSection[];
  readonly way: string;
  readonly robot: boolean;            // a real device is there
  readonly levels: number;
  readonly level: number;
  readonly tone: Tone;
  readonly notice: string;
}

export interface WelcomeActions {
  start(): void;
  watch(): void;
  language(wanted: Language): void;
  way(wanted: string): void;
  level(wanted: number): void;
  tone(wanted: Tone): void;
}

export function levelName(level: number): string {
  const key = `level.${level}`;
  return hasText(key) ? text(key) : '';
}

export function welcomeCard(content: WelcomeContent, actions: WelcomeActions): { card: HTMLElement; start: HTMLButtonElement } {
  const start = h('button', { type: 'button', class: 'button go t-m', 'data-testid': 'start', onclick: actions.start }, text('welcome.start'));
  const steps = (['1', '2', '3'] as const).map((n, i) => h('li', { class: 'step' },
    stepPicture(i as 0 | 1 | 2, TONES[content.tone]),
    h('b', { class: 't-m' }, h('i', { 'aria-hidden': 'true' }, n), text(`welcome.step${n}`)),
    h('span', { class: 't-s' }, text(`welcome.step${n}More`))));
  const chosen = content.ways.find((section) => section.way === content.way);
  const ways = content.ways.map((section) => pressable(section.name, section.way === content.way, () => actions.way(section.way), { 'data-way': section.way }));
  if (content.robot) ways.unshift(pressable(text('welcome.robot'), content.way === 'robot', () => actions.way('robot'), { 'data-way': 'robot' }));
  const levels = Array.from({ length: content.levels }, (_, i) => i + 1).map((level) =>
    pressable(String(level), level === content.level, () => actions.level(level), { 'aria-label': `${text('welcome.level')} ${level}, ${levelName(level)}`, 'data-level': String(level) }));
  const tones = (Object.keys(TONES) as Tone[]).map((tone) => {
    const button = h('button', { type: 'button', class: 'tone', 'aria-pressed': String(tone === content.tone), 'aria-label': text(`tone.${tone}`), 'data-tone': tone, onclick: () => actions.tone(tone) });
    button.style.backgroundColor = TONES[tone];
    return button;
  });
  const card = h('section', { class: 'card welcome', role: 'dialog', 'aria-labelledby': 'welcome-title', tabindex: -1, 'data-testid': 'welcome' },
    h('header', {},
      h('div', {}, h('h1', { id: 'welcome-title', class: 't-xl' }, text('welcome.title')), h('p', { class: 't-s soft' }, text('welcome.lead'))),
      h('div', { class: 'languages t-s', role: 'group', 'aria-label': 'Sprache · Langue · Language' },
        ...LANGUAGES.map((l) => h('button', { type: 'button', lang: l, 'aria-pressed': String(l === language()), 'data-lang': l, onclick: () => actions.language(l) }, l.toUpperCase())))),
    h('ol', { class: 'steps' }, ...steps),
    h('div', { class: 'line how t-s', role: 'group', 'aria-labelledby': 'welcome-how' }, h('h2', { id: 'welcome-how', class: 't-m' }, text('welcome.how')), ...ways),
    chosen ? helpList(chosen) : h('p', { class: 'help-list t-s' }, text('welcome.robotHint')),
    h('div', { class: 'line t-s apart' },
      h('div', { class: 'line', role: 'group', 'aria-labelledby': 'welcome-level' }, h('h2', { id: 'welcome-level', class: 't-m' }, text('welcome.level')), ...levels, h('span', { class: 'soft' }, levelName(content.level))),
      h('div', { class: 'line', role: 'group', 'aria-labelledby': 'welcome-tone' }, h('h2', { id: 'welcome-tone', class: 't-m' }, text('welcome.tone')), ...tones)),
    h('div', { class: 'actions' }, start,
      h('button', { type: 'button', class: 'button plain t-m', 'data-testid': 'watch', onclick: actions.watch }, text('welcome.watch')),
      h('p', { class: 't-s notice', role: 'alert' }, content.notice)));
  return { card, start };
}

/** A large picture, a title, what happened, and what it means for the person. */
function messageCard(picture: SVGElement, title: string, what: string, soft: string, ...more: (HTMLElement | null)[]): HTMLElement {
  return h('section', { class: 'card message', role: 'alertdialog', 'aria-labelledby': 'message-title', 'aria-describedby': 'message-what', tabindex: -1 },
    picture, h('div', {}, h('h1', { id: 'message-title', class: 't-xl' }, title), h('p', { id: 'message-what', class: 't-m' }, what), h('p', { class: 't-m soft' }, soft)),
    ...more);
}

const dots = (attempts: number): HTMLElement => {
  const lit = attempts <= 0 ? 1 : ((attempts - 1) % 4) + 1;
  return h('p', { class: 'retry t-s' },
    h('span', { class: 'dots', 'aria-hidden': 'true' }, ...[1, 2, 3, 4].map((n) => h('i', { class: n <= lit ? 'on' : '' }))),
    text('lost.retry'));
};

/** `hardware`: only then is there a button on the robot to speak of. */
export function lostCard(attempts: number, hardware: boolean): HTMLElement {
  return messageCard(plugPicture(), text('lost.title'), text('lost.what'), text('lost.soft'), dots(attempts),
    hardware ? h('p', { class: 'hardware t-s', 'data-testid': 'hardware' }, buttonPicture(), text('lost.button')) : null);
}

/** `refusedWith`: 401 or 403 where the program is there but does not let this page in. */
export function absentCard(attempts: number, refusedWith: number): HTMLElement {
  if (refusedWith > 0) return messageCard(plugPicture(), text('refused.title'), text(refusedWith === 401 ? 'refused.token' : 'refused.origin'), text('refused.soft'));
  return messageCard(plugPicture(), text('absent.title'), text('absent.what'), text('absent.soft'), dots(attempts));
}

export function versionCard(ours: number, theirs: number): HTMLElement {
  return messageCard(plugPicture(), text('version.title'), text('version.what', { a: ours, b: theirs }), text('version.soft'));
}

/** `cause`: of a fault, in the program's words; empty after somebody pressed stop. */
export function stoppedCard(cause: string): HTMLElement {
  const link = h('a', { class: 'console-link t-s', href: `/console${location.search}${location.hash}`, 'data-testid': 'console-link' }, text('stopped.console'));
  const card = messageCard(octagonPicture(), text(cause ? 'faulted.title' : 'stopped.title'), text('stopped.what'), text('stopped.soft'),
    cause ? h('p', { class: 'retry t-s', 'data-testid': 'cause' }, text('faulted.why', { x: cause })) : null, h('p', { class: 'links' }, link));
  card.classList.add('stopped');
  return card;
}

export function restCard(goOn: () => void): { card: HTMLElement; first: HTMLElement } {
  const first = h('button', { type: 'button', class: 'button go t-m', 'data-testid': 'go-on', onclick: goOn }, text('game.back'));
  return { card: messageCard(cupPicture(), text('rest.title'), text('rest.more'), '', h('p', { class: 'links' }, first)), first };
}

/** The controls are gone, and only a press takes them again. `notice`: why that did not work. */
export function leftCard(loss: 'left' | 'unheard', notice: string, goOn: () => void): { card: HTMLElement; first: HTMLElement } {
  const first = h('button', { type: 'button', class: 'button go t-m', 'data-testid': 'take-again', onclick: goOn }, text('game.back'));
  const card = messageCard(cupPicture(), text(`${loss}.title`), text(`${loss}.what`), text('rest.more'), h('p', { class: 'links' }, first),
    notice ? h('p', { class: 'notice t-s', role: 'alert' }, notice) : null);
  card.dataset.testid = 'left';
  return { card, first };
}

export interface PraiseActions { next(): void; nextLevel(): void; again(): void; rest(): void }

/** `more`: there is a level after this one. */
export function praiseCard(praise: Praise, more: boolean, actions: PraiseActions): { card: HTMLElement; first: HTMLElement } {
  const button = (kind: string, key: TextKey, testid: string, onclick: () => void) => h('button', { type: 'button', class: `button ${kind} t-m`, 'data-testid': testid, onclick }, text(key));
  const first = !praise.levelDone ? button('go', 'success.next', 'next', actions.next)
    : more ? button('go', 'success.nextLevel', 'next-level', actions.nextLevel) : button('go', 'success.again', 'again', actions.again);
  const figures: [TextKey, string, string][] = [
    ['success.filled', `${praise.filled_percent} %`, 'filled'],
    ['success.spilt', text('game.ml', { a: praise.spilt_ml }), 'spilt'],
    ['success.time', clock(praise.time_s), 'time'],
  ];
  const stars = [1, 2, 3].map((n) => { const star = starPicture(); star.classList.toggle('on', n <= praise.stars); return star; });
  const card = h('section', { class: 'card praise', role: 'dialog', 'aria-labelledby': 'praise-title', tabindex: -1, 'data-testid': 'success' },
    h('div', { class: 'stars', role: 'img', 'aria-label': text('success.stars', { a: praise.stars }) }, ...stars as unknown as HTMLElement[]),
    h('h1', { id: 'praise-title', class: 't-xl' }, text('success.title')),
    h('p', { class: 't-m soft' }, praise.levelDone ? text('success.level') : text('success.ready', { x: nameOf('drink', praise.drink) })),
    h('dl', {}, ...figures.map(([key, value, testid]) => h('div', {}, h('dt', { class: 't-s' }, text(key)), h('dd', { class: 't-m', 'data-testid': testid }, value)))),
    h('div', { class: 'actions' }, first, button('plain', 'success.rest', 'rest', actions.rest)));
  return { card, first };
}

export function helpCard(ways: readonly HelpSection[], close: () => void): { card: HTMLElement; first: HTMLElement } {
  const first = h('button', { type: 'button', class: 'button go t-m', 'data-testid': 'close-help', onclick: close }, text('game.back'));
  const card = h('section', { class: 'card help', role: 'dialog', 'aria-labelledby': 'help-title', tabindex: -1, 'data-testid': 'help-card' },
    h('header', {}, h('h1', { id: 'help-title', class: 't-l' }, text('game.help')), first),
    h('div', { class: 'sections', tabindex: 0, role: 'group', 'aria-labelledby': 'help-title' }, ...ways.map((section) => h('section', {}, h('h2', { class: 't-m' }, section.name), helpList(section)))));
  return { card, first };
}

/** Said where the bar cannot be drawn; the words go on. */
export function noPictureCard(): HTMLElement {
  return h('section', { class: 'card nopicture', role: 'note', 'data-testid': 'nopicture' }, h('h2', { class: 't-l' }, text('webgl.title')), h('p', { class: 't-s' }, text('webgl.what')));
}
