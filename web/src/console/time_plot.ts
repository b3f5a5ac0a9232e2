import uPlot from 'uplot';
import { drawMoments, FONT, writeOver, type MomentLook } from '../shared/chart_marks';
import { significant } from '../shared/format';
import { LabelPlaces } from '../shared/label_places';
import { h } from './dom';
import type { ConsoleTexts } from './i18n';
import type { Mark } from './marks';
import type { PlotSource, Span, TimeTick } from './plot_source';
import type { AxisLimit, PlotSpec } from './plot_specs';
import { CalmRange, niceStep, ticksIn } from './scale';
import type { Theme } from './theme';

/** Half a letter's width [px]: the word for the present is centred at the last tick. */
const NOW_PX = 3.7;
const TEXT_PX = 13;
/** A limit is drawn when the data reach this share of it. */
const LIMIT_NEAR = 0.45;

/** Height of the row of labels [px]. */
const ROW_PX = 18;

const NOTHING: Span = { from_s: 0, to_s: 1 };
/** A shorter drag is a click [px]. */
const PULL_PX = 6;

/** Callbacks for input in a plot of a recording. */
export interface PlotHands {
  /** A time was clicked. */
  seek(time_s: number): void;
  /** A window was selected by dragging. */
  zoom(window: Span): void;
  /** The wheel was turned at a time; a factor below 1 shows less. */
  scale(time_s: number, factor: number): void;
}

/** One plot of a window of time. It draws the data of its source without copying it. */
export class TimePlot {
  private readonly range: CalmRange;
  private readonly head = h('i', { class: 'head', hidden: true });
  private plot: uPlot | undefined;
  private source: PlotSource | undefined;
  private marks: readonly Mark[] = [];
  private limits: readonly AxisLimit[] = [];
  private near: AxisLimit[] = [];
  private readonly resized: ResizeObserver;

  constructor(
    private readonly host: HTMLElement,
    private readonly spec: PlotSpec,
    private readonly theme: Theme,
    private readonly words: ConsoleTexts['plots'],
    private readonly hands?: PlotHands,
  ) {
    this.range = new CalmRange(spec.leastSpan, spec.withZero);
    this.resized = new ResizeObserver(() => this.fit());
    this.resized.observe(host);
  }

  close(): void {
    this.resized.disconnect();
    this.plot?.destroy();
    this.plot = undefined;
  }

  draw(source: PlotSource, marks: readonly Mark[], limits: readonly AxisLimit[]): void {
    // A plot without a size is drawn once it has one.
    this.source = source;
    this.marks = marks;
    this.limits = limits;
    if (!this.plot) return;
    this.follow(source);
    this.plot.setData([source.times(), ...this.spec.series.map((series) => source.values(series.column))] as unknown as uPlot.AlignedData, true);
  }

  /** Puts the play head at a time of the window. */
  placeHead(time_s: number): void {
    if (!this.plot) return;
    const { from_s, to_s } = this.window;
    const share = (time_s - from_s) / (to_s - from_s);
    this.head.hidden = !(share >= 0 && share <= 1);
    this.head.style.transform = `translateX(${(share * this.plot.over.clientWidth).toFixed(1)}px)`;
  }

  private get window(): Span {
    return this.source?.window ?? NOTHING;
  }

  // The range contains the data, and the limit of each axis once that axis comes near it.
  private follow(source: PlotSource): void {
    let [least, most] = source.extremes(this.spec.series.map((series) => series.column));
    this.near = [];
    for (const axis of this.limits) {
      const [low, high] = source.extremes([axis.column]);
      if (high > LIMIT_NEAR * axis.limit) most = Math.max(most, axis.limit);
      if (low < -LIMIT_NEAR * axis.limit) least = Math.min(least, -axis.limit);
      if (Math.max(high, -low) > LIMIT_NEAR * axis.limit) this.near.push(axis);
    }
    if (source.live) this.range.follow(least, most, source.window.to_s);
    else this.range.fit(least, most);
  }

  private fit(): void {
    const width = Math.floor(this.host.clientWidth);
    const height = Math.floor(this.host.clientHeight);
    if (width < 40 || height < 40) return;
    if (this.plot) {
      this.plot.setSize({ width, height });
      return;
    }
    this.plot = new uPlot(this.options(width, height), [[], ...this.spec.series.map(() => [])], this.host);
    if (this.hands) this.listen(this.plot, this.hands);
    if (this.source) this.draw(this.source, this.marks, this.limits);
  }

  private listen(plot: uPlot, hands: PlotHands): void {
    plot.over.append(this.head);
    const timeAt = (x_px: number): number => plot.posToVal(x_px, 'x');
    plot.over.addEventListener('click', (event) => {
      if (plot.select.width < PULL_PX) hands.seek(timeAt(event.clientX - plot.over.getBoundingClientRect().left));
    });
    plot.over.addEventListener('wheel', (event) => {
      // The page scrolls: the wheel changes the window only with Ctrl or Shift.
      if (!event.ctrlKey && !event.shiftKey) return;
      event.preventDefault();
      const turned = event.deltaY || event.deltaX;
      hands.scale(timeAt(event.clientX - plot.over.getBoundingClientRect().left), turned > 0 ? 1.25 : 0.8);
    }, { passive: false });
  }

  private pulled(plot: uPlot): void {
    const { left, width } = plot.select;
    if (width < PULL_PX) return;
    this.hands?.zoom({ from_s: plot.posToVal(left, 'x'), to_s: plot.posToVal(left + width, 'x') });
    plot.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
  }

  private valueRange(): [number, number] {
    if (this.spec.range) return [...this.spec.range];
    return this.range.upper > this.range.lower ? [this.range.lower, this.range.upper] : [-1, 1];
  }

