import { h, setAttribute } from '../console/dom';
import type { Span } from '../console/plot_source';
import { readTheme, type Theme } from '../console/theme';
import { clockTicks } from './clock';
import { texts } from './i18n';
import { isBad } from './moments';
import { channelKey, type SeriesPiece } from './series_piece';
import type { ReplaySide } from './side';

const FONT = '13px "Atkinson Hyperlegible Next Variable", Verdana, sans-serif';
/** A lane has marks above, and the contact force below them [px]. */
const MARKS_PX = 14;
const LANE_PX = 44;
/** Height of the times below the lanes [px]. */
const TIMES_PX = 18;
const TICK_EVERY_PX = 90;
/** A lane shows at least this force at full height [N]. */
const LEAST_FULL_N = 2;
/** Share of the columns with contact whose force fits into a lane. */
const FITS = 0.8;

/** Callbacks for input on the time line. */
export interface TimeLineHands {
  seek(time_s: number): void;
  zoom(window: Span): void;
}

type Pull = 'head' | 'from' | 'to';

/** The whole of all recordings, one lane each: contact force, marks and gaps, with the window and the play head. */
export class TimeLine {
  readonly element: HTMLElement;
  /** The focusable element; the page defines the keys. */
  readonly slider: HTMLElement;
  private readonly canvas = h('canvas', { 'aria-hidden': 'true' });
  private readonly head = h('i', { class: 'head' });
  private readonly before = h('i', { class: 'outside' });
  private readonly after = h('i', { class: 'outside' });
  private readonly grips: Readonly<Record<'from' | 'to', HTMLElement>>;
  private readonly resized = new ResizeObserver(() => this.draw());
  private pull: Pull | undefined;
  private window: Span = { from_s: 0, to_s: 1 };

  constructor(private readonly sides: readonly ReplaySide[], private whole: Span, private readonly hands: TimeLineHands) {
    const t = texts().timeLine;
    this.grips = { from: h('i', { class: 'grip', title: t.begin }), to: h('i', { class: 'grip', title: t.end }) };
    this.slider = h('div', {
      class: 'line', role: 'slider', tabindex: 0, 'aria-label': t.title, 'aria-describedby': 'time-line-help', 'aria-valuemin': 0, 'aria-valuemax': 0, 'aria-valuenow': 0, 'data-testid': 'time-line',
    }, this.canvas, this.before, this.after, this.head, this.grips.from, this.grips.to);
    this.slider.style.height = `${sides.length * LANE_PX + TIMES_PX}px`;
    this.element = h('section', { class: 'time-line', 'aria-label': t.title }, this.slider, h('p', { class: 'sr', id: 'time-line-help' }, t.help));
    this.slider.addEventListener('pointerdown', (event) => this.press(event));
    this.slider.addEventListener('pointermove', (event) => this.move(event));
    for (const end of ['pointerup', 'pointercancel'] as const) this.slider.addEventListener(end, () => { this.pull = undefined; });
    this.resized.observe(this.slider);
  }

  /** Whether a person drags on it. */
  get pulled(): boolean {
    return this.pull !== undefined;
  }

  setWhole(whole: Span): void {
    this.whole = whole;
    this.draw();
  }

  setWindow(window: Span): void {
    this.window = window;
    const [from, to] = [this.px(window.from_s), this.px(window.to_s)];
    const width = this.slider.clientWidth;
    this.before.style.width = `${from.toFixed(1)}px`;
    this.after.style.width = `${Math.max(0, width - to).toFixed(1)}px`;
    this.grips.from.style.transform = `translateX(${from.toFixed(1)}px)`;
    this.grips.to.style.transform = `translateX(${to.toFixed(1)}px)`;
  }

  placeHead(time_s: number, words: string): void {
    this.head.style.transform = `translateX(${this.px(time_s).toFixed(1)}px)`;
    setAttribute(this.slider, 'aria-valuemin', this.whole.from_s.toFixed(3));
    setAttribute(this.slider, 'aria-valuemax', this.whole.to_s.toFixed(3));
    setAttribute(this.slider, 'aria-valuenow', time_s.toFixed(3));
    setAttribute(this.slider, 'aria-valuetext', words);
  }

  draw(): void {
    const { clientWidth: width, clientHeight: height } = this.slider;
    const context = this.canvas.getContext('2d');
    if (width < 40 || !context) return;
    const ratio = devicePixelRatio || 1;
    [this.canvas.width, this.canvas.height] = [Math.round(width * ratio), Math.round(height * ratio)];
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    const theme = readTheme();
    this.drawTimes(context, theme, height);
    this.sides.forEach((side, i) => this.drawLane(context, theme, side, i * LANE_PX));
    this.setWindow(this.window);
  }

  close(): void {
    this.resized.disconnect();
  }

  private px(time_s: number): number {
    const { from_s, to_s } = this.whole;
    return (Math.min(to_s, Math.max(from_s, time_s)) - from_s) / Math.max(1e-9, to_s - from_s) * this.slider.clientWidth;
  }

  private timeAt(event: PointerEvent): number {
    const box = this.slider.getBoundingClientRect();
    const share = Math.min(1, Math.max(0, (event.clientX - box.left) / box.width));
    return this.whole.from_s + share * (this.whole.to_s - this.whole.from_s);
  }

