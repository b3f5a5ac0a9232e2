// Where a body on a joint is when its coordinate is another one. World frame.
import { Quaternion, Vector3 } from 'three';
import type { PoseT } from '../../protocol';
import type { Position } from '../exercise';
import type { Joint } from './task';

export interface Placed { readonly at: Vector3; readonly turn: Quaternion }

/** The pose of a state; undefined where the program does not report it. */
export function placedOf(pose: PoseT | undefined): Placed | undefined {
  const p = pose?.positionM, q = pose?.orientationXyzw;
  return p && q ? { at: new Vector3(p.x, p.y, p.z), turn: new Quaternion(q.x, q.y, q.z, q.w) } : undefined;
}

/** A point of the body in the world. */
export const pointOf = ({ at, turn }: Placed, { x, y, z }: Position): Vector3 => new Vector3(x, y, z).applyQuaternion(turn).add(at);

/** How far a point of the body is from the hinge's axis [m]; 1 where it slides, so that it is the way of the point for a unit of q. */
export function armOf(now: Placed, { type, axis, point_m }: Joint, point: Position): number {
  if (type === 'slide') return 1;
  return pointOf(now, point).sub(new Vector3(...point_m)).cross(new Vector3(...axis).normalize()).length();
}

/** The body after its joint went on by `dq` [m or rad]. */
export function moved({ at, turn }: Placed, { type, axis, point_m }: Joint, dq: number): Placed {
  const along = new Vector3(...axis).normalize();
  if (type === 'slide') return { at: at.clone().addScaledVector(along, dq), turn: turn.clone() };
  const about = new Quaternion().setFromAxisAngle(along, dq), point = new Vector3(...point_m);
  return { at: at.clone().sub(point).applyQuaternion(about).add(point), turn: about.multiply(turn) };
}
