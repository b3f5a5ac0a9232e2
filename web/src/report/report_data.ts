// What the program wrote into the page: src/replay/recording_report.cpp. Everything here is read once and never trusted.
import { unpackBytes, type Json } from '../embedded/page_data';
import type { SceneT } from '../protocol';
import { readAbout, readResults, type About, type Result } from '../replay/about';
import { BodiesHistory } from '../replay/bodies_history';
import { readScene, splitStates } from '../replay/messages';
import { Problem } from '../replay/problem';
import { readPiece, type SeriesPiece } from '../replay/series_piece';

const VERSION = 1;

export interface HeldBody { readonly name: string; readonly touches: number; readonly first_s: number; readonly longest_s: number; readonly held_s: number; readonly largest_force_n: number; readonly travelled_m: number }
export interface Touch { readonly body: string; readonly from_s: number; readonly to_s: number; readonly held_s: number; readonly largest_force_n: number }
/** Who moves the hand, and how much of it a page does for the person: the numbers of src/loop/core/tick_record.hpp. */
export enum Mover { Nobody, Person, VirtualPatient, Motion }
export enum GivenHelp { Unsaid, Full, Some, None }
/** Whose something is (the rule: src/replay/therapy_facts.hpp). `by` moved longest; `share` is the person's. */
export interface Whose { readonly by: Mover; readonly share: number; readonly help: GivenHelp; readonly persons: boolean }
/** A part of an exercise that was finished, as its own, a band of force or a level. */
export interface Part extends Whose {
  /** That finished it. */
  readonly event: string; readonly index: number; readonly value: number; readonly from_s: number; readonly to_s: number; readonly stars: number;
  /** Of a part that has steps. */
  readonly steps: readonly (readonly [index: number, amount_l: number])[];
}
/** Over all parts that one event finishes: all but `shared` and `others` are over the person's. */
export interface PartSums { readonly count: number; readonly shared: number; readonly others: number; readonly value: number; readonly stars: number; readonly helps: readonly number[] }
export interface Counted { readonly count: number; readonly shared: number; readonly others: number }
/** Time by who moved the hand [periods], and in which intervals. */
export interface Moved {
  readonly by: readonly number[]; readonly helped: readonly number[]; readonly share: number;
  readonly runs: readonly (readonly [from_s: number, to_s: number, by: Mover])[]; readonly runs_left_out: number;
}
/** A value from a time on, until the next one. */
export type Change = readonly [time_s: number, value: number];

/** What is the person's, but where it says otherwise. */
export interface Therapy {
  readonly moved: Moved;
  readonly parts: readonly Part[]; readonly parts_left_out: number; readonly sums: Readonly<Record<string, PartSums>>;
  readonly reaches: Counted & { readonly sum_s: number };
  readonly results: readonly Result[];
  readonly bodies: readonly HeldBody[]; readonly bodies_in_scene: number;
  /** Anybody's. */
  readonly touches: readonly Touch[]; readonly touches_left_out: number; readonly touches_not_persons: number;
  readonly grips: Counted & { readonly mean_n: number; readonly variation: number }; readonly has_grip_force: boolean;
  /** Of each axis, in its own unit. Changes closer than this are one. */
  readonly limits: readonly (readonly Change[])[]; readonly limits_between_s: number;
  readonly largest_force_n: number;
  /** The person's; where there was none, of anybody. Its state is among those of the page. */
  readonly strongest: { readonly force_n: number; readonly time_s: number; readonly by: Mover };
}

export interface Percentiles { readonly p50_s: number; readonly p99_s: number; readonly p999_s: number; readonly max_s: number }
export interface Fault { readonly name: string; readonly ticks: number; readonly stops: boolean; readonly axis: string }

export interface Engineering {
  readonly records: number; readonly missed_deadlines: number; readonly stopping_faults: number; readonly faults: readonly Fault[];
  readonly largest_effort: readonly number[]; readonly contacts_max: number; readonly coupling_error_rad: number; readonly damped_share: number;
  readonly times: { readonly is_cpu: boolean; readonly tick: Percentiles; readonly tick_cpu: Percentiles; readonly stages: readonly (Percentiles & { readonly name: string })[]; readonly step_s: number; readonly counts: readonly number[] };
  readonly settings: { readonly scene: string; readonly rendering: string; readonly engine: string; readonly simulated_clock: boolean; readonly paper: boolean; readonly uncertified: boolean; readonly passport: string; readonly seed: string };
}

