// The region that must be visible where no exercise draws the scene: the hand, and everything that it can grasp.

import { Vector3 } from 'three';
import type { SceneT, ShapeT, WorldStateT } from '../protocol';
import { toThree, type Triple } from './frames';

/** Margin around the middle of every link of the hand [m]: its skin, and some movement. */
const HAND_M = 0.05;
/** Larger objects are tables and walls, which need not be visible as a whole [m]. */
const GRASPABLE_M = 0.3;

/** Upper bound of the distance between a shape's points and its body's middle [m]. */
function reachOf(shape: ShapeT): number {
  const h = shape.halfExtentsM ?? { x: 0, y: 0, z: 0 }, at = shape.inBody?.positionM ?? { x: 0, y: 0, z: 0 };
  const points = shape.pointsM.map((p) => Math.hypot(p.x, p.y, p.z));
  return Math.hypot(at.x, at.y, at.z) + Math.max(Math.hypot(h.x, h.y, h.z), shape.radiusM + shape.lengthM / 2, ...points);
}

/** Corners of the cube around a point, in three.js's frame. */
function about(p: Triple, half_m: number): Vector3[] {
  const ends = [-half_m, half_m];
  return ends.flatMap((x) => ends.flatMap((y) => ends.map((z) => toThree({ x: p.x + x, y: p.y + y, z: p.z + z }))));
}

/** Corners of the region at a state, in three.js's frame [m]; none before the first state. */
export function outlineOfScene(scene: Pick<SceneT, 'bodies' | 'capsules'>, state: Pick<WorldStateT, 'bodies' | 'links'> | undefined): Vector3[] {
  if (!state) return [];
  const hand = [...new Set(scene.capsules.map((capsule) => capsule.link))].flatMap((link) => {
    const at = state.links[link]?.positionM;
    return at ? about(at, HAND_M) : [];
  });
  const things = scene.bodies.flatMap((body, i) => {
    const at = state.bodies[i]?.positionM, reach = Math.max(0, ...body.shapes.map(reachOf));
    return at && reach < GRASPABLE_M ? about(at, reach / Math.sqrt(3)) : [];
  });
  return [...hand, ...things];
}
