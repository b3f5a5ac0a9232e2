import { h, svg } from '../console/dom';
import { fill } from '../shared/i18n';
import { texts } from './i18n';
import type { Curve } from './records';
import { itemWords, number, resultName, shortDay } from './words';

/** A curve needs at least two visits. */
const LEAST = 2;
const WIDTH = 400, HEIGHT = 132, LEFT = 40, RIGHT = 12, TOP = 10, BOTTOM = 24;

/** The interval of a value at a time, in which it lies with 95 %. */
export type Interval = readonly [low: number, high: number];
/** A curve whose values may have intervals, in the order of its points. */
export interface IntervalCurve extends Curve { readonly intervals?: readonly (Interval | undefined)[] }

/** Curves, with those that are the bounds of another one (threshold_low_percent, threshold_high_percent of threshold_percent) as its intervals. */
export function withIntervals(curves: readonly Curve[]): readonly IntervalCurve[] {
  const bound = (of: Curve, which: 'low' | 'high'): Curve | undefined => {
    const cut = of.name.lastIndexOf('_');
    return curves.find(({ name, exercise }) => cut > 0 && exercise === of.exercise && name === `${of.name.slice(0, cut)}_${which}${of.name.slice(cut)}`);
  };
  const bounded = curves.map((curve) => ({ curve, low: bound(curve, 'low'), high: bound(curve, 'high') })).filter(({ low, high }) => low && high);
  const bounds = new Set(bounded.flatMap(({ low, high }) => [low, high]));
  return curves.filter((curve) => !bounds.has(curve)).map((curve) => {
    const of = bounded.find((one) => one.curve === curve);
    const at = (bounding: Curve | undefined, t_us: number): number | undefined => bounding?.points.find(([t]) => t === t_us)?.[1];
    return !of ? curve : { ...curve, intervals: curve.points.map(([t_us]) => {
      const low = at(of.low, t_us), high = at(of.high, t_us);
      return low === undefined || high === undefined ? undefined : [low, high] as const;
    }) };
  });
}

/** What the intervals of the first and the last value say: they overlap (no change can be said), or they do not; undefined: an interval is missing. */
export function intervalsOverlap({ intervals }: IntervalCurve): boolean | undefined {
  const first = intervals?.[0], last = intervals?.at(-1);
  if (!first || !last || intervals!.length < LEAST) return undefined;
  return first[0] <= last[1] && last[0] <= first[1];
}

export interface CurvePoints {
  readonly dots: readonly (readonly [x: number, y: number])[];
  /** The ends of each value's interval; undefined: it has none. */
  readonly bars: readonly (readonly [x: number, top: number, bottom: number] | undefined)[];
  readonly low: number;
  readonly high: number;
}

/** The points of a curve in the picture; undefined while there are too few. Values between the points are not interpolated. */
export function curvePoints({ points, intervals }: IntervalCurve): CurvePoints | undefined {
  const good = points.map(([t_us, value], i) => [t_us, value, intervals?.[i]] as const).filter(([t_us, value]) => Number.isFinite(t_us) && Number.isFinite(value)).sort(([a], [b]) => a - b);
  if (good.length < LEAST) return undefined;
  const values = good.flatMap(([, value, interval]) => [value, ...(interval ?? [])]);
  let [low, high] = [Math.min(...values), Math.max(...values)];
  if (low > 0 && low < high) low = low / high < 0.5 ? 0 : low;
  if (low === high) [low, high] = low === 0 ? [0, 1] : [Math.min(0, low), Math.max(0, high)];
  const [first, last] = [good[0][0], good.at(-1)![0]];
  const x = (t_us: number, i: number): number => LEFT + (WIDTH - LEFT - RIGHT) * (last > first ? (t_us - first) / (last - first) : i / (good.length - 1));
  const y = (value: number): number => TOP + (HEIGHT - TOP - BOTTOM) * (1 - (value - low) / (high - low));
  return {
    low, high, dots: good.map(([t_us, value], i) => [x(t_us, i), y(value)]),
    bars: good.map(([t_us, , interval], i) => interval && [x(t_us, i), y(interval[1]), y(interval[0])]),
  };
}

/** Less than a minute is no figure to compare. */
const isShort = ({ name }: Curve, value: number | undefined): boolean => name === 'active_min' && value !== undefined && value > 0 && value < 1;
const figure = (curve: Curve, value: number): string => (isShort(curve, value) ? texts().curves.short : curve.name === 'active_min' ? String(Math.round(value)) : number(value));

/** One value over the visits, with the last one as a number. */
export function curveFigure(curve: IntervalCurve): HTMLElement {
  const t = texts().curves, drawn = curvePoints(curve);
  const name = [resultName(curve.name), curve.exercise ? itemWords({ exercise: curve.exercise, level: 0 }) : ''].filter(Boolean).join(', ');
  const last = curve.points.at(-1);
  const head = h('figcaption', {}, h('b', {}, name), h('span', { class: 'num last' }, last ? figure(curve, last[1]) : '', curve.unit && !isShort(curve, last?.[1]) ? h('small', {}, ` ${curve.unit}`) : null));
  if (!drawn) return h('figure', { class: 'curve' }, head, h('p', { class: 'none' }, last ? '' : t.none));
  return h('figure', { class: 'curve' }, head, picture(curve, drawn, fill(t.image, { name, n: drawn.dots.length, first: number(curve.points[0][1]), last: number(last![1]) })), changeWords(curve));
}

/** Whether the values changed beyond their intervals; nothing where there are none. */
function changeWords(curve: IntervalCurve): HTMLElement | null {
  const overlap = intervalsOverlap(curve), t = texts().curves;
  return overlap === undefined ? null : h('p', { class: 'change' }, overlap ? t.noChange : t.change);
}

function picture({ points }: Curve, { dots, bars, low, high }: CurvePoints, words: string): SVGElement {
  const [bottom, top] = [HEIGHT - BOTTOM, TOP];
  const text = (x: number, y: number, of: string, anchor: string): SVGElement => svg('text', { x, y, 'text-anchor': anchor }, of);
  return svg('svg', { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, role: 'img', 'aria-label': words },
    ...[top, bottom].map((y) => svg('path', { class: 'grid', d: `M${LEFT} ${y}H${WIDTH - RIGHT}` })),
    text(LEFT - 6, top + 4, number(high), 'end'), text(LEFT - 6, bottom + 4, number(low), 'end'),
    text(LEFT, HEIGHT - 5, shortDay(points[0][0]), 'start'), text(WIDTH - RIGHT, HEIGHT - 5, shortDay(points.at(-1)![0]), 'end'),
    ...bars.flatMap((bar) => (bar ? [svg('path', { class: 'interval', d: `M${bar[0].toFixed(1)} ${bar[1].toFixed(1)}V${bar[2].toFixed(1)}` })] : [])),
    svg('polyline', { class: 'joined', points: dots.map(([x, y]) => `${x.toFixed(1)},${y.toFixed(1)}`).join(' ') }),
    ...dots.map(([x, y], i) => svg('circle', { cx: x.toFixed(1), cy: y.toFixed(1), r: i === dots.length - 1 ? 5 : 3.5 })));
}
