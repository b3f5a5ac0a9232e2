import { fill } from '../shared/i18n';
import { h, setText, setAttribute, svg } from './dom';
import { fixed, grouped } from '../shared/format';
import { texts } from './i18n';
import type { ConsoleModel, Panel } from './model';
import { logHeight, logTicks, tail, timeEnd, type TickTimes } from './timing_model';
import { niceStep, ticksIn } from './scale';

const LEFT_PX = 30;
const BOTTOM_PX = 18;
const TOP_PX = 6;
/** A picture lower than this has no room for a second line of text, nor for every power of ten [px]. */
const LOW_PX = 96;

/** Durations of ticks: the tail as a picture, the quantiles as numbers. */
export class TimingPanel implements Panel {
  readonly element: HTMLElement;
  private readonly t = texts();
  private readonly missed = h('span', { class: 'aside num', 'data-testid': 'missed' });
  private readonly chart = h('div', { class: 'hist' });
  private readonly numbers = ['p50', 'p99', 'p99.9', this.t.timing.max].map((name) => ({ name, value: h('dd', {}, '–') }));
  private shown = '';

  constructor(private readonly model: ConsoleModel) {
    const { t } = this;
    this.element = h('section', { class: 'panel timing', 'aria-label': t.timing.title },
      h('div', { class: 'hd' }, h('h2', {}, t.timing.title), this.missed), this.chart,
      h('dl', { class: 'dl' }, ...this.numbers.map(({ name, value }) => h('div', {}, h('dt', {}, name), value))));
    this.refresh();
  }

  refresh(): void {
    const statistics = this.model.state?.statistics;
    if (!statistics) return;
    const dropped = statistics.droppedRecords > 0n ? `, ${fill(this.t.timing.dropped, { n: grouped(statistics.droppedRecords) })}` : '';
    setText(this.missed, fill(this.t.timing.missed, { n: grouped(statistics.missedDeadlines), m: grouped(statistics.ticks) }) + dropped);
    const times = {
      ticks: Number(statistics.ticks), p50_us: statistics.cpuP50Us, p99_us: statistics.cpuP99Us,
      p999_us: statistics.cpuP999Us, max_us: statistics.cpuMaxUs,
    };
    const values = [times.p50_us, times.p99_us, times.p999_us, times.max_us].map((us) => fixed(us, us < 100 ? 1 : 0));
    this.numbers.forEach(({ value }, i) => setText(value, values[i]));
    const width = this.chart.clientWidth;
    const height = this.chart.clientHeight;
    const looks = `${width}x${height} ${values.join(' ')} ${Math.round(Math.log10(Math.max(1, times.ticks)) * 20)}`;
    if (looks === this.shown || width < 60 || height < 40) return;
    this.shown = looks;
    this.chart.replaceChildren(this.picture(times, width, height, values));
  }

  private picture(times: TickTimes, width: number, height: number, values: readonly string[]): SVGElement {
    const deadline_us = (this.model.scene?.periodS ?? 1e-3) * 1e6;
    const end_us = timeEnd(deadline_us, times.max_us);
    const x = (us: number): number => LEFT_PX + (us / end_us) * (width - LEFT_PX - 4);
    const floor = height - BOTTOM_PX;
    const y = (count: number): number => floor - logHeight(count, times.ticks) * (floor - TOP_PX);
    const points = tail(times);
    // Only the order of ticks is known between two quantiles: the count falls from one to the next.
    const line = points.map((point, i) => `${i === 0 ? 'M' : 'L'}${x(point.time_us).toFixed(1)} ${y(point.count).toFixed(1)}`).join('');
    const last = points.at(-1);
    const area = last ? `${line}V${floor}H${LEFT_PX}Z` : '';
    const [p50, p99, p999, max] = values;
    // The label stands on the side of the deadline that has room.
    const side = x(deadline_us) > width / 2 ? { x: x(deadline_us) - 6, 'text-anchor': 'end' } : { x: x(deadline_us) + 6, 'text-anchor': 'start' };
    const isLow = height < LOW_PX;
    const powers = logTicks(times.ticks);
    const named = isLow ? [powers[0], powers.at(-1)].filter((power) => power !== undefined) : powers;
    const picture = svg('svg', { width, height, role: 'img', 'aria-label': fill(this.t.timing.image, { p50, p99, p999, max }) },
      ...named.flatMap(({ count, name }) => [
        svg('path', { d: `M${LEFT_PX} ${y(count)}H${width - 4}`, class: 'line' }),
        svg('text', { x: LEFT_PX - 6, y: y(count) + 4, 'text-anchor': 'end' }, name),
      ]),
      svg('path', { d: area, class: 'area' }), svg('path', { d: line, class: 'tail' }),
      ...points.slice(1).map((point) => svg('circle', { cx: x(point.time_us).toFixed(1), cy: y(point.count).toFixed(1), r: 3.5, class: point.time_us > deadline_us ? 'late' : 'dot' })),
      svg('path', { d: `M${x(deadline_us)} 0V${floor}`, class: 'deadline' }),
      svg('text', { ...side, y: 12, class: 'deadline' }, fill(this.t.timing.deadline, { t: deadline_us >= 1000 ? `${deadline_us / 1000} ms` : `${deadline_us} µs` })),
      ...(isLow ? [] : [svg('text', { ...side, y: 30 }, this.t.timing.slower)]),
      ...ticksIn(0, 0.97 * end_us, niceStep(end_us, 6)).map((us) => svg('text', { x: x(us), y: height - 3, 'text-anchor': us === 0 ? 'start' : 'middle' }, String(us))));
    setAttribute(picture, 'viewBox', `0 0 ${width} ${height}`);
    return picture;
  }
}
