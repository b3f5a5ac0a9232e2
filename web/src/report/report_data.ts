// The data that the program wrote into the page: src/replay/recording_report.cpp. It is parsed once and never trusted.
import { unpackBytes, type Json } from '../embedded/page_data';
import type { SceneT } from '../protocol';
import { readAbout, readResults, type RecordingInfo, type Result } from '../replay/about';
import { BodiesHistory } from '../replay/bodies_history';
import { readScene, splitStates } from '../replay/messages';
import { Problem } from '../replay/problem';
import { readPiece, type SeriesPiece } from '../replay/series_piece';

const VERSION = 1;

export interface HeldBody { readonly name: string; readonly touches: number; readonly first_s: number; readonly longest_s: number; readonly held_s: number; readonly largest_force_n: number; readonly travelled_m: number }
export interface Touch { readonly body: string; readonly from_s: number; readonly to_s: number; readonly held_s: number; readonly largest_force_n: number }
/** The mover of the hand, and the degree of help: the numbers of src/loop/core/tick_record.hpp. */
export enum Mover { Nobody, Person, VirtualPatient, Motion }
export enum GivenHelp { Unspecified, Full, Some, None }
/** Attribution of a part (the rule: src/replay/therapy_facts.hpp). `by` moved longest; `share` is the person's share. */
export interface Attribution { readonly by: Mover; readonly share: number; readonly help: GivenHelp; readonly persons: boolean }
/** A finished part of an exercise, for example a band of force or a level. */
export interface Part extends Attribution {
  /** The event that finished it. */
  readonly event: string; readonly index: number; readonly value: number; readonly from_s: number; readonly to_s: number; readonly stars: number;
  /** Steps of a part that has some. */
  readonly steps: readonly (readonly [index: number, amount_l: number])[];
}
/** Sums over all parts that one event finishes: all except `shared` and `others` cover the person's parts. */
export interface PartSums { readonly count: number; readonly shared: number; readonly others: number; readonly value: number; readonly stars: number; readonly helps: readonly number[] }
export interface PartCounts { readonly count: number; readonly shared: number; readonly others: number }
/** Time by mover of the hand [periods], and the intervals. */
export interface MovementRuns {
  readonly by: readonly number[]; readonly helped: readonly number[]; readonly share: number;
  /** Active, the helped part of it, and led (the rule: src/loop/core/active_time.hpp). */
  readonly active_periods: number; readonly helped_periods: number; readonly led_periods: number;
  readonly runs: readonly (readonly [from_s: number, to_s: number, by: Mover])[]; readonly runs_left_out: number;
}
/** A value that holds from a time until the next change. */
export type Change = readonly [time_s: number, value: number];

/** What the answers of an exercise that compares say about a threshold (src/replay/compared_answers.hpp). */
export interface Compared {
  readonly answers: number; readonly saidBy: Readonly<Record<string, number>>; readonly persons: boolean;
  readonly enough: boolean; readonly missing: readonly string[]; readonly missingAnswers: number;
  /** second / first of which three of four are told apart, and its 95 % interval. */
  readonly ratio: number; readonly low: number; readonly high: number; readonly openBelow: boolean; readonly openAbove: boolean;
  readonly atDeviceLimit: boolean; readonly otherRight: number; readonly mostX: number; readonly mostRatio: number;
  /** x = ln(second / first): number of answers there, and of those "the second". */
  readonly points: readonly (readonly [x: number, answers: number, second: number])[];
  readonly curve: readonly (readonly [x: number, share: number])[];
}

/** Figures of the person, unless stated otherwise. */
export interface Therapy {
  readonly moved: MovementRuns;
  readonly parts: readonly Part[]; readonly parts_left_out: number; readonly sums: Readonly<Record<string, PartSums>>;
  readonly reaches: PartCounts & { readonly sum_s: number };
  readonly results: readonly Result[];
  readonly bodies: readonly HeldBody[]; readonly bodies_in_scene: number;
  /** Touches by anybody. */
  readonly touches: readonly Touch[]; readonly touches_left_out: number; readonly touches_not_persons: number;
  readonly grips: PartCounts & { readonly mean_n: number; readonly variation: number }; readonly has_grip_force: boolean;
  /** Limits of each axis, in its own unit. Changes that are closer than `limits_between_s` are merged. */
  readonly limits: readonly (readonly Change[])[]; readonly limits_between_s: number;
  readonly largest_force_n: number;
  /** undefined: the exercise does not compare. */
  readonly compared: Compared | undefined;
  /** The strongest contact of the person, else of anybody. Its state is among those of the page. */
  readonly strongest: { readonly force_n: number; readonly time_s: number; readonly by: Mover };
}

