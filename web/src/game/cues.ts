// Where hand and bottle are, for who does not see depth: three still chevrons beside the target, on the side of the
// hand, and marks of both on the counter.
import { GRIP_FROM_PALM } from '../input/perception';
import type { SceneT, WorldStateT } from '../protocol';
import type { Point } from './hud';
import { figure, type Script } from './script';

/** Shown while the hand is this far beside its target [m]: nearer, they would lie on the hand. */
const FROM_M = 0.05;
/** From the middle of the bottle [u of game.css]. */
const BESIDE_U = 66;

/** Where the palm holds a bottle: on the other side in a left hand. */
const gripY_m = (palm_y_m: number, right: boolean): number => palm_y_m + (right ? 1 : -1) * GRIP_FROM_PALM.y;

export interface Cue { readonly at: Point; readonly left: boolean }

/** `palm_y_m`, `bottle_y_m` in the world (y left); `target` is the bottle's grip on the screen. */
export function cueTowards(palm_y_m: number, bottle_y_m: number, right: boolean, target: Point, unit_px: number): Cue | null {
  const aside_m = gripY_m(palm_y_m, right) - bottle_y_m;
  if (Math.abs(aside_m) < FROM_M) return null;
  const handIsRight = aside_m < 0;
  const beside_px = BESIDE_U * unit_px;
  return { at: { x_px: target.x_px + (handIsRight ? beside_px : -beside_px), y_px: target.y_px }, left: handIsRight };
}

type Place = Readonly<{ x: number; y: number; z: number }>;   // [m], the program's world

/** Of the bottle that is wanted and of the palm's link; null: the program tells one of them not. */
export function bottleAndPalm(script: Script, state: WorldStateT, scene: SceneT | null, palmLink: number): { bottle: Place; palm: Place } | null {
  const wanted = script.dispensers[figure(script, state, 'target_dispenser', -1)]?.body;
  const bottle = state.bodies[scene?.bodies.findIndex((b) => String(b.name) === wanted) ?? -1]?.positionM;
  const palm = state.links[palmLink]?.positionM;
  return bottle && palm ? { bottle, palm } : null;
}

/** Where hand and bottle stand on the counter: how far it still is. */
export function depthMarks(script: Script, { bottle, palm }: { bottle: Place; palm: Place }, right: boolean, project: (at: Place) => Point): { ring: Point; shadow: Point } | null {
  if (script.counter_z_m === undefined) return null;
  const on = (x: number, y: number): Point => project({ x, y, z: script.counter_z_m! });
  // What the palm would hold, not its wrist.
  return { ring: on(bottle.x, bottle.y), shadow: on(palm.x + GRIP_FROM_PALM.x, gripY_m(palm.y, right)) };
}

/** 1u of game.css. */
export function unit_px(): number {
  return innerWidth / innerHeight <= 1.1 ? innerWidth / 740 : Math.min(innerWidth / 1280, innerHeight / 800);
}
