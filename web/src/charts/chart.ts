// Charts for print: they are static, and drawn finer than a screen needs.
import uPlot from 'uplot';
import 'uplot/dist/uPlot.min.css';
import { h } from '../shared/dom';
import { significant } from '../shared/format';
import { drawMoments, FONT } from '../shared/chart_marks';
import { LabelPlaces } from '../shared/label_places';
import './chart.css';
import { logarithmicNumbers, rangeOf, type ChartLine } from './chart_range';

export type { ChartLine };

/** Additional canvas resolution relative to the screen's: 192 dots per inch on paper. */
const FINER = 2;

export interface ChartMark { readonly at: number; readonly label: string; readonly bad: boolean }
export interface ChartBand { readonly from: number; readonly to: number; readonly color: string }

export interface ChartSpec {
  readonly title: string;
  readonly unit: string;
  /** Height without the time labels. */
  readonly height_px: number;
  /** x of the lines that have none of their own; not falling. */
  readonly x?: ArrayLike<number>;
  readonly range_x: readonly [number, number];
  readonly lines: readonly ChartLine[];
  /** Values that the axis must contain. */
  readonly holds?: readonly [number, number];
  /** Ends of the axis; by default they follow from the values. */
  readonly range_y?: readonly [number, number];
  /** Positions of the axis's labels; by default round numbers. */
  readonly numbers_y?: readonly number[];
  /** The same along x. */
  readonly numbers_x?: readonly number[];
  /** Indices of the two lines that bound the goal range. */
  readonly goal?: readonly [low: number, high: number];
  readonly bands?: readonly ChartBand[];
  readonly marks?: readonly ChartMark[];
  /** Charts above each other have the same times: only the last one labels them. */
  readonly nameOfX?: (x: number) => string;
  /** Unit, written after the last label. */
  readonly unit_x?: string;
  readonly logarithmic_x?: boolean;
  readonly logarithmic_y?: boolean;
  /** Called when a value of x was clicked. */
  readonly pick?: (x: number) => void;
}

const NAMES_PX = 21;
const heightOf = (spec: ChartSpec): number => spec.height_px + (spec.nameOfX ? NAMES_PX : 5);

/** uPlot represents a missing value as null. */
const withHoles = (values: ArrayLike<number>): (number | null)[] => Array.from(values, (value) => (Number.isFinite(value) ? value : null));

/** A legend with a sample of each named line. */
export function legend(lines: readonly Pick<ChartLine, 'name' | 'color' | 'dash' | 'width' | 'dots'>[]): HTMLElement {
  const sample = ({ color, dash, width = 2.5, dots }: Pick<ChartLine, 'color' | 'dash' | 'width' | 'dots'>): HTMLElement => (dots
    ? h('i', { class: 'dot', style: `background: ${color}` })
    : h('i', { style: `border-top: ${Math.max(2.5, width)}px ${dash && dash.length > 0 ? 'dashed' : 'solid'} ${color}` }));
  return h('span', { class: 'legend' }, ...lines.filter(({ name }) => name !== '').map((line) => h('span', {}, sample(line), line.name)));
}

/** The chart in each place, for redrawing. */
const drawn = new WeakMap<Element, ChartSpec>();

/** Redraws all charts within an element after the colours of the style changed. */
export function redrawCharts(within: Element): void {
  for (const host of within.querySelectorAll<HTMLElement>('.chart')) {
    const spec = drawn.get(host);
    if (spec && host.childElementCount > 0) draw(host, spec);
  }
}

/** A chart with its title and legend. It is drawn once it is in the page. */
export function chart(spec: ChartSpec): HTMLElement {
  const host = h('div', { class: 'chart', style: `height: ${heightOf(spec)}px`, role: 'img', 'aria-label': `${spec.title}, ${spec.unit}` });
  const figure = h('figure', { class: 'charted' }, h('figcaption', {}, h('b', {}, spec.title), spec.unit === '' ? '' : ` ${spec.unit}`, legend(spec.lines)), host);
  drawn.set(host, spec);
  const seen = new ResizeObserver(() => {
    if (host.clientWidth < 40) return;
    seen.disconnect();
    draw(host, spec);
  });
  seen.observe(host);
  return figure;
}

function draw(host: HTMLElement, spec: ChartSpec): void {
  const scaled = h('div', { class: 'finer', style: `transform: scale(${1 / FINER})` });
  host.replaceChildren(scaled);
  const plot = new uPlot(options(inColors(host, spec), colorsAt(host), FINER * host.clientWidth, FINER * heightOf(spec)), dataOf(spec), scaled);
  if (!spec.pick) return;
  host.classList.add('picks');
  scaled.addEventListener('click', (event) => {
    const shown = host.getBoundingClientRect(), larger = shown.width / host.clientWidth;   // a sheet may be zoomed
    const left = (event.clientX - shown.left) / larger * FINER - plot.bbox.left / devicePixelRatio;
    spec.pick?.(plot.posToVal(left, 'x'));
  });
}

/** Merges lines with x of their own onto the union of all x. */
function dataOf({ x = [], lines }: ChartSpec): uPlot.AlignedData {
  if (lines.every((line) => !line.x)) return [Array.from(x), ...lines.map(({ values }) => withHoles(values))];
  return uPlot.join(lines.map((line): uPlot.AlignedData => [Array.from(line.x ?? x), withHoles(line.values)]));
}

const propertyAt = (host: Element, name: string): string => getComputedStyle(host).getPropertyValue(name).trim();

