// What the program wrote into the page: src/replay/recording_report.cpp. Everything here is read once and never trusted.
import { unpackBytes, type Json } from '../embedded/page_data';
import type { SceneT } from '../protocol';
import { readAbout, type About } from '../replay/about';
import { BodiesHistory } from '../replay/bodies_history';
import { readScene, splitStates } from '../replay/messages';
import { Problem } from '../replay/problem';
import { readPiece, type SeriesPiece } from '../replay/series_piece';

const VERSION = 1;

export interface HeldBody { readonly name: string; readonly touches: number; readonly first_s: number; readonly longest_s: number; readonly held_s: number; readonly largest_force_n: number; readonly travelled_m: number }
export interface Touch { readonly body: string; readonly from_s: number; readonly to_s: number; readonly held_s: number; readonly largest_force_n: number }
export interface Grip { readonly from_s: number; readonly to_s: number; readonly mean_n: number; readonly deviation_n: number; readonly largest_n: number }
/** A value from a time on, until the next one. */
export type Change = readonly [time_s: number, value: number];

export interface Therapy {
  readonly bodies: readonly HeldBody[]; readonly bodies_in_scene: number; readonly touches: readonly Touch[];
  readonly grips: readonly Grip[]; readonly has_grip_force: boolean;
  /** Of each axis, in its own unit. */
  readonly limits: readonly (readonly Change[])[];
  readonly largest_force_n: number; readonly largest_force_s: number;
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

function readTherapy(said: Json): Therapy {
  return {
    bodies: objects(said.bodies).map((b) => ({
      name: text(b.name), touches: number(b.touches), first_s: number(b.first_s), longest_s: number(b.longest_s), held_s: number(b.held_s),
      largest_force_n: number(b.largest_force_n), travelled_m: number(b.travelled_m),
    })),
    bodies_in_scene: number(said.bodies_in_scene),
    touches: objects(said.touches).map((t) => ({ body: text(t.body), from_s: number(t.from_s), to_s: number(t.to_s), held_s: number(t.held_s), largest_force_n: number(t.largest_force_n) })),
    grips: objects(said.grips).map((g) => ({ from_s: number(g.from_s), to_s: number(g.to_s), mean_n: number(g.mean_n), deviation_n: number(g.deviation_n), largest_n: number(g.largest_n) })),
    has_grip_force: said.has_grip_force === true,
    limits: Array.isArray(said.limits) ? said.limits.map((axis) => (Array.isArray(axis) ? axis.map((change): Change => [number(numbers(change)[0]), number(numbers(change)[1])]) : [])) : [],
    largest_force_n: number(said.largest_force_n), largest_force_s: number(said.largest_force_s),
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
