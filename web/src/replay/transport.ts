import { choice, h, setText, setAttribute } from '../console/dom';
import { icon, type IconName } from '../console/icons';
import type { Span } from '../console/plot_source';
import { fill } from '../shared/i18n';
import { clockTime } from './clock';
import { texts } from './i18n';
import { SPEEDS } from './player';

/** Callbacks of the buttons below the time line and of the keys. */
export interface TransportHands {
  toggle(): void;
  step(ticks: number): void;
  home(): void;
  end(): void;
  /** Moves to the next mark, or the one before. */
  mark(way: 1 | -1): void;
  speed(speed: number): void;
  /** Zooms; a factor below 1 shows less. */
  scale(factor: number): void;
  all(): void;
}

/** Buttons for playback, steps, speed and zoom, and the current position. */
export class Transport {
  readonly element: HTMLElement;
  private readonly t = texts().transport;
  private readonly play: HTMLButtonElement;
  private readonly time = h('b', { class: 'now num', 'data-testid': 'time' });
  private readonly tick = h('span', { class: 'num', 'data-testid': 'tick' });
  private readonly window = h('span', { class: 'num window' });
  private readonly speeds: ReturnType<typeof choice>;
  private shownPlaying: boolean | undefined;

  constructor(hands: TransportHands, speed: number) {
    const { t } = this;
    this.play = h('button', { type: 'button', class: 'b go', 'data-testid': 'play', onclick: () => hands.toggle() });
    this.speeds = choice(t.speed, SPEEDS.map((value) => ({ key: String(value), name: `${value}×` })), String(speed), (key) => hands.speed(Number(key)));
    const button = (name: IconName, label: string, key: string, act: () => void): HTMLElement =>
      h('button', { type: 'button', class: 'b icon', 'aria-label': label, title: `${label} (${key})`, 'data-testid': name, onclick: act }, icon(name));
    this.element = h('section', { class: 'transport', 'aria-label': t.title },
      this.play, button('back', t.back, '←', () => hands.step(-1)), button('forward', t.forward, '→', () => hands.step(1)), this.speeds.element,
      h('p', { class: 'where' }, this.time, this.tick), h('span', { class: 'sp' }), this.window,
      button('earlier', t.earlier, 'PgUp', () => hands.mark(-1)), button('later', t.later, 'PgDn', () => hands.mark(1)),
      button('shorter', t.zoomIn, '+', () => hands.scale(0.5)), button('longer', t.zoomOut, '−', () => hands.scale(2)),
      h('button', { type: 'button', class: 'b', title: '0', 'data-testid': 'whole', onclick: () => hands.all() }, t.whole));
  }

  chooseSpeed(speed: number): void {
    this.speeds.choose(String(speed));
  }

  /** @param exact the picture shows exactly this tick */
  show(time_s: number, row: string, exact: boolean, playing: boolean, window: Span): void {
    const { t } = this;
    setText(this.time, clockTime(time_s, 3));
    setText(this.tick, exact || playing ? row : `${row}, ${t.near}`);
    setText(this.window, fill(t.window, { a: clockTime(window.from_s, 1), b: clockTime(window.to_s, 1) }));
    if (this.shownPlaying === playing) return;
    this.shownPlaying = playing;
    this.play.replaceChildren(icon(playing ? 'pause' : 'play'), playing ? t.pause : t.play, h('kbd', {}, t.space));
    setAttribute(this.play, 'aria-pressed', String(playing));
  }
}

/** Keys that the focused element uses are not handled by the page. */
function taken({ target, key }: KeyboardEvent): boolean {
  if (!(target instanceof Element)) return false;
  if (target.closest('input, select, textarea') !== null) return true;
  if (key === ' ' || key === 'Enter') return target.closest('button, a, summary') !== null;
  // Arrow keys scroll; at the time line they move in time.
  if (key === 'ArrowUp' || key === 'ArrowDown') return target.closest('[role=slider]') === null;
  return (key.startsWith('Page') || key === 'Home' || key === 'End') && target.closest('.scrolls, main.beside') !== null;
}

/** The action of a key; undefined: none. */
export function keyOrder(event: Pick<KeyboardEvent, 'key' | 'shiftKey'>, tenth: number, hands: TransportHands): (() => void) | undefined {
  switch (event.key) {
    case ' ': return () => hands.toggle();
    case 'ArrowLeft': case 'ArrowDown': return () => hands.step(event.shiftKey ? -tenth : -1);
    case 'ArrowRight': case 'ArrowUp': return () => hands.step(event.shiftKey ? tenth : 1);
    case 'Home': return () => hands.home();
    case 'End': return () => hands.end();
    case 'PageUp': return () => hands.mark(-1);
    case 'PageDown': return () => hands.mark(1);
    case '+': case '=': return () => hands.scale(0.5);
    case '-': return () => hands.scale(2);
    case '0': return () => hands.all();
    default: return undefined;
  }
}

/** @param tenth number of ticks in a tenth of a second, at the present time */
export function answerKey(event: KeyboardEvent, tenth: number, hands: TransportHands): void {
  if (event.ctrlKey || event.altKey || event.metaKey || taken(event)) return;
  const order = keyOrder(event, tenth, hands);
  if (!order || (event.key === ' ' && event.repeat)) return;
  event.preventDefault();
  order();
}
