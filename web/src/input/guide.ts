import { clamp } from './posture';
import type { Triple } from './wish';

/**
 * Help for people with low vision or weak control: how the hand comes to a dispenser and away from
 * it without knocking at the row. Stretched fingers go in beside the dispenser, the palm comes up to
 * it there, and the hand leaves by the same way.
 */
export interface Guide {
  /** Where an axis is to be eased to [m]; undefined: the person decides alone. */
  x?: number;
  y?: number;
  z?: number;
  /** How much of the asked speed along x is allowed now, 0 .. 1. */
  pace: number;
  /** Stretched fingers 1, half bent 0. */
  stretch: number;
  /** false: the palm is not at the dispenser yet, closing waits. */
  mayClose: boolean;
}

/** What is asked along x and y: the sign of where the person wants to go, 0: nowhere. */
export interface Asked {
  x: number;
  y: number;
}

/** Sideways from where the palm touches, on the way in and out [m]. */
export const BESIDE_M = 0.024;
/** Reaching this far of the way in counts as being inside the row. */
const INSIDE = 0.2;
/** A dispenser farther sideways than this is none of the hand's business [m]. */
const REACH_M = 0.2;
/** The palm is at the dispenser [m]. */
const AT_X_M = 0.01;
const AT_Y_M = 0.006;

/** The dispenser that the hand is in front of or at. */
export function nearestGrip(grips: readonly Triple[], y: number): Triple | undefined {
  const nearest = grips.reduce<Triple | undefined>(
    (best, grip) => (!best || Math.abs(grip.y - y) < Math.abs(best.y - y) ? grip : best), undefined);
  return nearest && Math.abs(nearest.y - y) <= REACH_M ? nearest : undefined;
}

/** How far in the hand is: 0 drawn back, 1 at the grip. */
export function depthOf(x: number, back_m: number, grip: Triple): number {
  return clamp((x - back_m) / Math.max(grip.x - back_m, 1e-3), 0, 1);
}

/**
 * @param at the aim [m, device coordinates]
 * @param back_m x of the hand drawn back
 * @param beside +1: a right hand's palm looks to the left, to +y
 */
export function guide(
  at: Triple, back_m: number, grip: Triple, beside: number, asked: Asked, closing: boolean,
): Guide {
  const depth = depthOf(at.x, back_m, grip);
  const stretch = clamp(depth / INSIDE, 0, 1);
  const lane_y = grip.y - beside * BESIDE_M;
  const there = Math.abs(at.x - grip.x) <= AT_X_M;
  const touching = there && Math.abs(at.y - grip.y) <= AT_Y_M;
  const free = { pace: 1, stretch, mayClose: touching || depth < INSIDE };
  // A closed hand stays at its dispenser; whoever draws back meanwhile feels it.
  if (closing) return { ...free, x: there ? grip.x : undefined, y: there ? grip.y : undefined, z: grip.z };
  if (asked.y !== 0) return free;
  // How far from the lane the hand still is: at 20 mm it waits, at 5 mm it goes.
  const ready = clamp((0.02 - Math.abs(at.y - lane_y)) / 0.015, 0, 1);
  if (asked.x > 0 && !there) return { ...free, y: lane_y, z: grip.z, pace: depth < INSIDE ? Math.max(ready, 0.05) : 1 };
  if (asked.x < 0 && depth > INSIDE) return { ...free, y: lane_y, pace: ready };
  if (there) return { ...free, x: grip.x, y: grip.y, z: grip.z, pace: 0 };
  return free;
}
