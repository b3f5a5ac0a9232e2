import { clamp } from './posture';
import type { Triple } from './wish';

/**
 * Help for people with low vision or weak control: guides the hand to a target and away from it
 * without hitting the row. Stretched fingers enter beside the target, the palm moves to it
 * there, and the hand leaves on the same path.
 */
export interface Guide {
  /** Position to which an axis is moved gently [m]; undefined: only the person decides. */
  x?: number;
  y?: number;
  z?: number;
  /** Inside the row: allowed range of the hand's lateral position, from the lane to the grip [m]. */
  channel?: readonly [number, number];
  /** Allowed share of the requested speed along x, 0 .. 1. */
  pace: number;
  /** 1: stretched fingers, 0: half bent. */
  stretch: number;
  /** false: the palm is not at the target yet, so closing waits. */
  mayClose: boolean;
}

/** Requested direction along x and y, by sign; 0: none. */
export interface RequestedDirection {
  x: number;
  y: number;
}

/** Present positions of hand and aim [m, device coordinates], and the target. */
export interface ReachInput {
  aim: Triple;
  hand: Triple;
  /** x of a hand that is drawn back. */
  back_m: number;
  grip: Triple;
  /** +1: a right hand, whose palm faces to the left, to +y. */
  beside: number;
  /** The target is a handle in front of a door or drawer. */
  onJoint?: boolean;
  /** Another target is above or below, where the hand may be. */
  stacked?: boolean;
}

/** Lateral distance of the way in and out from the palm's contact position [m]. */
const BESIDE_M = 0.024;
/** The same in front of a door or drawer, where stretched fingers have no room: they are bent, and pass the handle sideways [m]. */
const HOOKED_BESIDE_M = 0.09;
/** A depth above this share counts as inside the row. */
export const INSIDE = 0.2;
/** A target farther sideways than this is ignored [m]. */
const REACH_M = 0.2;
/** Tolerance of the palm's position at the target [m]. */
const AT_X_M = 0.01;
const AT_Y_M = 0.006;
/** Targets whose distances sideways differ by less are in one lane [m]. */
const LANE_M = 0.005;
/** A hand that comes from a target above or below is at the height of the next one within this distance [m]. */
const AT_Z_M = 0.012;
/** A palm at a target may be this far past its grip [m] and still belong to that target. */
const PAST_M = 0.012;

/** Lateral position of the way in and out beside a target [m, along y]. */
export function laneOf(grip: Triple, beside: number, onJoint = false): number {
  return grip.y - beside * (onJoint ? HOOKED_BESIDE_M : BESIDE_M);
}

/** Index of the target with the least distance sideways, of those in one lane the nearest in height; undefined: all are farther than `most_m`. */
export function nearestOf(grips: readonly (Triple | undefined)[], z: number, aside: (grip: Triple) => number, most_m: number): number | undefined {
  const off_m = grips.map((grip) => (grip ? aside(grip) : Infinity)), least_m = Math.min(...off_m);
  if (!(least_m <= most_m)) return undefined;
  const inLane = off_m.flatMap((off, i) => (off <= least_m + LANE_M ? [i] : []));
  return inLane.reduce((best, i) => (Math.abs(grips[i]!.z - z) < Math.abs(grips[best]!.z - z) ? i : best));
}

/** Index of the target that the palm of a hand faces; the nearest one if it faces past all. */
export function ownGrip(grips: readonly Triple[], hand: Triple, beside: number): number | undefined {
  return nearestOf(grips, hand.z, (grip) => {
    const before_m = beside * (grip.y - hand.y);
    // In front of the row, a position half a pitch past a grip belongs to the next one.
    return before_m >= -PAST_M ? before_m : -before_m + PAST_M;
  }, REACH_M);
}

/** Index of the target that the hand is in front of. */
export function nearestGrip(grips: readonly Triple[], hand: Triple): number | undefined {
  return nearestOf(grips, hand.z, (grip) => Math.abs(grip.y - hand.y), REACH_M);
}

/** Whether another target is above or below this one. The hand goes from one to the other beside them, and need not leave the row. */
export function isStacked(grips: readonly Triple[], at: number): boolean {
  const { x, y } = grips[at]!;
  return grips.some((other, i) => i !== at && Math.abs(other.y - y) <= LANE_M && Math.abs(other.x - x) <= LANE_M);
}

/** Depth of the hand: 0 drawn back, 1 at the grip. */
export function depthOf(x: number, back_m: number, grip: Triple): number {
  return clamp((x - back_m) / Math.max(grip.x - back_m, 1e-3), 0, 1);
}

export function guide({ aim, hand, back_m, grip, beside, onJoint, stacked }: ReachInput, asked: RequestedDirection, closing: boolean): Guide {
  const depth = depthOf(aim.x, back_m, grip);
  const inside = Math.max(depth, depthOf(hand.x, back_m, grip)) > INSIDE;
  const stretch = clamp(depth / INSIDE, 0, 1);
  const lane_y = laneOf(grip, beside, onJoint);
  const there = Math.abs(aim.x - grip.x) <= AT_X_M;
  const touching = there && Math.abs(aim.y - grip.y) <= AT_Y_M;
  const channel = inside ? [Math.min(lane_y, grip.y), Math.max(lane_y, grip.y)] as const : undefined;
  const free: Guide = { pace: 1, stretch, mayClose: touching || depth < INSIDE, channel };
  const off_z = Math.max(Math.abs(aim.z - grip.z), Math.abs(hand.z - grip.z));
  if (stacked && inside && off_z > AT_Z_M) return { ...free, y: lane_y, z: grip.z, pace: 0, mayClose: false };
  // A closed hand stays at its target; a person who draws back meanwhile feels a resistance.
  // A fist moves no deeper, because it would jam between two targets.
  if (closing) return { ...free, x: there ? grip.x : undefined, y: there ? grip.y : undefined, z: grip.z, pace: asked.x > 0 && !there ? 0 : 1 };
  if (asked.y !== 0) return free;
  // Distance of the hand from the lane: it waits at 20 mm, and moves on at 5 mm.
  const gap_m = Math.max(Math.abs(aim.y - lane_y), Math.abs(hand.y - lane_y));
  const ready = clamp((0.02 - gap_m) / 0.015, 0, 1);
  if (asked.x > 0 && !there) return { ...free, y: lane_y, z: grip.z, pace: depth < INSIDE ? Math.max(ready, 0.05) : 1 };
  if (asked.x < 0 && inside) return { ...free, y: lane_y, pace: ready };
  if (there) return { ...free, x: grip.x, y: grip.y, z: grip.z, pace: 0 };
  return free;
}
