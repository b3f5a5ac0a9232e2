// Two frames: the program's (x away from the person, y left, z up) and three.js's (x right, y up,
// z towards the person). Both are right-handed.

import { Matrix4, Quaternion, Vector3, type Object3D } from 'three';

export interface Triple { readonly x: number; readonly y: number; readonly z: number }

/** Converts a point or a direction to three.js's frame: (−y, z, −x). */
export function toThree(p: Triple, into = new Vector3()): Vector3 {
  return into.set(-p.y, p.z, -p.x);
}

/** Converts a rotation: its axis like a direction; its angle is unchanged. */
export function quaternionToThree(q: Triple & { readonly w: number }, into = new Quaternion()): Quaternion {
  return into.set(-q.y, q.z, -q.x, q.w);
}

/** The same conversion as a matrix. */
export function programFrame(): Matrix4 {
  return new Matrix4().makeBasis(new Vector3(0, 0, -1), new Vector3(-1, 0, 0), new Vector3(0, 1, 0));
}

/** Turns a group for the program's objects: inside it, positions and quaternions are in the program's frame. */
export function intoProgramFrame(group: Object3D): void {
  group.matrixAutoUpdate = false;
  group.matrix.copy(programFrame());
}