  private options(width: number, height: number): uPlot.Options {
    const { theme, spec } = this;
    const axis = { stroke: theme.ink2, grid: { stroke: theme.grid, width: 1 }, ticks: { show: false }, font: `${TEXT_PX}px ${FONT}` };
    const [valueSplits, valueNames] = this.valueAxis();
    return {
      width, height, legend: { show: false }, cursor: this.cursor(), padding: [6, Math.max(16, NOW_PX * this.words.now.length), 0, 0],
      scales: {
        x: { time: false, range: () => [this.window.from_s, this.window.to_s] },
        y: { range: () => this.valueRange() },
      },
      axes: [
        {
          ...axis, size: 22, gap: 2, splits: () => this.timeTicks().map((tick) => tick.at_s),
          values: () => this.timeTicks().map((tick) => tick.name),
        },
        { ...axis, size: 40, gap: 4, splits: valueSplits, values: valueNames },
      ],
      series: [{}, ...spec.series.map((series): uPlot.Series => ({
        stroke: theme.color(series.color), width: series.color === '--ax-a' ? 2 : 2.2, dash: [...series.dash], points: { show: false }, gaps: unknownSpans,
      }))],
      hooks: { draw: [(plot) => this.drawOver(plot)], setSelect: [(plot) => this.pulled(plot)] },
    };
  }

  private timeTicks(): readonly TimeTick[] {
    return this.source?.timeTicks(this.words.now) ?? [];
  }

  private cursor(): uPlot.Cursor {
    return this.hands ? { show: true, x: false, y: false, points: { show: false }, drag: { x: true, y: false, setScale: false } } : { show: false };
  }

  private valueAxis(): [() => number[], (plot: uPlot, splits: number[]) => string[]] {
    const splits = (): number[] => {
      if (this.spec.range) return [0, 0.5, 1];
      const [lower, upper] = this.valueRange();
      return ticksIn(lower, upper, niceStep(upper - lower, 4));
    };
    // The lowest label would overlap the times below it.
    const named = (value: number): boolean => {
      const [lower, upper] = this.valueRange();
      return this.spec.range !== undefined || value - lower > 0.05 * (upper - lower);
    };
    const names = (_plot: uPlot, values: number[]): string[] =>
      values.map((value) => (named(value) ? significant(value) : ''));
    return [splits, names];
  }

  private drawOver(plot: uPlot): void {
    const context = plot.ctx;
    const ratio = uPlot.pxRatio;
    context.save();
    context.textAlign = 'left';
    context.textBaseline = 'alphabetic';
    const places = new LabelPlaces(plot.bbox.left + plot.bbox.width, 5 * ratio);
    this.drawLimits(plot, ratio, places);
    this.drawMarks(plot, ratio, places);
    context.restore();
  }

  private drawMarks(plot: uPlot, ratio: number, places: LabelPlaces): void {
    const { from_s, to_s } = this.window;
    const seen = this.marks.filter(({ time_s }) => time_s >= from_s && time_s <= to_s).map(({ time_s, label, bad }) => ({
      x: Math.round(plot.valToPos(time_s, 'x', true)), bad,
      label: bad && this.spec.id !== 'hand' ? '' : label,   // a stop is labelled once, at the top; its line crosses all plots
    }));
    drawMoments(plot.ctx, plot.bbox, seen, this.look(ratio), places);
  }

  private look(dots: number): MomentLook {
    const { line2, ink2, bad, color } = this.theme;
    return { dots, text_px: TEXT_PX, line: line2, words: ink2, bad, paper: color('--panel') };
  }

  /** Draws limits of the axes that come near theirs, or the common limit of all; several limits are labelled with their axes. */
  private drawLimits(plot: uPlot, ratio: number, places: LabelPlaces): void {
    const values = [...new Set(this.limits.map(({ limit }) => limit))];
    const drawn = values.length === 1 ? values : values.filter((value) => this.near.some(({ limit }) => limit === value));
    for (const value of drawn) {
      const whose = values.length === 1 ? '' : `, ${this.near.filter(({ limit }) => limit === value).map(({ name }) => name).join(', ')}`;
      for (const signed of [value, -value]) this.drawLimit(plot, signed, `${this.words.limit}${whose}`, ratio, places);
    }
  }

  private drawLimit(plot: uPlot, value: number, words: string, ratio: number, places: LabelPlaces): void {
    const { ctx: context, bbox } = plot;
    const [lower, upper] = this.valueRange();
    if (value < lower || value > upper) return;
    const y = Math.round(plot.valToPos(value, 'y', true));
    context.strokeStyle = context.fillStyle = this.theme.bad;
    context.lineWidth = 1.5 * ratio;
    context.setLineDash([3 * ratio, 4 * ratio]);
    context.beginPath();
    context.moveTo(bbox.left, y);
    context.lineTo(bbox.left + bbox.width, y);
    context.stroke();
    context.font = `${TEXT_PX * ratio}px ${FONT}`;
    const left = bbox.left + 8 * ratio, base = y + (value < 0 ? -5 : 15) * ratio;
    if (base - 13 * ratio < bbox.top + ROW_PX * ratio) places.cover(left, left + context.measureText(words).width);
    writeOver(context, words, left, base, this.look(ratio));
  }
}

/** Gaps in which no line is drawn: from a sample without a value to the next one [px of the canvas]. */
function unknownSpans(plot: uPlot, series: number, first: number, last: number): uPlot.Series.Gaps {
  const [times, values] = [plot.data[0], plot.data[series]];
  const spans: uPlot.Series.Gaps = [];
  for (let i = first; i < last; i += 1) {
    if (Number.isNaN(values[i])) spans.push([plot.valToPos(times[i], 'x', true), plot.valToPos(times[i + 1], 'x', true)]);
  }
  return spans;
}
