import { duration, fixed, grouped, significant } from '../shared/format';
import { displayUnits } from '../console/history';
import { texts as consoleTexts } from '../console/i18n';
import { lookOf } from '../console/plot_specs';
import { sessionWords } from '../console/title_words';
import { REPORTS } from '../exercises/info';
import { dateWords } from '../replay/facts_panel';
import { faultWord, fill, language } from '../shared/i18n';
import { h, table } from '../shared/dom';
import { channelKey } from '../replay/series_piece';
import { chart, type ChartLine } from '../charts/chart';
import { comparedSection } from './compared';
import { compareWithBefore, type FigureComparison, type Comparison } from './figures';
import { texts } from './i18n';
import { stepTimes, valueAt } from './limits';
import { pictureFrame } from './picture';
import { bodyWords, footer, header, shortTime, signWords, timeName, timesOfSheet, isolated, type SheetContext } from './sheet';
import { GivenHelp, Mover } from './report_data';
import { recordedOf, sharePercent, marksByKind, whoseWords } from './therapy';

const MOST_ROWS = 4, MOST_TIMES = 3, MOST_TILES = 7;

/** Page 1: the person's actions, and stops and faults. */
export function therapySheet(context: SheetContext): HTMLElement {
  const t = texts();
  const { data } = context;
  const comparison = compareWithBefore(data);
  return h('article', { class: 'sheet', 'data-testid': 'therapy' }, header(data, t.therapy), tiles(context, comparison), whoMoved(context), sessionBefore(context, comparison), comparedSection(data),
    h('div', { class: 'two' }, pictureFrame(data), h('div', {}, happened(context), ...partTables(context))),
    h('div', { class: 'charts' }, ...gripChart(context), limitsChart(context)),
    bodies(context),
    h('p', { class: 'note' }, [data.therapy.touches.length > 0 ? t.charts.touches : '', data.therapy.touches_left_out > 0 ? fill(t.charts.touchesLeftOut, { n: grouped(data.therapy.touches_left_out) }) : '',
      data.series.gaps.length + data.series.unreadable.length > 0 ? t.charts.missing : '', data.therapy.limits_between_s > 0.11 ? fill(t.charts.limitsThinned, { s: fixed(data.therapy.limits_between_s, 1) }) : '', signWords(context.marks), data.therapy.has_grip_force ? t.steadinessNote : ''].filter(Boolean).join(' ')),
    footer(data, 1));
}

const tile = (figure: string, unit: string, words: string, before?: HTMLElement): HTMLElement => h('div', {}, h('b', {}, figure, unit === '' ? '' : h('small', {}, ` ${unit}`)), h('span', {}, isolated(words)), before ?? null);

/** The figure in the session before, and whether the present one is better. */
function beforeLine({ before: { shown, unit }, became }: FigureComparison): HTMLElement {
  const t = texts().before;
  return h('em', { 'data-became': became }, `${fill(t.was, { x: `${shown} ${unit}`.trim() })}${became === 'better' ? `, ${t.better}` : ''}`);
}

function tiles({ data, scene }: SheetContext, { figures }: Comparison): HTMLElement {
  const t = texts().tiles;
  const { therapy, engineering } = data;
  const out = figures.map(({ shown, unit, words, compared }) => tile(shown, unit, words, compared && beforeLine(compared)));
  if (out.length < 4) {
    out.push(tile(String(therapy.bodies.length), fill(t.of, { n: therapy.bodies_in_scene }), t.touched),
      tile(fixed(therapy.bodies.reduce((sum, { held_s }) => sum + held_s, 0), 1), 's', t.held), tile(fixed(therapy.largest_force_n, 1), 'N', t.force));
    const most = largestEffort(scene.axes, engineering.largest_effort);
    if (most) out.push(most);
  }
  return h('section', { class: 'tiles' }, ...out.slice(0, MOST_TILES + 1));
}

