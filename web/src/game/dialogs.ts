// Builds the cards over the play: welcome, praise, help, and messages about interruptions.
import { trapFocus } from '../shared/a11y';
import { TONES, type ToneName as Tone } from '../hand/tones';
import { HELPS, type Help } from '../input/wish';
import { h } from '../shared/dom';
import { FreshButtons } from '../shared/fresh_buttons';
import { FIRST } from '../exercises';
import type { ExerciseWords, Praise } from '../exercises/exercise';
import { language, LANGUAGES, text, type Language, type TextKey } from '../shared/i18n';
import { buttonPicture, cupPicture, octagonPicture, plugPicture, starPicture } from './pictures';
import { TEXT_SIZES, type Side, type TextSize } from './memory';
import { MUSIC_VOLUMES, type MusicVolume } from './sound';

export interface HelpSection { readonly way: string; readonly name: string; readonly lines: readonly { readonly keys: readonly string[]; readonly does: string }[] }

/** Holds the card over the play, and keeps the focus in it and in the controls that stay reachable beside it. */
export class Overlay {
  private release: (() => void) | null = null;
  private onEscape: (() => void) | null = null;
  private readonly element = h('div', { class: 'overlay', hidden: true });
  private readonly fresh = new FreshButtons(this.element, 'Space');
  private buttons = '';

  /**
   * @param beside the strip with Stop, reachable from every card that does not cover it
   * @param otherwise the action of Escape if no open card closes by it
   */
  constructor(root: HTMLElement, private readonly beside: HTMLElement, otherwise: () => void) {
    root.append(this.element);
    document.addEventListener('keydown', (event) => { if (event.key === 'Escape' && !event.repeat) (this.onEscape ?? otherwise)(); });
  }

  open(kind: string, card: HTMLElement, options: { first?: HTMLElement | null; alone?: boolean; onEscape?: () => void } = {}): void {
    const had = this.element.contains(document.activeElement);
    if (had) (document.activeElement as HTMLElement).blur();
    this.release?.();
    this.element.className = `overlay ${kind}`;
    this.element.replaceChildren(card);
    const buttons = JSON.stringify([...card.querySelectorAll('button')].map(({ textContent }) => textContent));
    if (this.element.hidden || buttons !== this.buttons) this.fresh.changed();
    this.buttons = buttons;
    this.element.hidden = false;
    this.onEscape = options.onEscape ?? null;
    this.release = trapFocus(options.alone ? [this.element] : [this.element, this.beside], options.first ?? card);
  }

  /** Shows the number of connection attempts on a card that waits for the program. */
  showAttempts(attempts: number): void { showAttempts(this.element, attempts); }

