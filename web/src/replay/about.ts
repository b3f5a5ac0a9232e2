import { fixed } from '../shared/format';
import { Problem } from './problem';

export interface Result { /** Of the exercise's value; empty in older answers. */ readonly name: string; readonly label: string; readonly value: string; readonly unit: string }

/** An axis of the device, with the fields that the file states without a scene. */
export interface AxisInfo { readonly name: string; readonly unit: string; readonly effort_limit: number; readonly lever_arm_m: number }

/** The program's description of a recording, read before anything of it is shown. */
export interface RecordingInfo {
  readonly name: string;
  readonly title: string;
  /** Code of the person whose profile was open; empty: none, or an older file. */
  readonly profile: string;
  readonly created_utc: string;
  readonly program_version: string;
  readonly period_s: number;
  /** Number of complete ticks in the file. */
  readonly ticks: number;
  /** Number of ticks between the first and the last one that were not written. */
  readonly ticks_missing: number;
  readonly from_s: number;
  /** Time of the last tick plus one period. */
  readonly to_s: number;
  readonly simulated_device: boolean;
  readonly patient: string;
  readonly device: string;
  readonly hand: string;
  readonly exercise: string;
  readonly level: number;
  readonly still_written: boolean;
  /** How the session ended; empty: it runs still. */
  readonly ended_by: string;
  /** The file can be read to its end. */
  readonly whole: boolean;
  /** Time from which the file cannot be read; undefined where that is not known. */
  readonly unreadable_from_s: number | undefined;
  /** The scene can be built from the file. */
  readonly picture: boolean;
  readonly no_picture_because: string;
  readonly axes: readonly AxisInfo[];
  readonly value_names: readonly string[];
  readonly event_names: readonly string[];
  readonly result: readonly Result[];
}

type JsonFields = Readonly<Record<string, unknown>>;

/** Longer texts of a file are cut [characters]. */
const LONGEST = 2000;

const textOf = (said: JsonFields, key: string): string => (typeof said[key] === 'string' ? said[key].slice(0, LONGEST) : '');
const numberOf = (said: JsonFields, key: string): number => (typeof said[key] === 'number' ? said[key] : NaN);
const orZero = (value: number): number => (Number.isFinite(value) ? value : 0);
const namesOf = (said: JsonFields, key: string): string[] => (Array.isArray(said[key]) ? said[key].map((name) => String(name).slice(0, LONGEST)) : []);
const isText = (value: unknown): value is JsonFields => typeof value === 'object' && value !== null && !Array.isArray(value);

/** Results of the exercise; a missing value is shown as a dash. */
export function readResults(said: unknown): Result[] {
  return Array.isArray(said) ? said.filter(isText).map((line) => ({
    name: textOf(line, 'name'), label: textOf(line, 'label'), unit: textOf(line, 'unit'),
    value: Number.isFinite(numberOf(line, 'value')) ? fixed(numberOf(line, 'value'), orZero(numberOf(line, 'decimals'))) : '–',
  })) : [];
}

/** Parses the answer; throws a Problem if nothing in it can be shown. */
export function readAbout(json: unknown): RecordingInfo {
  if (!isText(json)) throw new Problem('nonsense', 'about: no object');
  const [period_s, ticks, from_s, to_s] = ['period_s', 'ticks', 'from_s', 'to_s'].map((key) => numberOf(json, key));
  if (!(period_s > 0) || !Number.isInteger(ticks) || ticks < 0 || !Number.isFinite(from_s) || !(to_s >= from_s)) {
    throw new Problem('nonsense', `about: period ${period_s} s, ${ticks} ticks, ${from_s} s to ${to_s} s`);
  }
  const unreadable = numberOf(json, 'unreadable_from_s');
  return {
    name: textOf(json, 'name'), title: textOf(json, 'title'), profile: textOf(json, 'profile'), created_utc: textOf(json, 'created_utc'), program_version: textOf(json, 'program_version'),
    period_s, ticks, from_s, to_s, ticks_missing: orZero(numberOf(json, 'ticks_missing')),
    simulated_device: json.simulated_device === true, patient: textOf(json, 'patient'), device: textOf(json, 'device'),
    hand: textOf(json, 'hand'), exercise: textOf(json, 'exercise'), level: orZero(numberOf(json, 'level')),
    still_written: json.still_written === true, ended_by: textOf(json, 'ended_by'), whole: json.whole !== false,
    unreadable_from_s: Number.isFinite(unreadable) ? unreadable : undefined,
    picture: json.picture !== false, no_picture_because: textOf(json, 'no_picture_because'),
    axes: Array.isArray(json.axes) ? json.axes.filter(isText).map((axis) => ({
      name: textOf(axis, 'name'), unit: textOf(axis, 'unit'), effort_limit: orZero(numberOf(axis, 'effort_limit')), lever_arm_m: orZero(numberOf(axis, 'lever_arm_m')),
    })) : [],
    value_names: namesOf(json, 'value_names'), event_names: namesOf(json, 'event_names'),
    result: readResults(json.result),
  };
}
