// The region that must be visible where no exercise draws the scene: the hand, and everything that it can grasp.

import { Quaternion, Vector3 } from 'three';
import type { PoseT, SceneT, ShapeT, WorldStateT } from '../protocol';
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

/** Corners of the hand with all joints at 0, in three.js's frame [m]: the camera must not depend on where a page found the hand. */
export function outlineOfHand({ links, capsules }: Pick<SceneT, 'links' | 'capsules'>): Vector3[] {
  const poses: { at: Vector3; turn: Quaternion }[] = [];
  for (const { parent, atZero } of links ?? []) {
    const { at, turn } = poses[parent] ?? { at: new Vector3(), turn: new Quaternion() };
    const { positionM: p, orientationXyzw: q } = atZero as PoseT;
    poses.push({
      at: new Vector3(p!.x, p!.y, p!.z).applyQuaternion(turn).add(at),
      turn: turn.clone().multiply(new Quaternion(q!.x, q!.y, q!.z, q!.w)),
    });
  }
  return [...new Set(capsules.map(({ link }) => link))].flatMap((link) => (poses[link] ? about(poses[link].at, HAND_M) : []));
}

/** Corners of the region at a state, in three.js's frame [m]; none before the first state. */
export function outlineOfScene(scene: Pick<SceneT, 'bodies' | 'capsules' | 'links'>, state: Pick<WorldStateT, 'bodies'> | undefined): Vector3[] {
  if (!state) return [];
  const things = scene.bodies.flatMap((body, i) => {
    const at = state.bodies[i]?.positionM, reach = Math.max(0, ...body.shapes.map(reachOf));
    return at && reach < GRASPABLE_M ? about(at, reach / Math.sqrt(3)) : [];
  });
  return [...outlineOfHand(scene), ...things];
}