  /** Closes the card and moves the focus. */
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

/** A list of the keys of an input method, and their effects. */
function helpList(section: HelpSection, more = ''): HTMLElement {
  return h('ul', { class: 'help-list t-s' }, ...section.lines.map((line) =>
    h('li', {}, ...line.keys.map((key) => h('kbd', {}, key)), ` ${line.does}`)), more ? h('li', {}, more) : null);
}

export interface WelcomeContent {
  readonly ways: readonly HelpSection[];
  readonly way: string;
  readonly robot: boolean;            // a real device is connected
  readonly levels: number;            // number of levels to choose from; 0: a therapist chooses
  readonly level: number;
  readonly tone: Tone;
  readonly textSize: TextSize;
  readonly help: Help | null;  // null: the therapist has set it
  readonly connected: boolean;        // the program hears the page: the buttons act
  readonly notice: string;
  readonly words: ExerciseWords;
}

export interface WelcomeActions {
  start(): void;
  watch(): void;
  language(wanted: Language): void;
  way(wanted: string): void;
  level(wanted: number): void;
  tone(wanted: Tone): void;
  textSize(wanted: TextSize): void;
  help(wanted: Help): void;
}

/** The steps of the exercise with their pictures; null where it has none. */
function stepList({ words, tone }: WelcomeContent): HTMLElement | null {
  const steps = words.steps(TONES[tone].base).map(({ picture, title, more }, i) => h('li', { class: 'step' }, picture,
    h('b', { class: 't-m' }, h('i', { 'aria-hidden': 'true' }, String(i + 1)), title), h('span', { class: 't-s' }, more)));
  return steps.length > 0 ? h('ol', { class: 'steps' }, ...steps) : null;
}

export function welcomeCard(content: WelcomeContent, actions: WelcomeActions): { card: HTMLElement; start: HTMLButtonElement } {
  const start = h('button', { type: 'button', class: 'button go t-m', 'data-testid': 'start', disabled: !content.connected, onclick: actions.start }, text('welcome.start'));
  const { words } = content;
  const chosen = content.ways.find((section) => section.way === content.way);
  const ways = content.ways.map((section) => pressable(section.name, section.way === content.way, () => actions.way(section.way), { 'data-way': section.way }));
  if (content.robot) ways.unshift(pressable(text('welcome.robot'), content.way === 'robot', () => actions.way('robot'), { 'data-way': 'robot' }));
  const levels = Array.from({ length: content.levels }, (_, i) => i + 1).map((level) =>
    pressable(String(level), level === content.level, () => actions.level(level), { 'aria-label': [`${text('welcome.level')} ${level}`, words.levelName(level)].filter(Boolean).join(', '), 'data-level': String(level) }));
  const helps = HELPS.map((help) => pressable(text(`help.${help}`), help === content.help, () => actions.help(help), { 'data-help': help }));
  const tones = (Object.keys(TONES) as Tone[]).map((tone) => {
    const button = h('button', { type: 'button', class: 'tone', 'aria-pressed': String(tone === content.tone), 'aria-label': text(`tone.${tone}`), 'data-tone': tone, onclick: () => actions.tone(tone) });
    button.style.backgroundColor = TONES[tone].base;
    return button;
  });
  const card = h('section', { class: 'card welcome', role: 'dialog', 'aria-labelledby': 'welcome-title', tabindex: -1, 'data-testid': 'welcome' },
    h('header', {},
      h('div', {}, h('h1', { id: 'welcome-title', class: 't-xl' }, words.title()), h('p', { class: 't-s soft' }, words.lead())),
      h('div', { class: 'corner t-s' }, pressable(text('settings.textIs', { x: text('text.far') }), content.textSize === 'far', () => actions.textSize(content.textSize === 'far' ? 'normal' : 'far'), { 'data-large': 'text' }), h('div', { class: 'languages t-s', role: 'group', 'aria-label': 'Sprache · Langue · Language' },
        ...LANGUAGES.map((l) => h('button', { type: 'button', lang: l, 'aria-pressed': String(l === language()), 'data-lang': l, onclick: () => actions.language(l) }, l.toUpperCase()))))),
    stepList(content),
    h('div', { class: 'line how t-s', role: 'group', 'aria-labelledby': 'welcome-how' }, h('h2', { id: 'welcome-how', class: 't-m' }, text('welcome.how')), ...ways),
    h('div', { class: 'aid' }, chosen ? helpList(chosen, content.help === 'some' || content.help === 'none' ? text(`help.${content.help}More`) : '') : h('p', { class: 'help-list t-s' }, text('welcome.robotHint')),
      content.help && h('div', { class: 'line t-s', role: 'group', 'aria-labelledby': 'welcome-help' }, h('h2', { id: 'welcome-help', class: 't-m' }, text('welcome.help')), ...helps)),
    h('div', { class: 'line t-s apart' },
      content.levels < 2 ? null : h('div', { class: 'line', role: 'group', 'aria-labelledby': 'welcome-level' }, h('h2', { id: 'welcome-level', class: 't-m' }, text('welcome.level')), ...levels, h('span', { class: 'soft' }, words.levelName(content.level))),
      h('div', { class: 'line', role: 'group', 'aria-labelledby': 'welcome-tone' }, h('h2', { id: 'welcome-tone', class: 't-m' }, text('welcome.tone')), ...tones)),
    h('div', { class: 'actions' }, start,
      h('button', { type: 'button', class: 'button plain t-m', 'data-testid': 'watch', disabled: !content.connected, onclick: actions.watch }, text('welcome.watch')),
      content.connected
        ? h('p', { class: 't-s notice', role: 'alert' }, content.notice)
        : h('p', { class: 't-s soft', role: 'status' }, text('welcome.connecting'))));
  return { card, start };
}

/** A message card: a large picture, a title, what happened, and what it means for the person. */
function messageCard(picture: SVGElement, title: string, what: string, soft: string, ...more: (HTMLElement | null)[]): HTMLElement {
  return h('section', { class: 'card message', role: 'alertdialog', 'aria-labelledby': 'message-title', 'aria-describedby': 'message-what', tabindex: 0 },
    picture, h('div', {}, h('h1', { id: 'message-title', class: 't-xl' }, title), h('p', { id: 'message-what', class: 't-m' }, what), h('p', { class: 't-m soft' }, soft)),
    ...more);
}

const dots = (attempts: number): HTMLElement => {
  const row = h('p', { class: 'retry t-s' },
    h('span', { class: 'dots', 'aria-hidden': 'true' }, ...[1, 2, 3, 4].map(() => h('i'))),
    text('lost.retry'));
  showAttempts(row, attempts);
  return row;
};

/** Lights the dots of a card that waits for the program, without rebuilding it, so that the focus stays. */
export function showAttempts(within: ParentNode, attempts: number): void {
  const lit = attempts <= 0 ? 1 : ((attempts - 1) % 4) + 1;
  within.querySelectorAll('.dots i').forEach((dot, i) => dot.classList.toggle('on', i < lit));
}

/** @param hardware the device is real, and has a stop button that the card mentions */
export function lostCard(attempts: number, hardware: boolean): HTMLElement {
  return messageCard(plugPicture(), text('lost.title'), text('lost.what'), text('lost.soft'), dots(attempts), h('p', { class: 'waits t-s', 'data-testid': 'stop-waits' }, text('lost.stop')),
    hardware ? h('p', { class: 'hardware t-s', 'data-testid': 'hardware' }, buttonPicture(), text('lost.button')) : null);
}

/** @param refusedWith 401 or 403 where the program refuses this page */
export function absentCard(attempts: number, refusedWith: number): HTMLElement {
  if (refusedWith > 0) return messageCard(plugPicture(), text('refused.title'), text(refusedWith === 401 ? 'refused.token' : 'refused.origin'), text('refused.soft'));
  return messageCard(plugPicture(), text('absent.title'), text('absent.what'), text('absent.soft'), dots(attempts));
}

export function versionCard(ours: number, theirs: number): HTMLElement {
  return messageCard(plugPicture(), text('version.title'), text('version.what', { a: ours, b: theirs }), text('version.soft'));
}

/** What the loop has reported of a stop: nothing yet, that it obeys, that it has ended. Empty: no stop is shown. */
export type LettingGo = '' | 'heard' | 'letting' | 'let';

/** What is known of the effort after a stop. */
export function stoppedWords(letting: LettingGo): TextKey {
  return letting === 'heard' ? 'stopped.heard' : letting === 'letting' ? 'rest.letting' : 'stopped.what';
}

/** @param cause the fault in the program's words; empty after a press of Stop */
export function stoppedCard(letting: LettingGo, cause: string): HTMLElement {
  const link = h('a', { class: 'console-link t-s', href: `/console${location.search}${location.hash}`, 'data-testid': 'console-link' }, text('stopped.console'));
  const card = messageCard(octagonPicture(), text(cause ? 'faulted.title' : 'stopped.title'), text(stoppedWords(letting)), text('stopped.soft'),
    cause ? h('p', { class: 'retry t-s', 'data-testid': 'cause' }, text('faulted.why', { x: cause })) : null, h('p', { class: 'links' }, link));
  card.classList.add('stopped');
  return card;
}

/** The squeeze key does nothing on a button that goes on: who rests may lean on it. */
function notBySqueeze(press: HTMLButtonElement): HTMLButtonElement {
  for (const kind of ['keydown', 'keyup']) press.addEventListener(kind, (event) => { if ((event as KeyboardEvent).code === 'Space') event.preventDefault(); });
  return press;
}

/** @param off whether the device is being released, or is released @param notice why continuing failed */
export function restCard(off: LettingGo, notice: string, goOn: () => void): { card: HTMLElement; first: HTMLElement } {
  const first = notBySqueeze(h('button', { type: 'button', class: 'button go t-m', 'data-testid': 'go-on', disabled: off === 'letting' || off === 'heard', onclick: goOn }, text('game.back')));
  const card = messageCard(cupPicture(), text('rest.title'), text(off === 'letting' || off === 'heard' ? stoppedWords(off) : 'rest.more'), off === 'let' ? text('rest.anew') : '',
    h('p', { class: 'links' }, first), notice ? h('p', { class: 'notice t-s', role: 'alert' }, notice) : null);
  return { card, first };
}

/** The card between two exercises of a visit, and after it. @param stars those of the visit */
export function endedCard(words: string, stars: number): HTMLElement {
  const card = messageCard(cupPicture(), text('success.title'), words, stars > 0 ? text('ended.stars', { a: stars }) : '');
  card.dataset.testid = 'ended';
  return card;
}

/** The card after a loss of the controls; only a press takes them again. @param notice why that failed */
export function leftCard(loss: 'left' | 'unheard' | 'taken', notice: string, goOn: () => void): { card: HTMLElement; first: HTMLElement } {
  const first = notBySqueeze(h('button', { type: 'button', class: 'button go t-m', 'data-testid': 'take-again', onclick: goOn }, text('game.back')));
  const card = messageCard(loss === 'unheard' ? plugPicture() : cupPicture(), text(`${loss}.title`), text(`${loss}.what`), text('rest.more'), h('p', { class: 'links' }, first),
    notice ? h('p', { class: 'notice t-s', role: 'alert' }, notice) : null);
  card.dataset.testid = 'left';
  return { card, first };
}

/** The card after the browser lost the picture. The play waits until it is `back` and the person continues. */
export function unseenCard(back: boolean, goOn: () => void): { card: HTMLElement; first: HTMLElement } {
  const first = notBySqueeze(h('button', { type: 'button', class: 'button go t-m', 'data-testid': 'see-again', disabled: !back, onclick: goOn }, text('game.back')));
  const card = back ? messageCard(cupPicture(), text('webgl.backTitle'), text('rest.more'), '', h('p', { class: 'links' }, first))
    : messageCard(plugPicture(), text('webgl.lostTitle'), text('webgl.lostWhat'), text('webgl.lostSoft'), h('p', { class: 'links' }, first));
  card.dataset.testid = 'unseen';
  return { card, first };
}

export interface PraiseActions { next(): void; nextLevel(): void; again(): void; rest(): void }

/** @param more there is a next level @param starsSoFar includes those of this part */
export function praiseCard(praise: Praise, more: boolean, starsSoFar: number, actions: PraiseActions): { card: HTMLElement; first: HTMLElement } {
  const button = (kind: string, words: string, testid: string, onclick: () => void) => h('button', { type: 'button', class: `button ${kind} t-m`, 'data-testid': testid, onclick }, words);
  const first = !praise.levelDone ? button('go', praise.next, 'next', actions.next)
    : more ? button('go', text('success.nextLevel'), 'next-level', actions.nextLevel) : button('go', text('success.again'), 'again', actions.again);
  const card = h('section', { class: 'card praise', role: 'dialog', 'aria-labelledby': 'praise-title', 'aria-describedby': 'praise-lead', tabindex: -1, 'data-testid': 'success' },
    praise.stars === undefined ? null : starsHeader(praise.stars, starsSoFar),
    h('h1', { id: 'praise-title', class: 't-xl' }, text('success.title')),
    h('p', { id: 'praise-lead', class: 't-m soft' }, praise.lead),
    praise.effort ? h('p', { class: 't-s effort', 'data-testid': 'effort' }, praise.effort) : null,
    h('dl', {}, ...praise.figures.map(({ key, label, shown }) => h('div', {}, h('dt', { class: 't-s' }, label), h('dd', { class: 't-m', 'data-testid': key }, shown)))),
    h('div', { class: 'actions' }, first, button('plain', text('success.rest'), 'rest', actions.rest)));
  return { card, first };
}

function starsHeader(won: number, soFar: number): HTMLElement {
  const stars = [1, 2, 3].map((n) => { const star = starPicture(); star.classList.toggle('on', n <= won); return star; });
  return h('header', {},
    h('div', { class: 'stars', role: 'img', 'aria-label': text('success.stars', { a: won }) }, ...stars),
    h('p', { class: 'sofar t-s', 'data-testid': 'stars-so-far' }, text('success.starsSoFar', { a: soFar })));
}

export interface Settings {
  readonly help: Help | null;     // null: the therapist has set it, or the exercise has none
  readonly levels: number;        // 0: a therapist chooses
  readonly level: number;
  readonly hand: Side | null;     // null: a therapist or the device chooses
  readonly recordings: boolean;   // this page may look at them
  readonly sounds: boolean;
  readonly music: MusicVolume;
  readonly speech: boolean;
  readonly voice: boolean;   // this machine has a voice of the page's language
  readonly textSize: TextSize;
}

export interface SettingsActions { language(wanted: Language): void; help(wanted: Help): void; level(wanted: number): void; hand(wanted: Side): void; sounds(): void; music(wanted: MusicVolume): void; speech(): void; textSize(wanted: TextSize): void }

/** The settings of sound and text, which the browser stores. */
function settingsSection(now: Settings, actions: SettingsActions): HTMLElement {
  const line = (id: string, key: TextKey, choices: HTMLElement[], note = '') => h('div', { class: 'line t-s', role: 'group', 'aria-labelledby': `settings-${id}` },
    h('h2', { id: `settings-${id}`, class: 't-m' }, text(key)), ...choices, note ? h('p', { class: 'notice', role: 'status', 'data-testid': `${id}-note` }, note) : null);
  const onOff = (name: string, on: boolean, toggle: () => void) => [true, false].map((wanted) =>
    pressable(text(wanted ? 'settings.on' : 'settings.off'), wanted === on, () => { if (wanted !== on) toggle(); }, { [`data-${name}`]: String(wanted) }));
  return h('section', { class: 'settings', 'data-testid': 'settings' },
    now.help && line('help', 'settings.help', HELPS.map((help) => pressable(text(`help.${help}`), help === now.help, () => actions.help(help), { 'data-help': help }))),
    now.levels < 2 ? null : line('level', 'settings.level', Array.from({ length: now.levels }, (_, i) => pressable(String(i + 1), i + 1 === now.level, () => actions.level(i + 1), { 'data-level': String(i + 1) }))),
    now.hand && line('hand', 'settings.hand', (['left', 'right'] as const).map((side) => pressable(text(`settings.hand.${side}`), side === now.hand, () => actions.hand(side), { 'data-side': side }))),
    line('language', 'settings.language', LANGUAGES.map((l) => pressable(l.toUpperCase(), l === language(), () => actions.language(l), { 'data-lang': l }))),
    line('sounds', 'settings.sounds', onOff('sounds', now.sounds, actions.sounds)),
    line('music', 'settings.music', MUSIC_VOLUMES.map((volume) => pressable(text(`music.${volume}`), volume === now.music, () => actions.music(volume), { 'data-music': volume }))),
    line('speech', 'settings.speech', onOff('speech', now.speech, actions.speech), now.speech && !now.voice ? text('settings.noVoice') : ''),
    line('text', 'settings.text', TEXT_SIZES.map((size) => pressable(text(`text.${size}`), size === now.textSize, () => actions.textSize(size), { 'data-text-size': size }))),
    now.recordings ? h('p', { class: 'links' }, h('a', { class: 'console-link t-s', href: `/console${location.search}#recordings`, 'data-testid': 'recordings' }, text('settings.recordings'))) : null);
}

export function helpCard(ways: readonly HelpSection[], settings: Settings, actions: SettingsActions, close: () => void): { card: HTMLElement; first: HTMLElement } {
  const first = h('button', { type: 'button', class: 'button go t-m', 'data-testid': 'close-help', onclick: close }, text('game.back'));
  const card = h('section', { class: 'card help', role: 'dialog', 'aria-labelledby': 'help-title', tabindex: -1, 'data-testid': 'help-card' },
    h('header', {}, h('h1', { id: 'help-title', class: 't-l' }, text('game.help')), first),
    h('div', { class: 'sections', tabindex: 0, role: 'group', 'aria-labelledby': 'help-title' }, settingsSection(settings, actions), ...ways.map((section) => h('section', {}, h('h2', { class: 't-m' }, section.name), helpList(section)))));
  return { card, first };
}

/** The card where the picture cannot be drawn; the texts continue. */
export function noPictureCard(why: 'none' | 'lost' = 'none'): HTMLElement {
  const [title, what] = why === 'none' ? [text('webgl.title'), FIRST.noPicture()] : [text('webgl.lostTitle'), text('webgl.lostSoft')];
  return h('section', { class: 'card nopicture', role: 'note', 'data-testid': 'nopicture' }, h('h2', { class: 't-l' }, title), h('p', { class: 't-s' }, what));
}
