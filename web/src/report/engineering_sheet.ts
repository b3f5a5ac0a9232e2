import { fixed, grouped, significant } from '../shared/format';
import { displayUnits } from '../console/history';
import { texts as consoleTexts } from '../console/i18n';
import { isArm, lookOf } from '../console/plot_specs';
import type { AxisT } from '../protocol';
import { channelKey } from '../replay/series_piece';
import { faultWord, fill } from '../shared/i18n';
import { fact, h, table } from '../shared/dom';
import { chart, type ChartLine } from '../charts/chart';
import { texts } from './i18n';
import type { Percentiles } from './report_data';
import { footer, header, timeName, timesOfSheet, isolated, type SheetContext } from './sheet';

const MOST_FAULTS = 4;

/** Page 2: sent and measured values, and the timing of the loop. */
export function engineeringSheet(context: SheetContext): HTMLElement {
  const t = texts();
  const { data } = context;
  return h('article', { class: 'sheet', 'data-testid': 'engineering' }, header(data, t.engineering),
    h('div', { class: 'charts' }, ...seriesCharts(context)),
    h('div', { class: 'two even' }, h('div', {}, timesChart(context), faults(context)), h('div', {}, stages(context))),
    settings(context), footer(data, 2));
}

type Axis = { readonly axis: AxisT; readonly i: number };

function seriesCharts({ data, scene, samples, marks, bands, look }: SheetContext): HTMLElement[] {
  const t = texts().charts;
  const all = scene.axes.map((axis, i): Axis => ({ axis, i }));
  const shared = { x: samples.times, range_x: [data.series.from_s, data.series.to_s] as const, numbers_x: timesOfSheet(data), bands, marks, pick: look };
  const charts: HTMLElement[] = [];
  const add = (title: string, unit: string, height_px: number, axes: readonly Axis[], lineOf: (axis: Axis) => ChartLine, holds?: readonly [number, number]): void => {
    if (axes.length > 0) charts.push(chart({ ...shared, title, unit, height_px, lines: axes.map(lineOf), holds }));
  };
  const line = (of: string, factor: (axis: AxisT) => number, suffix: (axis: AxisT) => string = () => '') => ({ axis, i }: Axis): ChartLine => {
    const [color, dash] = lookOf(axis);
    return {
      name: `${consoleTexts().axes[String(axis.name)] ?? String(axis.name)}${suffix(axis)}`, color: `var(${color})`, dash: dash.length > 0 ? dash : undefined,
      values: samples.values(channelKey(of, i), factor(axis)),
    };
  };
  // Torques without a lever arm are drawn in 0.1 Nm, so that they are visible beside forces.
  const effort = line('sent', (axis) => displayUnits(axis).effort * (displayUnits(axis).effortUnit === 'Nm' ? 10 : 1), (axis) => (displayUnits(axis).effortUnit === 'Nm' ? ' (0.1 Nm)' : ''));
  const place = line('q_m', (axis) => displayUnits(axis).coordinate);
  const [arm, hand] = [all.filter(({ axis }) => isArm(axis)), all.filter(({ axis }) => !isArm(axis))];
  add(t.effortHand, 'N', 84, hand, effort, [-1, 1]);
  add(t.effortArm, 'N', 68, arm, effort, [-1, 1]);
  add(t.phi, '', 42, hand.length > 0 ? hand : all, line('phi', () => 1), [0, 1]);
  add(t.handPosition, '°', 56, hand.filter(({ axis }) => displayUnits(axis).coordinateUnit !== 'mm'), place);
  add(t.armPosition, 'mm', 56, arm.filter(({ axis }) => displayUnits(axis).coordinateUnit === 'mm'), place);
  charts.push(chart({ ...shared, title: t.contact, unit: 'N', height_px: 36, lines: [{ name: '', color: '#1E1A17', values: samples.values(channelKey('contact_force_n'), 1) }], holds: [0, 1], nameOfX: timeName }));
  return charts;
}

