// Values that hold until the next change.
import type { Change } from './report_data';

/** The time of each change twice: for the value before it and after. */
export function stepTimes(limits: readonly (readonly Change[])[], end_s: number): number[] {
  const times = [...new Set(limits.flatMap((changes) => changes.map(([time_s]) => time_s)))].sort((a, b) => a - b);
  return [...times.flatMap((time_s, i) => (i === 0 ? [time_s] : [time_s, time_s])), Math.max(end_s, times.at(-1) ?? end_s)];
}

/** The value in force at a time, or just before it. */
export function valueAt(changes: readonly Change[], time_s: number, before: boolean): number {
  const found = changes.filter(([at_s]) => (before ? at_s < time_s : at_s <= time_s)).at(-1) ?? changes[0];
  return found ? found[1] : NaN;
}
