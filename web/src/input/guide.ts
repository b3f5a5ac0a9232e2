import { clamp } from './posture';
import type { Triple } from './wish';

/**
 * Help for people with low vision or weak control: how the hand comes to a target and away from
 * it without knocking at the row. Stretched fingers go in beside the target, the palm comes up to
 * it there, and the hand leaves by the same way.
 */
export interface Guide {
  /** Where an axis is to be eased to [m]; undefined: the person decides alone. */
  x?: number;
  y?: number;
  z?: number;
  /** Inside the row: between what the hand may be sideways, from the lane to the grip [m]. */
  channel?: readonly [number, number];
  /** How much of the asked speed along x is allowed now, 0 .. 1. */
  pace: number;
  /** Stretched fingers 1, half bent 0. */
  stretch: number;
  /** false: the palm is not at the target yet, closing waits. */
  mayClose: boolean;
}

/** What is asked along x and y: the sign of where the person wants to go, 0: nowhere. */
export interface Asked {
  x: number;
  y: number;
}

/** Where the hand is and is aimed [m, device coordinates], and at which target. */
export interface Reaching {
  aim: Triple;
  hand: Triple;
  /** x of the hand drawn back. */
  back_m: number;
  grip: Triple;
  /** +1: a right hand's palm looks to the left, to +y. */
  beside: number;
  /** The target is a handle before a front. */
  onJoint?: boolean;
}

/** Sideways from where the palm touches, on the way in and out [m]. */
const BESIDE_M = 0.024;
/** The same before a front, where stretched fingers have no room: they are hooked, and pass the handle sideways [m]. */
const HOOKED_BESIDE_M = 0.09;
/** Reaching this far of the way in counts as being inside the row. */
export const INSIDE = 0.2;
/** A target farther sideways than this is none of the hand's business [m]. */
const REACH_M = 0.2;
/** The palm is at the target [m]. */
const AT_X_M = 0.01;
const AT_Y_M = 0.006;
/** A palm against a target may be this far past its grip [m]: the hand is still at that one. */
const PAST_M = 0.012;

/** Where a hand goes in and out beside a target [m, along y]. */
export function laneOf(grip: Triple, beside: number, onJoint = false): number {
  return grip.y - beside * (onJoint ? HOOKED_BESIDE_M : BESIDE_M);
}

/** The target that the palm of a hand at `y` looks at, an index; the nearest where it looks past all. */
export function ownGrip(grips: readonly Triple[], y: number, beside: number): number | undefined {
  let best: number | undefined;
  let least_m = Infinity;
  grips.forEach((grip, i) => {
    const before_m = beside * (grip.y - y);
    // In front of the row there is no before and behind: half a pitch past a grip belongs to the next one.
    const far_m = before_m >= -PAST_M ? before_m : -before_m + PAST_M;
    if (far_m < least_m) [best, least_m] = [i, far_m];
  });
  return least_m <= REACH_M ? best : undefined;
}

/** The target that the hand is in front of, an index. */
export function nearestGrip(grips: readonly Triple[], y: number): number | undefined {
  let best: number | undefined;
  grips.forEach((grip, i) => {
    if (best === undefined || Math.abs(grip.y - y) < Math.abs(grips[best]!.y - y)) best = i;
  });
  return best !== undefined && Math.abs(grips[best]!.y - y) <= REACH_M ? best : undefined;
}

/** How far in the hand is: 0 drawn back, 1 at the grip. */
export function depthOf(x: number, back_m: number, grip: Triple): number {
  return clamp((x - back_m) / Math.max(grip.x - back_m, 1e-3), 0, 1);
}

export function guide({ aim, hand, back_m, grip, beside, onJoint }: Reaching, asked: Asked, closing: boolean): Guide {
  const depth = depthOf(aim.x, back_m, grip);
  const inside = Math.max(depth, depthOf(hand.x, back_m, grip)) > INSIDE;
  const stretch = clamp(depth / INSIDE, 0, 1);
  const lane_y = laneOf(grip, beside, onJoint);
  const there = Math.abs(aim.x - grip.x) <= AT_X_M;
  const touching = there && Math.abs(aim.y - grip.y) <= AT_Y_M;
  const channel = inside ? [Math.min(lane_y, grip.y), Math.max(lane_y, grip.y)] as const : undefined;
  const free: Guide = { pace: 1, stretch, mayClose: touching || depth < INSIDE, channel };
  // A closed hand stays at its target; a person who draws back meanwhile feels it.
  // A fist goes no farther in, where it would jam between two targets.
  if (closing) return { ...free, x: there ? grip.x : undefined, y: there ? grip.y : undefined, z: grip.z, pace: asked.x > 0 && !there ? 0 : 1 };
  if (asked.y !== 0) return free;
  // How far from the lane the hand still is: at 20 mm it waits, at 5 mm it goes.
  const gap_m = Math.max(Math.abs(aim.y - lane_y), Math.abs(hand.y - lane_y));
  const ready = clamp((0.02 - gap_m) / 0.015, 0, 1);
  if (asked.x > 0 && !there) return { ...free, y: lane_y, z: grip.z, pace: depth < INSIDE ? Math.max(ready, 0.05) : 1 };
  if (asked.x < 0 && inside) return { ...free, y: lane_y, pace: ready };
  if (there) return { ...free, x: grip.x, y: grip.y, z: grip.z, pace: 0 };
  return free;
}
