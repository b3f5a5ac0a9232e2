// Vectors of three numbers and rigid poses, for computations without three.js and its objects.

export type Vec = readonly [number, number, number];

export const add = (a: Vec, b: Vec): Vec => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
export const sub = (a: Vec, b: Vec): Vec => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
export const scale = (a: Vec, s: number): Vec => [a[0] * s, a[1] * s, a[2] * s];
export const dot = (a: Vec, b: Vec): number => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const length = (a: Vec): number => Math.hypot(a[0], a[1], a[2]);
export const mix = (a: Vec, b: Vec, t: number): Vec =>
  [a[0] + (b[0] - a[0]) * t, a[1] + (b[1] - a[1]) * t, a[2] + (b[2] - a[2]) * t];
export const cross = (a: Vec, b: Vec): Vec =>
  [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];

/** Poses of many links in one array: for each, position [m], then quaternion x, y, z, w. */
export const POSE_STRIDE = 7;

/** Transforms a point from the frame of link `link` into the world. */
export function toWorld(poses: ArrayLike<number>, link: number, p: Vec): Vec {
  const o = link * POSE_STRIDE;
  const qx = poses[o + 3], qy = poses[o + 4], qz = poses[o + 5], qw = poses[o + 6];
  // v + 2 q × (q × v + w v)
  const cx = qy * p[2] - qz * p[1] + qw * p[0];
  const cy = qz * p[0] - qx * p[2] + qw * p[1];
  const cz = qx * p[1] - qy * p[0] + qw * p[2];
  return [
    p[0] + 2 * (qy * cz - qz * cy) + poses[o],
    p[1] + 2 * (qz * cx - qx * cz) + poses[o + 1],
    p[2] + 2 * (qx * cy - qy * cx) + poses[o + 2],
  ];
}

/** Transforms a point of the world into the frame of link `link`. */
export function toLink(poses: ArrayLike<number>, link: number, p: Vec): Vec {
  const o = link * POSE_STRIDE;
  const turned = [0, 0, 0, -poses[o + 3], -poses[o + 4], -poses[o + 5], poses[o + 6]];
  return toWorld(turned, 0, [p[0] - poses[o], p[1] - poses[o + 1], p[2] - poses[o + 2]]);
}