/** Times by mover of the hand, movements that are excluded from figures, and the rule of attribution. */
function whoMoved({ data: { therapy: { moved, sums, reaches, grips, touches_not_persons }, about } }: SheetContext): HTMLElement {
  const t = texts().whose;
  const all = moved.by.reduce((sum, periods) => sum + periods, 0);
  const time = (periods: number): string => duration(periods * about.period_s);
  const share = (periods: number): string => sharePercent(all > 0 ? periods / all : 0);
  const movers = [Mover.Person, Mover.VirtualPatient, Mover.Motion, Mover.Nobody].filter((by) => (moved.by[by] ?? 0) > 0 || by === Mover.Person)
    .map((by) => fill(t.moved, { who: t.who[by], n: share(moved.by[by] ?? 0), time: time(moved.by[by] ?? 0) }));
  const helped = [GivenHelp.Full, GivenHelp.Some, GivenHelp.None].filter((help) => (moved.helped[help] ?? 0) > 0).map((help) => `${t.helps[help]} ${time(moved.helped[help]!)}`);
  const sentence = movers.join(', ');
  const apart = [...Object.entries(sums), ['reach', reaches] as const, ['grip', grips] as const]
    .filter(([, { shared, others }]) => shared + others > 0).map(([what, { shared, others }]) => fill(t.apart, { what: REPORTS.map((report) => report.thing(what)).find((words) => words !== undefined) ?? t.things[what] ?? what, n: [shared > 0 ? fill(t.sharedCount, { n: grouped(shared) }) : '', others > 0 ? fill(t.othersCount, { n: grouped(others) }) : ''].filter(Boolean).join(', ') }));
  if (touches_not_persons > 0) apart.push(fill(t.touches, { n: grouped(touches_not_persons) }));
  return h('p', { class: 'moved', 'data-testid': 'moved', 'data-share': String(moved.share) },
    h('b', { 'data-testid': 'active' }, `${fill(t.active, { time: time(moved.active_periods) })}${moved.helped_periods > 0 ? `, ${fill(t.activeHelped, { time: time(moved.helped_periods) })}` : ''}${moved.led_periods > 0 ? `; ${fill(t.led, { time: time(moved.led_periods) })}` : ''}. `),
    `${sentence.charAt(0).toUpperCase()}${sentence.slice(1)}. `, helped.length > 0 ? `${fill(t.helped, { helps: helped.join(', ') })} ` : '',
    apart.length > 0 ? `${fill(t.notCounted, { what: apart.join('; ') })} ` : '', t.rule);
}

/** The session that this one is compared with, the differences, and the figures that are not compared. */
function sessionBefore({ data: { before } }: SheetContext, { differences, figures }: Comparison): HTMLElement | null {
  if (!before) return null;
  const t = texts();
  const words = fill(t.before.compared, { name: sessionWords(before.about), date: dateWords(before.about.created_utc, language()) });
  const alone = figures.filter(({ compared }) => !compared).map((figure) => figure.words);
  const other = differences.length === 0 ? '' : fill(t.before.other, { what: differences.map((what) => t.facts[what]).join(', ') });
  const not = alone.length === figures.length ? t.before.nothing : alone.length > 0 ? fill(t.before.not, { what: alone.join(', ') }) : '';
  return h('p', { class: 'before', 'data-testid': 'before' }, isolated(words), other === '' ? '' : h('b', {}, ` ${other}`), not === '' ? '' : ` ${not}`);
}

function largestEffort(axes: SheetContext['scene']['axes'], efforts: readonly number[]): HTMLElement | undefined {
  const shown = axes.map((axis, i) => ({ axis, effort: (efforts[i] ?? NaN) * displayUnits(axis).effort, limit: axis.effortLimit * displayUnits(axis).effort }))
    .filter(({ axis, effort }) => displayUnits(axis).effortUnit === 'N' && Number.isFinite(effort));
  if (shown.length === 0) return undefined;
  // The axis nearest to its own limit.
  const most = shown.reduce((a, b) => (b.effort / b.limit > a.effort / a.limit ? b : a));
  const name = String(most.axis.name);
  return tile(fixed(most.effort, 1), `N ${fill(texts().tiles.of, { n: significant(most.limit, 3) })}`, fill(texts().tiles.effort, { axis: consoleTexts().axesLong[name] ?? name }));
}