export interface Percentiles { readonly p50_s: number; readonly p99_s: number; readonly p999_s: number; readonly max_s: number }
export interface Fault { readonly name: string; readonly ticks: number; readonly stops: boolean; readonly axis: string }

export interface Engineering {
  readonly records: number; readonly missed_deadlines: number; readonly stopping_faults: number; readonly faults: readonly Fault[];
  readonly largest_effort: readonly number[]; readonly work_j: number; readonly contacts_max: number; readonly coupling_error_rad: number; readonly damped_share: number;
  readonly times: { readonly is_cpu: boolean; readonly tick: Percentiles; readonly tick_cpu: Percentiles; readonly stages: readonly (Percentiles & { readonly name: string })[]; readonly step_s: number; readonly counts: readonly number[] };
  readonly settings: { readonly scene: string; readonly rendering: string; readonly engine: string; readonly simulated_clock: boolean; readonly paper: boolean; readonly uncertified: boolean; readonly passport: string; readonly seed: string };
}

export interface ReportData {
  readonly about: RecordingInfo;
  /** undefined: the scene cannot be built from the file, and there are no states. */
  readonly scene: SceneT | undefined;
  readonly rows: readonly number[];
  readonly states: readonly Uint8Array[];
  /** Bodies of a game, at the rows that have states. */
  readonly bodies: BodiesHistory;
  readonly series: SeriesPiece;
  readonly therapy: Therapy;
  readonly engineering: Engineering;
  /** The session before, with figures only; undefined if none was given. */
  readonly before: ReportData | undefined;
}

const asJson = (value: unknown): Json => (typeof value === 'object' && value !== null && !Array.isArray(value) ? (value as Json) : {});
const objects = (value: unknown): Json[] => (Array.isArray(value) ? value.map(asJson) : []);
const numbers = (value: unknown): number[] => (Array.isArray(value) ? value.map(Number) : []);
const number = (value: unknown): number => (typeof value === 'number' && Number.isFinite(value) ? value : 0);
const text = (value: unknown): string => (typeof value === 'string' ? value.slice(0, 2000) : '');

/** Parses the data of a page; throws a Problem if nothing in it can be shown. */
export async function readReport(data: Json): Promise<ReportData> {
  if (data.page !== 'report') throw new Problem('nonsense', 'the page carries no report');
  if (data.version !== VERSION) throw new Problem('nonsense', `data of version ${String(data.version)}, page of version ${VERSION}`);
  const about = readAbout(data.about);
  const states = asJson(data.states);
  try {
    const rows = numbers(states.rows);
    const messages = rows.length > 0 ? splitStates(await unpackBytes(text0(states.messages))) : [];
    if (messages.length !== rows.length) throw new Problem('nonsense', `${rows.length} rows with ${messages.length} states`);
    const scene = typeof data.scene === 'string' ? readScene(new Uint8Array(await unpackBytes(data.scene))) : undefined;
    const bodies = typeof data.bodies === 'string' ? BodiesHistory.read(await unpackBytes(data.bodies)) : new BodiesHistory();
    return {
      about, scene, rows, states: messages, bodies, series: readPiece(await unpackBytes(text0(data.series))),
      therapy: readTherapy(asJson(data.therapy)), engineering: readEngineering(asJson(data.engineering)),
      before: asJson(data.before).page === undefined ? undefined : await readReport({ ...asJson(data.before), before: undefined }),
    };
  } catch (thrown) {
    throw thrown instanceof Problem ? thrown : new Problem('nonsense', 'a part of the page is damaged');
  }
}

const text0 = (value: unknown): string => (typeof value === 'string' ? value : '');

const one = <T extends number>(value: unknown, most: T): T => Math.min(most, Math.max(0, Math.trunc(number(value)))) as T;
const counted = (json: Json): PartCounts => ({ count: number(json.count), shared: number(json.shared), others: number(json.others) });
const pairs = (value: unknown): number[][] => (Array.isArray(value) ? value.map(numbers) : []);

function readPart(json: Json): Part {
  return {
    event: text(json.event), index: number(json.index), value: number(json.value), from_s: number(json.from_s), to_s: number(json.to_s), stars: number(json.stars),
    steps: pairs(json.steps).map(([index, amount_l]) => [number(index), number(amount_l)]),
    by: one(json.by, Mover.Motion), share: number(json.share), help: one(json.help, GivenHelp.None), persons: json.persons === true,
  };
}

function readMoved(json: Json): MovementRuns {
  return {
    by: numbers(json.by).map(number), helped: numbers(json.helped).map(number), share: number(json.share),
    active_periods: number(json.active_periods), helped_periods: number(json.helped_periods), led_periods: number(json.led_periods),
    runs: pairs(json.runs).map(([from_s, to_s, by]) => [number(from_s), number(to_s), one(by, Mover.Motion)]), runs_left_out: number(json.runs_left_out),
  };
}

