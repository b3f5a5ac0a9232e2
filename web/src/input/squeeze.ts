import type { Perception } from './perceiver';
import { approach, clamp } from './posture';

/** How fast a hand closes before anything is touched, presses after, and opens [1/s]. */
export interface SqueezeRates { readonly close_per_s: number; readonly press_per_s: number; readonly open_per_s: number }

/** Above this a target is felt: closing turns into pressing [N]. */
const TOUCH_N = 0.3;

/** The squeeze `dt_s` later. @param asked pressed or not, or how far @param assisted help keeps the force in its zone @param firmest as far as the hand closes */
export function nextSqueeze(now: number, asked: boolean | number, seen: Pick<Perception, 'squeeze_n' | 'squeezeLow_n' | 'squeezeHigh_n'>, rates: SqueezeRates, assisted: boolean, firmest: number, dt_s: number): number {
  const { close_per_s, press_per_s, open_per_s } = rates;
  if (typeof asked === 'number') return approach(now, clamp(asked, 0, 1), open_per_s * dt_s);
  if (!asked) return approach(now, 0, open_per_s * dt_s);
  if (seen.squeeze_n < TOUCH_N) return approach(now, 1, close_per_s * dt_s);
  const middle_n = (seen.squeezeLow_n + seen.squeezeHigh_n) / 2;
  // In the middle of the zone a person who finds it hard to stop is stopped; a firm grip softens.
  if (assisted && seen.squeeze_n > (middle_n + seen.squeezeHigh_n) / 2) return approach(now, 0, press_per_s * dt_s);
  if (assisted && middle_n > 0 && seen.squeeze_n >= middle_n) return now;
  return approach(now, firmest, press_per_s * dt_s);
}