/** A table of all kinds of incidents, including those that did not occur. */
function happened({ data }: SheetContext): HTMLElement {
  const t = texts();
  const { about, series, engineering } = data;
  // A plain stop is the usual end of a session, so it is not highlighted.
  const row = (kind: string, count: number, what: string): HTMLElement => h('tr', { class: count > 0 && kind !== 'stop' ? 'bad' : undefined, 'data-kind': kind },
    h('td', {}, t.happened[kind as keyof typeof t.happened]), h('td', {}, count > 0 ? isolated(what) : t.none));
  const rows = marksByKind(series).map(({ kind, marks }) => row(kind, marks.length, timesOf(marks.map(({ time_s, text, axis }) => {
    const why = [text.split(', ').filter(Boolean).map(faultWord).join(', '), consoleTexts().axesLong[axis] ?? axis].filter(Boolean).join(', ');
    return kind === 'fault' && why !== '' ? `${shortTime(time_s)} (${why})` : shortTime(time_s);
  }))));
  const limited = engineering.faults.find(({ name }) => name === 'effort limited')?.ticks ?? 0;
  rows.push(
    row('missing', about.ticks_missing, `${fill(t.happened.lost, { n: grouped(about.ticks_missing), s: fixed(about.ticks_missing * about.period_s, 2) })}; ${timesOf(series.gaps.map(({ from_s }) => shortTime(from_s)))}`),
    row('missed', engineering.missed_deadlines, fill(t.happened.ticks, { n: grouped(engineering.missed_deadlines) })),
    row('limited', limited, fill(t.happened.ticks, { n: grouped(limited) })));
  const notes = [
    about.whole ? '' : about.unreadable_from_s === undefined ? t.happened.unreadableEnd : fill(t.happened.unreadable, { time: shortTime(about.unreadable_from_s) }),
    ...series.unreadable.slice(0, 1).map(({ from_s }) => (about.whole ? fill(t.happened.unreadable, { time: shortTime(from_s) }) : '')),
    about.still_written ? t.happened.written : '', about.ended_by === 'broken_off' ? t.happened.brokenOff : '', series.truncated && series.unreadable.length === 0 ? t.happened.truncated : '',
  ].filter(Boolean);
  return h('section', { class: 'happened' }, h('h2', {}, t.happened.title), h('table', {}, h('tbody', {}, ...rows)), ...notes.map((words) => h('p', { class: 'warn' }, words)));
}

function timesOf(times: readonly string[]): string {
  const t = texts().happened;
  const first = times.slice(0, MOST_TIMES).join(', ');
  return fill(t.at, { times: times.length > MOST_TIMES ? fill(t.more, { times: first, n: times.length - MOST_TIMES }) : first });
}

/** Tables of the finished parts, if the exercise has parts. */
function partTables({ data }: SheetContext): HTMLElement[] {
  return REPORTS.flatMap((report) => report.table(recordedOf(data), shortTime, whoseWords) ?? []).map(({ title, none, head, rows }) => {
    const shown = rows.slice(0, MOST_ROWS).map(([name, ...figures]) => [isolated(name), ...figures]);
    return h('section', {}, h('h2', {}, title), shown.length === 0 ? h('p', { class: 'none' }, none) : table(head, shown),
      rows.length > MOST_ROWS ? h('p', { class: 'none' }, fill(texts().bodies.more, { n: rows.length - MOST_ROWS })) : null);
  });
}

