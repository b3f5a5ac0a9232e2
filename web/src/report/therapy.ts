// What a recording says of the therapy, from what the page carries. No elements.
import { REPORTS, type Recorded } from '../exercises/info';
import type { WorldStateT } from '../protocol';
import { readState } from '../replay/messages';
import { channelKey, type ReplayEvent, type ReplayMark, type SeriesPiece } from '../replay/series_piece';
import type { Grip, ReportData } from './report_data';

/** Events of the exercises between which a hand reaches for something. */
const REACHES_FROM: readonly string[] = ['disengaged', 'step_done', 'band_held', 'resumed', 'restarted', ...REPORTS.flatMap(({ freeAfter }) => freeAfter)];
const REACHED_AT: readonly string[] = ['engaged', 'band_entered'];

/** How long each reach took, from the moment at which the hand was free to go until it held what it should [s]. */
export function reachTimes(events: readonly ReplayEvent[], names: readonly string[], begin_s: number): number[] {
  const times: number[] = [];
  let from_s: number | undefined = begin_s;
  for (const { time_s, type } of events) {
    const name = names[type] ?? '';
    if (REACHED_AT.includes(name) && from_s !== undefined) {
      times.push(time_s - from_s);
      from_s = undefined;
    } else if (REACHES_FROM.includes(name)) {
      from_s = time_s;
    }
  }
  return times;
}

export const meanOf = (values: readonly number[]): number => (values.length === 0 ? NaN : values.reduce((sum, value) => sum + value, 0) / values.length);

/** Mean grip force and its coefficient of variation, each grip as it lasted; undefined without grips. */
export function gripFigures(grips: readonly Grip[]): { mean_n: number; variation: number } | undefined {
  const counted = grips.filter(({ mean_n }) => mean_n > 0);
  const whole_s = counted.reduce((sum, { from_s, to_s }) => sum + to_s - from_s, 0);
  if (!(whole_s > 0)) return undefined;
  const weighted = (of: (grip: Grip) => number): number => counted.reduce((sum, grip) => sum + of(grip) * (grip.to_s - grip.from_s), 0) / whole_s;
  return { mean_n: weighted(({ mean_n }) => mean_n), variation: weighted(({ mean_n, deviation_n }) => deviation_n / mean_n) };
}

/** A value of the exercise at the end of the recording; undefined where it has none. */
export function lastValue(data: Pick<ReportData, 'about' | 'series'>, last: WorldStateT | undefined, name: string): number | undefined {
  const index = data.about.value_names.indexOf(name);
  if (index < 0) return undefined;
  const exact = last?.values[index];
  if (exact !== undefined) return exact;
  const high = data.series.channels.get(channelKey('value', index))?.high;
  return high && Array.from(high).filter((value) => !Number.isNaN(value)).at(-1);
}

function lastState({ states }: Pick<ReportData, 'states'>): WorldStateT | undefined {
  const message = states.at(-1);
  return message && readState(message);
}

/** What the page carries of the exercise. */
export function recordedOf(data: Pick<ReportData, 'about' | 'series' | 'states' | 'scene'>): Recorded {
  const last = lastState(data);
  return { events: data.series.events, eventNames: data.about.event_names, scene: data.scene, value: (name) => lastValue(data, last, name) };
}

/** Marks of a kind, and how often. */
export interface Happened { readonly kind: 'stop' | 'emergency_stop' | 'fault' | 'controls_lost'; readonly marks: readonly ReplayMark[] }

/** Every kind of thing that a therapist must see, also where it did not happen. */
export function whatHappened({ marks }: Pick<SeriesPiece, 'marks'>): Happened[] {
  return (['stop', 'emergency_stop', 'fault', 'controls_lost'] as const).map((kind) => ({ kind, marks: marks.filter((mark) => mark.kind === kind) }));
}
