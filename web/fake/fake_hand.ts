// The kinematics of the shipped hand for the stand-in program: joints, links, capsules in the world.
import hand from './fake_hand.json';

export type Triple = readonly [number, number, number];
export type Quad = readonly [number, number, number, number];  // x, y, z, w
export interface RigidPose { readonly p: Triple; readonly q: Quad }
export interface WorldCapsule { readonly a: Triple; readonly b: Triple; readonly r: number; readonly part: number }

export const HAND = hand;

const triple = (v: readonly number[]): Triple => [v[0], v[1], v[2]];
const add = (a: Triple, b: Triple): Triple => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];

export function rotate(q: Quad, v: Triple): Triple {
  const [x, y, z, w] = q;
  const tx = 2 * (y * v[2] - z * v[1]), ty = 2 * (z * v[0] - x * v[2]), tz = 2 * (x * v[1] - y * v[0]);
  return [v[0] + w * tx + y * tz - z * ty, v[1] + w * ty + z * tx - x * tz, v[2] + w * tz + x * ty - y * tx];
}

function times(a: Quad, b: Quad): Quad {
  return [
    a[3] * b[0] + a[0] * b[3] + a[1] * b[2] - a[2] * b[1],
    a[3] * b[1] - a[0] * b[2] + a[1] * b[3] + a[2] * b[0],
    a[3] * b[2] + a[0] * b[1] - a[1] * b[0] + a[2] * b[3],
    a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2],
  ];
}

/** A point of a link in the world [m]. */
export const place = (pose: RigidPose, point: Triple): Triple => add(pose.p, rotate(pose.q, point));

/** Joint positions of the avatar from its coordinates: θ = G q_s. */
export function jointsOf(q: readonly number[]): number[] {
  return hand.synergy.map((row) => row.reduce((sum, ratio, axis) => sum + ratio * q[axis], 0));
}

export function linkPoses(theta: readonly number[]): RigidPose[] {
  const poses: RigidPose[] = [];
  for (const link of hand.links) {
    const parent = link.parent < 0 ? { p: [0, 0, 0] as Triple, q: [0, 0, 0, 1] as Quad } : poses[link.parent];
    let p = place(parent, triple(link.p));
    let q = times(parent.q, link.q as unknown as Quad);
    const angle = theta[link.joint];
    const axis = triple(link.axis);
    if (link.type === 'p') p = add(p, rotate(q, [axis[0] * angle, axis[1] * angle, axis[2] * angle]));
    const s = Math.sin(angle / 2);
    if (link.type === 'r') q = times(q, [axis[0] * s, axis[1] * s, axis[2] * s, Math.cos(angle / 2)]);
    poses.push({ p, q });
  }
  return poses;
}

export function capsulesOf(poses: readonly RigidPose[]): WorldCapsule[] {
  return hand.capsules.map((c) => (
    { a: place(poses[c.link], triple(c.a)), b: place(poses[c.link], triple(c.b)), r: c.r, part: c.part }));
}
