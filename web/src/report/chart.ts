// Charts of sheets that are printed: they stand still, and are drawn finer than a screen needs.
import uPlot from 'uplot';
import 'uplot/dist/uPlot.min.css';
import { h } from '../shared/dom';
import { rangeOf, type ChartLine } from './chart_range';

export type { ChartLine };

/** Dots of the canvas to one of the sheet, beside those of the screen: 192 dots to an inch on paper. */
const FINER = 2;
const SIGNS = '"DejaVu Sans", "Segoe UI Symbol", "Apple Symbols", sans-serif';
const FONT = '"Atkinson Hyperlegible Next Variable", Verdana, sans-serif';

export interface ChartMark { readonly at: number; readonly label: string; readonly bad: boolean }
export interface ChartBand { readonly from: number; readonly to: number; readonly color: string }

export interface ChartSpec {
  readonly title: string;
  readonly unit: string;
  /** Without the names of times. */
  readonly height_px: number;
  /** Of all lines; not falling. */
  readonly x: ArrayLike<number>;
  readonly range_x: readonly [number, number];
  readonly lines: readonly ChartLine[];
  /** Values that the axis holds at least. */
  readonly holds?: readonly [number, number];
  /** Between these two lines, by their numbers, lies what was asked for. */
  readonly goal?: readonly [low: number, high: number];
  readonly bands?: readonly ChartBand[];
  readonly marks?: readonly ChartMark[];
  /** Charts that stand over each other have the same times: the last one names them. */
  readonly nameOfX?: (x: number) => string;
  readonly logarithmic?: boolean;
  readonly filled?: boolean;
  /** A value of x was clicked. */
  readonly pick?: (x: number) => void;
}

const NAMES_PX = 21;
const heightOf = (spec: ChartSpec): number => spec.height_px + (spec.nameOfX ? NAMES_PX : 5);

/** uPlot knows a hole as null. */
const withHoles = (values: ArrayLike<number>): (number | null)[] => Array.from(values, (value) => (Number.isFinite(value) ? value : null));

/** A chart with its title and legend. It is drawn once it has a place in the page. */
export function chart(spec: ChartSpec): HTMLElement {
  const host = h('div', { class: 'chart', style: `height: ${heightOf(spec)}px`, role: 'img', 'aria-label': `${spec.title}, ${spec.unit}` });
  const legend = spec.lines.filter(({ name }) => name !== '').map(({ name, color, dash }) =>
    h('span', {}, h('i', { style: `border-top: 2.5px ${dash ? 'dashed' : 'solid'} ${color}` }), name));
  const figure = h('figure', { class: 'charted' }, h('figcaption', {}, h('b', {}, spec.title), spec.unit === '' ? '' : ` ${spec.unit}`, h('span', { class: 'legend' }, ...legend)), host);
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
  host.append(scaled);
  const plot = new uPlot(options(inColors(host, spec), FINER * host.clientWidth, FINER * heightOf(spec)),
    [Array.from(spec.x), ...spec.lines.map(({ values }) => withHoles(values))] as uPlot.AlignedData, scaled);
  if (!spec.pick) return;
  host.classList.add('picks');
  host.addEventListener('click', (event) => {
    const left = (event.clientX - host.getBoundingClientRect().left) * FINER - plot.bbox.left / devicePixelRatio;
    spec.pick?.(plot.posToVal(left, 'x'));
  });
}

/** A canvas knows no custom properties. */
function inColors(host: HTMLElement, spec: ChartSpec): ChartSpec {
  const style = getComputedStyle(host);
  const known = (color: string): string => style.getPropertyValue(/^var\((--[\w-]+)\)$/.exec(color)?.[1] ?? '').trim() || color;
  return { ...spec, lines: spec.lines.map((line) => ({ ...line, color: known(line.color) })) };
}