export interface ReportData {
  readonly about: About;
  /** undefined: the scene cannot be built from the file, and there are no states. */
  readonly scene: SceneT | undefined;
  readonly rows: readonly number[];
  readonly states: readonly Uint8Array[];
  /** Of a game, at the rows that have states. */
  readonly bodies: BodiesHistory;
  readonly series: SeriesPiece;
  readonly therapy: Therapy;
  readonly engineering: Engineering;
  /** The session before, with the figures alone; undefined where none was given. */
  readonly before: ReportData | undefined;
}

const asJson = (value: unknown): Json => (typeof value === 'object' && value !== null && !Array.isArray(value) ? (value as Json) : {});
const objects = (value: unknown): Json[] => (Array.isArray(value) ? value.map(asJson) : []);
const numbers = (value: unknown): number[] => (Array.isArray(value) ? value.map(Number) : []);
const number = (value: unknown): number => (typeof value === 'number' && Number.isFinite(value) ? value : 0);
const text = (value: unknown): string => (typeof value === 'string' ? value.slice(0, 2000) : '');

/** Reads the data of a page; a Problem where nothing can be shown of it. */
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
const counted = (said: Json): Counted => ({ count: number(said.count), shared: number(said.shared), others: number(said.others) });
const pairs = (value: unknown): number[][] => (Array.isArray(value) ? value.map(numbers) : []);

function readPart(said: Json): Part {
  return {
    event: text(said.event), index: number(said.index), value: number(said.value), from_s: number(said.from_s), to_s: number(said.to_s), stars: number(said.stars),
    steps: pairs(said.steps).map(([index, amount_l]) => [number(index), number(amount_l)]),
    by: one(said.by, Mover.Motion), share: number(said.share), help: one(said.help, GivenHelp.None), persons: said.persons === true,
  };
}

function readMoved(said: Json): Moved {
  return {
    by: numbers(said.by).map(number), helped: numbers(said.helped).map(number), share: number(said.share),
    runs: pairs(said.runs).map(([from_s, to_s, by]) => [number(from_s), number(to_s), one(by, Mover.Motion)]), runs_left_out: number(said.runs_left_out),
  };
}

function readTherapy(said: Json): Therapy {
  const [grips, reaches, strongest] = [asJson(said.grips), asJson(said.reaches), asJson(said.strongest)];
  const sums = Object.entries(asJson(said.sums)).map(([event, value]): [string, PartSums] => {
    const of = asJson(value);
    return [event, { ...counted(of), value: number(of.value), stars: number(of.stars), helps: numbers(of.helps).map(number) }];
  });
  return {
    moved: readMoved(asJson(said.moved)), parts: objects(said.parts).map(readPart), parts_left_out: number(said.parts_left_out), sums: Object.fromEntries(sums),
    reaches: { ...counted(reaches), sum_s: number(reaches.sum_s) }, results: readResults(said.results),
    bodies: objects(said.bodies).map((b) => ({
      name: text(b.name), touches: number(b.touches), first_s: number(b.first_s), longest_s: number(b.longest_s), held_s: number(b.held_s),
      largest_force_n: number(b.largest_force_n), travelled_m: number(b.travelled_m),
    })),
    bodies_in_scene: number(said.bodies_in_scene),
    touches: objects(said.touches).map((t) => ({ body: text(t.body), from_s: number(t.from_s), to_s: number(t.to_s), held_s: number(t.held_s), largest_force_n: number(t.largest_force_n) })),
    touches_left_out: number(said.touches_left_out), touches_not_persons: number(said.touches_not_persons),
    grips: { ...counted(grips), mean_n: number(grips.mean_n), variation: number(grips.variation) },
    has_grip_force: said.has_grip_force === true,
    limits: Array.isArray(said.limits) ? said.limits.map((axis) => (Array.isArray(axis) ? axis.map((change): Change => [number(numbers(change)[0]), number(numbers(change)[1])]) : [])) : [],
    limits_between_s: number(said.limits_between_s),
    largest_force_n: number(said.largest_force_n),
    strongest: { force_n: number(strongest.force_n), time_s: number(strongest.time_s), by: one(strongest.by, Mover.Motion) },
  };
}

const percentiles = (said: Json): Percentiles => ({ p50_s: number(said.p50_s), p99_s: number(said.p99_s), p999_s: number(said.p999_s), max_s: number(said.max_s) });

function readEngineering(said: Json): Engineering {
  const [times, settings] = [asJson(said.times), asJson(said.settings)];
  return {
    records: number(said.records), missed_deadlines: number(said.missed_deadlines), stopping_faults: number(said.stopping_faults),
    faults: objects(said.faults).map((f) => ({ name: text(f.name), ticks: number(f.ticks), stops: f.stops === true, axis: text(f.axis) })),
    largest_effort: numbers(said.largest_effort), contacts_max: number(said.contacts_max), coupling_error_rad: number(said.coupling_error_rad),
    damped_share: number(said.damped_share),
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