/** The grip force with its goal range, if the exercise defines one; else all contact forces. */
function gripChart({ data, samples, marks, bands, look }: SheetContext): HTMLElement[] {
  const t = texts().charts;
  const of = (name: string): ArrayLike<number> | undefined => {
    const index = data.about.value_names.indexOf(name);
    return index < 0 ? undefined : samples.values(channelKey('value', index), 1);
  };
  const shared = { unit: 'N', x: samples.times, range_x: [data.series.from_s, data.series.to_s] as const, numbers_x: timesOfSheet(data), bands, marks, pick: look };
  const contact = chart({ ...shared, title: t.contact, height_px: 60, lines: [{ name: '', color: '#1E1A17', values: samples.values('contact_force_n/0', 1) }], holds: [0, 1] });
  const grip = of('squeeze_n');
  if (!grip) return [contact];
  // The exercise's panel names the values that bound the goal range.
  const asks = data.scene?.panel?.values.find(({ name }) => name === 'squeeze_n');
  const [low, high] = [of(String(asks?.goalLower ?? '')), of(String(asks?.goalUpper ?? ''))];
  // Both bounds are zero where there is no goal.
  const asked = (values: ArrayLike<number>): number[] => Array.from(values, (value, i) => (high && high[i] > 0 ? value : NaN));
  const goal = low && high ? [asked(low), asked(high)] : [];
  const goals = goal.map((values, i): ChartLine => ({ name: i === 0 ? t.goal : '', color: '#0B6B58', dash: [4, 3], width: 1, values }));
  return [chart({ ...shared, title: t.grip, height_px: 100, lines: [{ name: '', color: '#8A5A00', width: 1.6, values: grip }, ...goals], goal: goals.length === 2 ? [1, 2] : undefined, holds: [0, 1] }), contact];
}

/** The limits of each axis over time; limits that change together are one line. */
function limitsChart({ data, scene, marks, look }: SheetContext): HTMLElement | null {
  const { from_s, to_s } = data.series;
  const axes = scene.axes.map((axis, i) => ({ axis, changes: data.therapy.limits[i] ?? [], ...displayUnits(axis) })).filter(({ changes }) => changes.length > 0);
  if (axes.length === 0) return null;
  const x = stepTimes(axes.map(({ changes }) => changes), to_s);
  const lines = new Map<string, { names: string[]; line: ChartLine }>();
  for (const { axis, changes, effort, effortUnit } of axes) {
    const name = String(axis.name);
    const scaled = effortUnit === 'N' ? effort : effort * 10;
    const values = x.map((time_s, i) => valueAt(changes, time_s, x[i + 1] === time_s) * scaled);
    const key = values.map((value) => value.toPrecision(6)).join();
    const word = `${consoleTexts().axes[name] ?? name}${effortUnit === 'N' ? '' : ' (0.1 Nm)'}`;
    const same = lines.get(key);
    if (same) same.names.push(word);
    else lines.set(key, { names: [word], line: { name: '', color: `var(${lookOf(axis)[0]})`, values } });
  }
  return chart({
    title: texts().charts.limits, unit: 'N', height_px: 40, x, range_x: [from_s, to_s], numbers_x: timesOfSheet(data), marks: marks.filter(({ bad }) => bad), nameOfX: timeName, pick: look, holds: [0, 1],
    lines: [...lines.values()].map(({ names, line }) => ({ ...line, name: names.join(', ') })),
  });
}

function bodies({ data: { therapy, scene } }: SheetContext): HTMLElement {
  const t = texts().bodies;
  if (therapy.bodies.length === 0) return h('section', {}, h('h2', {}, t.title), h('p', { class: 'none' }, therapy.bodies_in_scene === 0 ? t.noBodies : t.nothing));
  const sorted = [...therapy.bodies].sort((a, b) => b.held_s + b.longest_s - a.held_s - a.longest_s);
  return h('section', {}, h('h2', {}, t.title),
    table([t.body, t.first, t.touches, t.longest, t.held, t.force, t.way], sorted.slice(0, MOST_ROWS).map((b) => [
      isolated(bodyWords(b.name, scene)), shortTime(b.first_s), grouped(b.touches), fixed(b.longest_s, 1), fixed(b.held_s, 1), fixed(b.largest_force_n, 1), fixed(100 * b.travelled_m, 1)])),
    h('p', { class: 'note' }, sorted.length > MOST_ROWS ? `${fill(t.more, { n: sorted.length - MOST_ROWS })}. ` : '', t.note));
}