interface Colors { readonly words: string; readonly grid: string; readonly mark: string; readonly bad: string; readonly paper: string }
const colorsAt = (host: Element): Colors => ({ words: propertyAt(host, '--ink-2'), grid: propertyAt(host, '--grid'), mark: propertyAt(host, '--line-2'), bad: propertyAt(host, '--bad'), paper: propertyAt(host, '--bg') || '#FFFFFF' });

/** Replaces custom properties by their colours, since a canvas does not know them. */
function inColors(host: HTMLElement, spec: ChartSpec): ChartSpec {
  const known = (color: string): string => propertyAt(host, /^var\((--[\w-]+)\)$/.exec(color)?.[1] ?? '') || color;
  return { ...spec, lines: spec.lines.map((line) => ({ ...line, color: known(line.color) })), bands: spec.bands?.map((band) => ({ ...band, color: known(band.color) })) };
}

function options(spec: ChartSpec, colors: Colors, width: number, height: number): uPlot.Options {
  const range_y = spec.range_y ?? rangeOf(spec.lines, spec.holds);
  const axis: uPlot.Axis = { stroke: colors.words, font: `${11 * FINER}px ${FONT}`, grid: { stroke: colors.grid, width: FINER * 0.75 }, ticks: { show: false } };
  return {
    width, height, legend: { show: false }, cursor: { show: false }, padding: [6 * FINER, 15 * FINER, 0, 0],
    scales: {
      x: { time: false, distr: spec.logarithmic_x ? 3 : 1, range: () => [...spec.range_x] },
      y: { distr: spec.logarithmic_y ? 3 : 1, range: () => [...range_y] },
    },
    axes: [
      { ...axis, size: (spec.nameOfX ? NAMES_PX : 5) * FINER, gap: 5 * FINER, space: (spec.logarithmic_x ? 30 : 70) * FINER, ...splitsOf(spec.logarithmic_x, spec.range_x, spec.numbers_x), values: (_plot, splits) => namesOfX(spec, splits) },
      { ...axis, size: 38 * FINER, gap: 4 * FINER, space: 17 * FINER, ...splitsOf(spec.logarithmic_y, range_y, spec.numbers_y), values: (_plot, splits) => splits.map((value) => (value === null ? '' : spec.logarithmic_y ? shortNumber(value) : significant(value))) },
    ],
    series: [{}, ...spec.lines.map(seriesOf)],
    bands: spec.goal ? [{ series: [spec.goal[1] + 1, spec.goal[0] + 1], fill: '#0B6B5822' }] : undefined,
    hooks: { drawClear: [(plot) => drawBands(plot, spec)], draw: [(plot) => drawMarks(plot, spec, colors)] },
  };
}

function seriesOf({ color, dash, width = 1.4, dots, stepped, filled }: ChartLine): uPlot.Series {
  return {
    stroke: color, width: FINER * width, dash: dash && dash.length > 0 ? dash.map((on) => on * FINER) : undefined, fill: filled ? `${color}55` : undefined,
    points: dots ? { show: true, size: FINER * dots, fill: color, width: 0 } : { show: false },
    paths: dots ? () => null : stepped ? uPlot.paths.stepped?.({ align: 1 }) : undefined,
  };
}

/** Positions of labels, unless uPlot chooses them. */
function splitsOf(logarithmic: boolean | undefined, [low, high]: readonly [number, number], given?: readonly number[]): Pick<uPlot.Axis, 'splits' | 'filter'> {
  const at = given ?? (logarithmic ? logarithmicNumbers(low, high) : undefined);
  return at ? { splits: () => [...at], filter: (_plot, splits) => splits } : {};
}

/** Labels along x; the last one that has room contains the unit. */
function namesOfX({ nameOfX, unit_x = '', range_x: [low, high], logarithmic_x }: ChartSpec, splits: readonly (number | null)[]): string[] {
  const place = (x: number): number => (logarithmic_x ? Math.log(x / low) / Math.log(high / low) : (x - low) / (high - low));
  const last = unit_x === '' ? -1 : splits.reduce((at: number, x, i) => (x !== null && place(x) <= 0.9 ? i : at), -1);
  return splits.map((x, i) => (x === null || !nameOfX ? '' : i === last ? `${nameOfX(x)} ${unit_x}` : nameOfX(x)));
}

/** A short label for an axis over many decades: 30000 as "30k". */
export const shortNumber = (value: number): string => (value >= 1e4 ? `${significant(value / 1e3)}k` : significant(value));

function drawBands(plot: uPlot, { bands = [] }: ChartSpec): void {
  const { ctx, bbox } = plot;
  for (const { from, to, color } of bands) {
    const [left, right] = [from, to].map((x) => Math.min(bbox.left + bbox.width, Math.max(bbox.left, plot.valToPos(x, 'x', true))));
    ctx.fillStyle = color;
    ctx.fillRect(left, bbox.top, Math.max(1, right - left), bbox.height);
  }
}

function drawMarks(plot: uPlot, { marks = [] }: ChartSpec, colors: Colors): void {
  const { ctx, bbox } = plot, dots = FINER * devicePixelRatio, end = bbox.left + bbox.width;
  const seen = marks.map((mark) => ({ ...mark, x: plot.valToPos(mark.at, 'x', true) })).filter(({ x }) => x >= bbox.left && x <= end);
  ctx.save();
  ctx.textAlign = 'left';
  drawMoments(ctx, bbox, seen, { dots, text_px: 11, line: colors.mark, words: colors.words, bad: colors.bad, paper: colors.paper }, new LabelPlaces(end, 4 * dots));
  ctx.restore();
}
