// A person's limits on the device's axes, and their own movement as measured (docs/prescription.md). No elements.
import { newestFirst, type Limit, type OneSide, type Patient } from './records';

/** An axis of the station's device, in its own unit. */
export interface LimitAxis { readonly name: string; readonly turns: boolean; readonly lower: number; readonly upper: number }
export interface Range { readonly lower: number; readonly upper: number }
/** Own movement along an axis; an end that was not measured is missing. */
export type OwnMovement = Partial<Range>;

/** The exercise that measures own movement. */
const OWN_RANGE = 'own-range';
/** The names of its results: own/finger_flexion_upper. */
export const OWN_END = /^own\/(.+)_(lower|upper)$/;
const PER_UNIT: Readonly<Record<string, number>> = { '°': Math.PI / 180, cm: 0.01 };
/** The walls at both ends of a limit need this width at least [m, rad]. */
export const LEAST_WIDTH = { along: 0.02, turns: (10 * Math.PI) / 180 } as const;

/** The newest value of each end, and when the last one was measured. */
export function ownMovement(patient: Pick<Patient, 'visits'>, side: OneSide): { readonly of: ReadonlyMap<string, OwnMovement>; readonly at_us: number } {
  const of = new Map<string, { lower?: number; upper?: number }>();
  let at_us = 0;
  for (const visit of newestFirst(patient.visits)) {
    if (visit.side !== side) continue;
    for (const { exercise, results, began_us } of [...visit.trials].sort((a, b) => b.began_us - a.began_us)) {
      if (exercise !== OWN_RANGE) continue;
      for (const { name, value, unit } of results) {
        const [, axis, end] = OWN_END.exec(name) ?? [];
        if (axis === undefined || PER_UNIT[unit] === undefined) continue;
        const ends = of.get(axis) ?? {};
        ends[end as 'lower' | 'upper'] ??= value * PER_UNIT[unit];
        of.set(axis, ends);
        at_us = Math.max(at_us, began_us);
      }
    }
  }
  return { of, at_us };
}

/** The ranges of stored limits by axis. */
export const rangesOf = (limits: readonly Limit[] | undefined): [string, Range][] =>
  (limits ?? []).flatMap(({ axis, within_m, within_rad }) => { const ends = within_m ?? within_rad; return ends ? [[axis, { lower: ends[0], upper: ends[1] }]] : []; });

export const leastWidth = ({ turns }: LimitAxis): number => (turns ? LEAST_WIDTH.turns : LEAST_WIDTH.along);

/** A limit at the ends of own movement: an end that was not measured stays the device's. undefined: nothing was measured, or it is narrower than its walls. */
export function fromOwn(axis: LimitAxis, own: OwnMovement | undefined): Range | undefined {
  if (own === undefined) return undefined;
  const lower = Math.max(axis.lower, own.lower ?? axis.lower), upper = Math.min(axis.upper, own.upper ?? axis.upper);
  return upper - lower >= leastWidth(axis) ? { lower, upper } : undefined;
}

export type LimitFault = 'outside' | 'crossed' | 'narrow';
/** What is wrong with a limit; undefined: nothing. */
export function faultOf(axis: LimitAxis, { lower, upper }: Range): LimitFault | undefined {
  if (!(lower < upper)) return 'crossed';
  // What is typed is rounded to a degree or a millimetre.
  const rounding = axis.turns ? Math.PI / 360 : 0.0005;
  if (lower < axis.lower - rounding || upper > axis.upper + rounding) return 'outside';
  return upper - lower < leastWidth(axis) - rounding ? 'narrow' : undefined;
}

/** The limits as the records keep them, within the device's range. */
export function limitsFrom(axes: readonly LimitAxis[], ranges: ReadonlyMap<string, Range>): Limit[] {
  return axes.flatMap((axis) => {
    const range = ranges.get(axis.name);
    if (!range) return [];
    // The station tells its axes in single precision.
    const rounded = (value: number): number => Math.round(value * 1e7) / 1e7;
    const ends: readonly [number, number] = [rounded(Math.max(axis.lower, range.lower)), rounded(Math.min(axis.upper, range.upper))];
    return [axis.turns ? { axis: axis.name, within_rad: ends } : { axis: axis.name, within_m: ends }];
  });
}
