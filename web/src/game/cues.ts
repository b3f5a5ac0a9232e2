// Three still chevrons beside the target, on the side of the hand.
import type { Point } from './hud';

/** Shown while the hand is this far beside its target [m]: nearer, they would lie on the hand. */
const FROM_M = 0.05;
/** From the middle of the bottle [u of game.css]. */
const BESIDE_U = 66;
/** A held bottle is this far beside the palm's link, towards +y [m]. */
const GRIP_ASIDE_M = 0.041;

export interface Cue { readonly at: Point; readonly left: boolean }

/** `palm_y_m`, `bottle_y_m` in the world (y left); `target` is the bottle's grip on the screen. */
export function cueTowards(palm_y_m: number, bottle_y_m: number, target: Point, unit_px: number): Cue | null {
  const aside_m = palm_y_m + GRIP_ASIDE_M - bottle_y_m;
  if (Math.abs(aside_m) < FROM_M) return null;
  const handIsRight = aside_m < 0;
  const beside_px = BESIDE_U * unit_px;
  return { at: { x_px: target.x_px + (handIsRight ? beside_px : -beside_px), y_px: target.y_px }, left: handIsRight };
}