function options(spec: ChartSpec, width: number, height: number): uPlot.Options {
  const [low, high] = rangeOf(spec.lines, spec.holds);
  const axis: uPlot.Axis = { stroke: '#554D46', font: `${11 * FINER}px ${FONT}`, grid: { stroke: '#E4DED4', width: FINER * 0.75 }, ticks: { show: false } };
  return {
    width, height, legend: { show: false }, cursor: { show: false }, padding: [6 * FINER, 10 * FINER, 0, 0],
    scales: {
      x: { time: false, range: () => [...spec.range_x] },
      y: spec.logarithmic ? { distr: 3, range: () => [0.8, Math.max(10, 2 * high)] } : { range: () => [low, high] },
    },
    axes: [
      { ...axis, size: (spec.nameOfX ? NAMES_PX : 5) * FINER, gap: 5 * FINER, space: 70 * FINER, values: (_plot, splits) => splits.map((x) => spec.nameOfX?.(x) ?? '') },
      { ...axis, size: 38 * FINER, gap: 4 * FINER, space: 22 * FINER, values: (_plot, splits) => splits.map((value) => (value === null ? '' : numberOf(value))) },
    ],
    series: [{}, ...spec.lines.map(({ color, dash, width: thick }): uPlot.Series => ({
      stroke: color, width: FINER * (thick ?? 1.4), dash: dash?.map((dots) => dots * FINER), points: { show: false }, fill: spec.filled ? `${color}55` : undefined,
      paths: spec.filled ? uPlot.paths.stepped?.({ align: 1 }) : undefined,
    }))],
    bands: spec.goal ? [{ series: [spec.goal[1] + 1, spec.goal[0] + 1], fill: '#0B6B5822' }] : undefined,
    hooks: { drawClear: [(plot) => drawBands(plot, spec)], draw: [(plot) => drawMarks(plot, spec)] },
  };
}

/** As few decimals as the value has. */
const numberOf = (value: number): string => String(Number(value.toPrecision(6))).replace('-', '−');

function drawBands(plot: uPlot, { bands = [] }: ChartSpec): void {
  const { ctx, bbox } = plot;
  for (const { from, to, color } of bands) {
    const [left, right] = [from, to].map((x) => Math.min(bbox.left + bbox.width, Math.max(bbox.left, plot.valToPos(x, 'x', true))));
    ctx.fillStyle = color;
    ctx.fillRect(left, bbox.top, Math.max(1, right - left), bbox.height);
  }
}

function drawMarks(plot: uPlot, { marks = [] }: ChartSpec): void {
  const { ctx, bbox } = plot;
  const dots = FINER * devicePixelRatio;
  let free = -Infinity;
  ctx.save();
  ctx.textAlign = 'left';
  for (const { at, label, bad } of marks) {
    const x = plot.valToPos(at, 'x', true);
    if (!(x >= bbox.left && x <= bbox.left + bbox.width)) continue;
    ctx.strokeStyle = bad ? '#A1141A' : '#857C71';
    ctx.fillStyle = ctx.strokeStyle;
    ctx.lineWidth = (bad ? 1.6 : 0.8) * dots;
    ctx.setLineDash(bad ? [] : [2 * dots, 2 * dots]);
    ctx.beginPath();
    ctx.moveTo(x, bbox.top);
    ctx.lineTo(x, bbox.top + bbox.height);
    ctx.stroke();
    // A word that has no room is left to the table.
    if (label === '' || x < free) continue;
    // Signs, such as circled numbers, are read no smaller than that.
    ctx.font = label.length === 1 ? `${14 * dots}px ${SIGNS}` : `${bad ? 700 : 400} ${11 * dots}px ${FONT}`;
    const width = ctx.measureText(label).width;
    const left = x + 3 * dots + width > bbox.left + bbox.width;
    ctx.fillText(label, left ? x - 3 * dots - width : x + 3 * dots, bbox.top + 11 * dots);
    free = x + width + 8 * dots;
  }
  ctx.restore();
}