function readCompared(json: Json): Compared {
  return {
    answers: number(json.answers), persons: json.persons === true, enough: json.enough === true, missingAnswers: number(json.missing_answers),
    saidBy: Object.fromEntries(Object.entries(asJson(json.said_by)).map(([by, count]) => [by, number(count)])), missing: (Array.isArray(json.missing) ? json.missing : []).map(text),
    ratio: number(json.ratio), low: number(json.ratio_low), high: number(json.ratio_high), openBelow: json.open_below === true, openAbove: json.open_above === true,
    atDeviceLimit: json.at_device_limit === true, otherRight: number(json.other_right), mostX: number(json.most_x), mostRatio: number(json.most_ratio),
    points: pairs(json.points).map(([x, answers, second]) => [number(x), number(answers), number(second)]), curve: pairs(json.curve).map(([x, share]) => [number(x), number(share)]),
  };
}

function readTherapy(json: Json): Therapy {
  const [grips, reaches, strongest] = [asJson(json.grips), asJson(json.reaches), asJson(json.strongest)];
  const sums = Object.entries(asJson(json.sums)).map(([event, value]): [string, PartSums] => {
    const of = asJson(value);
    return [event, { ...counted(of), value: number(of.value), stars: number(of.stars), helps: numbers(of.helps).map(number) }];
  });
  return {
    moved: readMoved(asJson(json.moved)), parts: objects(json.parts).map(readPart), parts_left_out: number(json.parts_left_out), sums: Object.fromEntries(sums),
    reaches: { ...counted(reaches), sum_s: number(reaches.sum_s) }, results: readResults(json.results),
    bodies: objects(json.bodies).map((b) => ({
      name: text(b.name), touches: number(b.touches), first_s: number(b.first_s), longest_s: number(b.longest_s), held_s: number(b.held_s),
      largest_force_n: number(b.largest_force_n), travelled_m: number(b.travelled_m),
    })),
    bodies_in_scene: number(json.bodies_in_scene),
    touches: objects(json.touches).map((t) => ({ body: text(t.body), from_s: number(t.from_s), to_s: number(t.to_s), held_s: number(t.held_s), largest_force_n: number(t.largest_force_n) })),
    touches_left_out: number(json.touches_left_out), touches_not_persons: number(json.touches_not_persons),
    grips: { ...counted(grips), mean_n: number(grips.mean_n), variation: number(grips.variation) },
    has_grip_force: json.has_grip_force === true, compared: asJson(json.compared).answers === undefined ? undefined : readCompared(asJson(json.compared)),
    limits: Array.isArray(json.limits) ? json.limits.map((axis) => (Array.isArray(axis) ? axis.map((change): Change => [number(numbers(change)[0]), number(numbers(change)[1])]) : [])) : [],
    limits_between_s: number(json.limits_between_s),
    largest_force_n: number(json.largest_force_n),
    strongest: { force_n: number(strongest.force_n), time_s: number(strongest.time_s), by: one(strongest.by, Mover.Motion) },
  };
}

const percentiles = (json: Json): Percentiles => ({ p50_s: number(json.p50_s), p99_s: number(json.p99_s), p999_s: number(json.p999_s), max_s: number(json.max_s) });

function readEngineering(json: Json): Engineering {
  const [times, settings] = [asJson(json.times), asJson(json.settings)];
  return {
    records: number(json.records), missed_deadlines: number(json.missed_deadlines), stopping_faults: number(json.stopping_faults),
    faults: objects(json.faults).map((f) => ({ name: text(f.name), ticks: number(f.ticks), stops: f.stops === true, axis: text(f.axis) })),
    largest_effort: numbers(json.largest_effort), work_j: number(json.work_j), contacts_max: number(json.contacts_max), coupling_error_rad: number(json.coupling_error_rad),
    damped_share: number(json.damped_share),
    times: {
      is_cpu: times.is_cpu === true, tick: percentiles(asJson(times.tick)), tick_cpu: percentiles(asJson(times.tick_cpu)), step_s: number(times.step_s),
      stages: objects(times.stages).map((stage) => ({ ...percentiles(stage), name: text(stage.name) })), counts: numbers(times.counts),
    },
    settings: {
      scene: text(settings.scene), rendering: text(settings.rendering), engine: text(settings.engine), simulated_clock: settings.simulated_clock === true,
      paper: settings.paper === true, uncertified: settings.uncertified === true, passport: text(settings.passport), seed: text(settings.seed),
    },
  };
}