  private press(event: PointerEvent): void {
    if (event.button !== 0 || !event.isPrimary) return;
    this.slider.setPointerCapture(event.pointerId);
    this.pull = event.target === this.grips.from ? 'from' : event.target === this.grips.to ? 'to' : 'head';
    this.move(event);
  }

  private move(event: PointerEvent): void {
    const time_s = this.timeAt(event);
    if (this.pull === 'head') this.hands.seek(time_s);
    if (this.pull === 'from') this.hands.zoom({ from_s: Math.min(time_s, this.window.to_s), to_s: this.window.to_s });
    if (this.pull === 'to') this.hands.zoom({ from_s: this.window.from_s, to_s: Math.max(time_s, this.window.from_s) });
  }

  private drawTimes(context: CanvasRenderingContext2D, theme: Theme, height: number): void {
    context.font = FONT;
    context.fillStyle = theme.ink2;
    const width = this.slider.clientWidth;
    for (const { at_s, name } of clockTicks(this.whole, Math.max(2, width / TICK_EVERY_PX))) {
      const x = this.px(at_s);
      const half = context.measureText(name).width / 2;
      context.fillText(name, Math.min(width - 2 * half, Math.max(0, x - half)), height - 4);
    }
  }

  private drawLane(context: CanvasRenderingContext2D, theme: Theme, side: ReplaySide, top: number): void {
    const { shift_s, about } = side;
    const x = (time_s: number): number => this.px(time_s + shift_s);
    const [floor, high] = [top + LANE_PX - 3, LANE_PX - MARKS_PX - 3];
    context.fillStyle = theme.grid;
    context.fillRect(x(about.from_s), floor - high, Math.max(1, x(about.to_s) - x(about.from_s)), high);
    context.fillStyle = theme.color('--accent');
    this.drawForce(context, side.series.overview(), x, floor, high);
    for (const { from_s, to_s } of side.series.missing()) hatch(context, theme.line2, x(from_s), x(to_s), floor - high, high);
    for (const gap of side.moments.gaps) hatch(context, theme.bad, x(gap.from_s), Math.max(x(gap.to_s), x(gap.from_s) + 3), floor - high, high);
    for (const { unreadable } of side.series.overview()) for (const { from_s, to_s } of unreadable) hatch(context, theme.bad, x(from_s), x(to_s), floor - high, high);
    if (!about.whole && about.unreadable_from_s !== undefined) hatch(context, theme.bad, x(about.unreadable_from_s), x(about.to_s), floor - high, high);
    this.drawMarks(context, theme, side, x, top);
  }

  private drawForce(context: CanvasRenderingContext2D, pieces: readonly SeriesPiece[], x: (time_s: number) => number, floor: number, high: number): void {
    const forces = pieces.map((piece) => ({ piece, force: piece.channels.get(channelKey('contact_force_n'))?.high }));
    // The scale fits most grasps: a single impact must not flatten them.
    const all = forces.flatMap(({ force }) => [...(force ?? [])]).filter((value) => value > 0).sort((a, b) => a - b);
    const most = Math.max(LEAST_FULL_N, all[Math.floor(FITS * (all.length - 1))] ?? 0);
    for (const { piece, force } of forces) {
      const width_s = (piece.to_s - piece.from_s) / piece.columns;
      force?.forEach((value, column) => {
        if (!(value > 0)) return;
        const from = x(piece.from_s + column * width_s);
        const tall = high * Math.min(1, value / most);
        context.fillRect(from, floor - tall, Math.max(1, x(piece.from_s + (column + 1) * width_s) - from), tall);
      });
    }
  }

  private drawMarks(context: CanvasRenderingContext2D, theme: Theme, side: ReplaySide, x: (time_s: number) => number, top: number): void {
    let last = -Infinity;
    for (const moment of side.moments.list) {
      const at = x(moment.time_s);
      const bad = isBad(moment);
      // Events closer than a pixel are drawn once; faults are always drawn.
      if (!bad && at - last < 1) continue;
      last = at;
      context.fillStyle = bad ? theme.bad : theme.ink2;
      if (!bad) context.fillRect(at - 0.75, top + MARKS_PX - 8, 1.5, 7);
      else {
        context.beginPath();
        context.moveTo(at - 5, top + 2);
        context.lineTo(at + 5, top + 2);
        context.lineTo(at, top + 11);
        context.fill();
        context.fillRect(at - 1, top + 4, 2, LANE_PX - 7);
      }
    }
  }
}

/** Hatched area: distinguishable by more than colour. */
function hatch(context: CanvasRenderingContext2D, color: string, from: number, to: number, top: number, height: number): void {
  if (!(to > from)) return;
  context.save();
  context.beginPath();
  context.rect(from, top, to - from, height);
  context.clip();
  context.strokeStyle = color;
  context.lineWidth = 1;
  context.beginPath();
  for (let x = from - height; x < to; x += 6) {
    context.moveTo(x, top + height);
    context.lineTo(x + height, top);
  }
  context.stroke();
  context.restore();
}
