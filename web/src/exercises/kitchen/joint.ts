// The pose of a body for another coordinate of its joint. World frame.
import { Quaternion, Vector3 } from 'three';
import type { PoseT } from '../../protocol';
import type { Position } from '../exercise';
import type { Joint } from './task';

export interface Placement { readonly at: Vector3; readonly turn: Quaternion }

/** The pose in a state; undefined where the program does not report it. */
export function placedOf(pose: PoseT | undefined): Placement | undefined {
  const p = pose?.positionM, q = pose?.orientationXyzw;
  return p && q ? { at: new Vector3(p.x, p.y, p.z), turn: new Quaternion(q.x, q.y, q.z, q.w) } : undefined;
}

/** A point of the body in the world. */
export const pointOf = ({ at, turn }: Placement, { x, y, z }: Position): Vector3 => new Vector3(x, y, z).applyQuaternion(turn).add(at);

/** Distance of a point of the body from the hinge's axis [m]; 1 for a slider, so that it is the point's path per unit of q. */
export function armOf(now: Placement, { type, axis, point_m }: Joint, point: Position): number {
  if (type === 'slide') return 1;
  return pointOf(now, point).sub(new Vector3(...point_m)).cross(new Vector3(...axis).normalize()).length();
}

/** The body's pose after its joint moved by `dq` [m or rad]. */
export function moved({ at, turn }: Placement, { type, axis, point_m }: Joint, dq: number): Placement {
  const along = new Vector3(...axis).normalize();
  if (type === 'slide') return { at: at.clone().addScaledVector(along, dq), turn: turn.clone() };
  const about = new Quaternion().setFromAxisAngle(along, dq), point = new Vector3(...point_m);
  return { at: at.clone().sub(point).applyQuaternion(about).add(point), turn: about.multiply(turn) };
}
