// Depth cues for people without stereo vision: three static chevrons beside the target, on the side of the hand, and marks
// of hand and target on the counter.
import { unitOf } from '../scene/camera';
import type { GraspTargets, Position } from '../exercises/exercise';
import { GRIP_FROM_PALM } from '../input/perceiver';
import type { WorldStateT } from '../protocol';
import type { Point } from './hud';

/** The chevrons are shown while the hand is farther than this beside its target [m]; nearer, they would cover the hand. */
const FROM_M = 0.05;
/** Distance of the chevrons from the target's middle [u of game.css]. */
const BESIDE_U = 66;

/** The y coordinate at which the palm holds a target; a left hand holds it on its other side. */
const gripY_m = (palm_y_m: number, right: boolean): number => palm_y_m + (right ? 1 : -1) * GRIP_FROM_PALM.y;

export interface Cue { readonly at: Point; readonly left: boolean }

/** @param palm_y_m @param target_y_m in the world (y left) @param target its grip on the screen */
export function cueTowards(palm_y_m: number, target_y_m: number, right: boolean, target: Point, unit_px: number): Cue | null {
  const aside_m = gripY_m(palm_y_m, right) - target_y_m;
  if (Math.abs(aside_m) < FROM_M) return null;
  const handIsRight = aside_m < 0;
  const beside_px = BESIDE_U * unit_px;
  return { at: { x_px: target.x_px + (handIsRight ? beside_px : -beside_px), y_px: target.y_px }, left: handIsRight };
}

/** Positions of the current target and of the palm's link; null where the program does not report one of them. */
export function targetAndPalm({ grips, wanted }: GraspTargets, state: WorldStateT, palmLink: number): { target: Position; palm: Position } | null {
  const target = state.bodies[grips[wanted(state)]?.body ?? -1]?.positionM;
  const palm = state.links[palmLink]?.positionM;
  return target && palm ? { target, palm } : null;
}

/** Marks of hand and target on the counter, which show the remaining distance. */
export function depthMarks({ target, palm }: { target: Position; palm: Position }, counter_z_m: number | undefined, right: boolean, project: (at: Position) => Point): { ring: Point; shadow: Point } | null {
  if (counter_z_m === undefined) return null;
  const on = (x: number, y: number): Point => project({ x, y, z: counter_z_m });
  // The shadow is that of the grip's middle, not of the wrist.
  return { ring: on(target.x, target.y), shadow: on(palm.x + GRIP_FROM_PALM.x, gripY_m(palm.y, right)) };
}

/** 1u of game.css. */
export function unit_px(): number {
  return unitOf(innerWidth, innerHeight);
}