function timesChart({ data: { engineering: { times, records }, about } }: SheetContext): HTMLElement {
  const t = texts().charts;
  const last = times.counts.length - [...times.counts].reverse().findIndex((count) => count > 0);
  const steps = Math.max(110, Math.min(times.counts.length, last + 2));
  const us = 1e6;
  const step = times.step_s * us;
  const mark = (at_s: number, name: string, bad = false): { at: number; label: string; bad: boolean } => ({ at: at_s * us, label: `${name} ${fixed(at_s * us, 0)}`, bad });
  return chart({
    title: times.is_cpu ? t.timesCpu : t.times, unit: `µs, ${grouped(records)} ${t.ticks}`, height_px: 96, logarithmic_y: true, range_y: [0.8, Math.max(10, 2 * Math.max(...times.counts))],
    x: Array.from({ length: steps }, (_, i) => i * step), range_x: [0, steps * step],
    lines: [{ name: '', color: '#0B6B58', stepped: true, filled: true, values: Array.from({ length: steps }, (_, i) => (times.counts[i] > 0 ? times.counts[i] : 0.8)) }],
    marks: [mark(times.tick.p50_s, 'p50'), mark(times.tick.p999_s, 'p99.9'), mark(about.period_s, consoleTexts().timing.deadline.replace('{t}', '').trim(), true)],
    nameOfX: (x) => fixed(x, 0),
  });
}

function stages({ data: { engineering: { times } } }: SheetContext): HTMLElement {
  const t = texts().stages;
  const us = (seconds: number): string => fixed(1e6 * seconds, 1);
  const cells = (name: string, p: Percentiles): string[] => [name, us(p.p50_s), us(p.p99_s), us(p.p999_s), us(p.max_s)];
  return h('section', {}, h('h2', {}, t.title), table([t.stage, 'p50', 'p99', 'p99.9', t.max],
    [...times.stages.map((stage) => cells(t.names[stage.name] ?? stage.name, stage)), cells(t.whole, times.tick_cpu)]));
}

function faults({ data: { engineering } }: SheetContext): HTMLElement {
  const t = texts().faults;
  const rows = engineering.faults.slice(0, MOST_FAULTS).map(({ name, ticks, axis }) => [faultWord(name), grouped(ticks), consoleTexts().axesLong[axis] ?? axis]);
  return h('section', {}, h('h2', {}, t.title), rows.length === 0 ? h('p', { class: 'none' }, texts().none) : table([t.fault, t.ticks, t.axis], rows));
}

function settings({ data: { about, engineering: e }, scene }: SheetContext): HTMLElement {
  const t = texts().settings;
  const c = consoleTexts();
  const gains = [e.settings.paper ? t.paper : '', e.settings.uncertified ? t.uncertified : t.accepted].filter(Boolean).join(', ');
  const limits = scene.axes.map((axis) => {
    const { effort, effortUnit } = displayUnits(axis);
    return `${c.axes[String(axis.name)] ?? String(axis.name)} ${Number((axis.effortLimit * effort).toFixed(2))} ${effortUnit}`;
  }).join('; ');
  const rows: [string, string][] = [
    [t.scene, e.settings.scene], [t.rendering, e.settings.rendering], [t.engine, e.settings.engine],
    [t.rate, `${fixed(1 / about.period_s, 0)} Hz, ${e.settings.simulated_clock ? t.simulatedClock : t.realTime}`], [t.gains, gains],
    [t.deadlines, `${grouped(e.missed_deadlines)} / ${grouped(e.records + e.missed_deadlines)}`], [t.damped, fill(t.share, { n: fixed(100 * e.damped_share, 0) })],
    [t.coupling, `${fixed(1e6 * e.coupling_error_rad, 2)} µrad`], [t.work, `${significant(e.work_j, 3)} J`], [t.passport, e.settings.passport], [t.seed, e.settings.seed], [t.limits, limits],
  ];
  return h('section', {}, h('h2', {}, t.title), h('dl', { class: 'settings' }, ...rows.filter(([, value]) => value !== '').map(([name, value]) => fact(name, isolated(value)))));
}
