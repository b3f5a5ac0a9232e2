import uPlot from 'uplot';
import type { ConsoleTexts } from './i18n';
import { WINDOW_S, type History } from './history';
import type { Mark } from './marks';
import type { PlotSpec } from './plot_specs';
import { CalmRange, niceStep, ticksIn } from './scale';
import type { Theme } from './theme';

const TIMES = [-10, -8, -6, -4, -2, 0];
/** Half a letter's width: the word for now stands in the middle of the last tick [px]. */
const NOW_PX = 3.7;
const FONT = '13px "Atkinson Hyperlegible Next Variable", Verdana, sans-serif';
const FONT_BAD = '700 14px "Atkinson Hyperlegible Next Variable", Verdana, sans-serif';
const FONT_SIGN = '15px "DejaVu Sans", "Segoe UI Symbol", "Apple Symbols", sans-serif';
/** A limit is drawn when the data come this near to it. */
const LIMIT_NEAR = 0.45;

/** One plot of the last ten seconds. Draws what is in the history, and copies nothing of it. */
export class LivePlot {
  private readonly range: CalmRange;
  private plot: uPlot | undefined;
  private now_s = 0;
  private marks: readonly Mark[] = [];
  private limit: number | undefined;
  private readonly resized: ResizeObserver;

  constructor(
    private readonly host: HTMLElement,
    private readonly spec: PlotSpec,
    private readonly theme: Theme,
    private readonly words: ConsoleTexts['plots'],
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

  draw(history: History, marks: readonly Mark[], limit: number | undefined): void {
    if (!this.plot) return;
    const count = history.count();
    const columns = this.spec.series.map((series) => history.samples.column(series.column, count));
    this.now_s = history.now_s;
    this.marks = marks;
    this.follow(columns, limit);
    this.plot.setData([history.samples.column(0, count), ...columns] as unknown as uPlot.AlignedData, true);
  }

  // The range holds the data, and the limit once the data come near it.
  private follow(columns: readonly Float64Array[], limit: number | undefined): void {
    let least = Infinity;
    let most = -Infinity;
    for (const column of columns) {
      for (const value of column) {
        if (value < least) least = value;
        if (value > most) most = value;
      }
    }
    this.limit = limit;
    if (limit !== undefined && most > LIMIT_NEAR * limit) most = Math.max(most, limit);
    if (limit !== undefined && least < -LIMIT_NEAR * limit) least = Math.min(least, -limit);
    this.range.follow(least, most, this.now_s);
  }

  private fit(): void {
    const width = Math.floor(this.host.clientWidth);
    const height = Math.floor(this.host.clientHeight);
    if (width < 40 || height < 40) return;
    if (this.plot) this.plot.setSize({ width, height });
    else this.plot = new uPlot(this.options(width, height), [[], ...this.spec.series.map(() => [])], this.host);
  }

  private valueRange(): [number, number] {
    if (this.spec.range) return [...this.spec.range];
    return this.range.upper > this.range.lower ? [this.range.lower, this.range.upper] : [-1, 1];
  }

  private options(width: number, height: number): uPlot.Options {
    const { theme, spec } = this;
    const axis = { stroke: theme.ink2, grid: { stroke: theme.grid, width: 1 }, ticks: { show: false }, font: FONT };
    const [valueSplits, valueNames] = this.valueAxis();
    return {
      width, height, legend: { show: false }, cursor: { show: false }, padding: [6, Math.max(16, NOW_PX * this.words.now.length), 0, 0],
      scales: {
        x: { time: false, range: () => [this.now_s - WINDOW_S, this.now_s] },
        y: { range: () => this.valueRange() },
      },
      axes: [
        {
          ...axis, size: 22, gap: 2, splits: () => TIMES.map((t) => this.now_s + t),
          values: () => TIMES.map((t) => (t === 0 ? this.words.now : `−${-t} s`)),
        },
        { ...axis, size: 40, gap: 4, splits: valueSplits, values: valueNames },
      ],
      series: [{}, ...spec.series.map((series): uPlot.Series => ({
        stroke: theme.color(series.color), width: series.color === '--ax-a' ? 2 : 2.2, dash: [...series.dash], points: { show: false }, gaps: unknownSpans,
      }))],
      hooks: { draw: [(plot) => this.drawOver(plot)] },
    };
  }

  private valueAxis(): [() => number[], (plot: uPlot, splits: number[]) => string[]] {
    const splits = (): number[] => {
      if (this.spec.range) return [0, 0.5, 1];
      const [lower, upper] = this.valueRange();
      return ticksIn(lower, upper, niceStep(upper - lower, 4));
    };
    // The lowest one would stand in the way of the times below it.
    const named = (value: number): boolean => {
      const [lower, upper] = this.valueRange();
      return this.spec.range !== undefined || value - lower > 0.05 * (upper - lower);
    };
    const names = (_plot: uPlot, values: number[]): string[] =>
      values.map((value) => (named(value) ? String(Number(value.toPrecision(6))).replace('-', '−') : ''));
    return [splits, names];
  }

  private drawOver(plot: uPlot): void {
    const context = plot.ctx;
    const ratio = uPlot.pxRatio;
    context.save();
    context.textAlign = 'left';
    context.textBaseline = 'alphabetic';
    if (this.limit !== undefined) for (const value of [this.limit, -this.limit]) this.drawLimit(plot, value, ratio);
    for (const mark of this.marks) this.drawMark(plot, mark, ratio);
    context.restore();
  }

  private drawLimit(plot: uPlot, value: number, ratio: number): void {
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
    context.font = scaled(FONT, ratio);
    context.fillText(this.words.limit, bbox.left + 8 * ratio, y + (value < 0 ? -5 : 15) * ratio);
  }

  private drawMark(plot: uPlot, mark: Mark, ratio: number): void {
    const { ctx: context, bbox } = plot;
    if (mark.time_s < this.now_s - WINDOW_S || mark.time_s > this.now_s) return;
    const x = Math.round(plot.valToPos(mark.time_s, 'x', true));
    context.strokeStyle = mark.bad ? this.theme.bad : this.theme.line2;
    context.fillStyle = mark.bad ? this.theme.bad : this.theme.ink2;
    context.lineWidth = (mark.bad ? 2 : 1) * ratio;
    context.setLineDash(mark.bad ? [] : [2 * ratio, 3 * ratio]);
    context.beginPath();
    context.moveTo(x, bbox.top);
    context.lineTo(x, bbox.top + bbox.height);
    context.stroke();
    // A stop is named once, at the top; its line goes through all plots.
    if (mark.bad && this.spec.id !== 'hand') return;
    context.font = scaled(mark.bad ? FONT_BAD : FONT_SIGN, ratio);
    context.fillText(mark.label, x + 5 * ratio, bbox.top + 13 * ratio);
  }
}

/** Where nothing is known, no line: from a sample without a value to the next one [px of the canvas]. */
function unknownSpans(plot: uPlot, series: number, first: number, last: number): uPlot.Series.Gaps {
  const [times, values] = [plot.data[0], plot.data[series]];
  const spans: uPlot.Series.Gaps = [];
  for (let i = first; i < last; i += 1) {
    if (Number.isNaN(values[i])) spans.push([plot.valToPos(times[i], 'x', true), plot.valToPos(times[i + 1], 'x', true)]);
  }
  return spans;
}

function scaled(font: string, ratio: number): string {
  return font.replace(/(\d+)px/, (_all, size: string) => `${Number(size) * ratio}px`);
}
