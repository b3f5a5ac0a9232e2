import type { Perception } from './perceiver';
import { approach, clamp } from './posture';

/** Rates of closing before the first contact, of pressing after it, and of opening [1/s]. */
export interface SqueezeRates { readonly close_per_s: number; readonly press_per_s: number; readonly open_per_s: number }

/** A force above this counts as contact: closing changes to pressing [N]. */
const TOUCH_N = 0.3;

/** The squeeze after `dt_s`. @param asked pressed or not, or the degree @param assisted help keeps the force in its range @param firmest largest squeeze */
export function nextSqueeze(now: number, asked: boolean | number, seen: Pick<Perception, 'squeeze_n' | 'squeezeLow_n' | 'squeezeHigh_n'>, rates: SqueezeRates, assisted: boolean, firmest: number, dt_s: number): number {
  const { close_per_s, press_per_s, open_per_s } = rates;
  if (typeof asked === 'number') return approach(now, clamp(asked, 0, 1), open_per_s * dt_s);
  if (!asked) return approach(now, 0, open_per_s * dt_s);
  if (seen.squeeze_n < TOUCH_N) return approach(now, 1, close_per_s * dt_s);
  const middle_n = (seen.squeezeLow_n + seen.squeezeHigh_n) / 2;
  // Help stops the squeeze in the middle of the range, for a person who finds it hard to stop; a too firm grip is eased.
  if (assisted && seen.squeeze_n > (middle_n + seen.squeezeHigh_n) / 2) return approach(now, 0, press_per_s * dt_s);
  if (assisted && middle_n > 0 && seen.squeeze_n >= middle_n) return now;
  return approach(now, firmest, press_per_s * dt_s);
}
