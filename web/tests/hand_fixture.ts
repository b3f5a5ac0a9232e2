// The hands of fixtures/hands.json with forward kinematics: postures for the tests of the skin.

import { readFileSync } from 'node:fs';
import type { SceneT } from '../src/protocol';
import { POSE_STRIDE, add, toWorld, type Vec } from '../src/hand/vector';

interface FixtureLink {
  name: string; parent: number; type: 'prismatic' | 'revolute' | 'fixed'; joint: number;
  axis: Vec; parent_to_link: number[];
}
export interface FixtureHand {
  name: string; right_hand: boolean;
  axes: { name: string; lower: number; upper: number }[];
  links: FixtureLink[];
  capsules: { name: string; part: number; link: number; a_m: Vec; b_m: Vec; radius_m: number }[];
  theta0: number[]; synergy: number[][];
  checks: { q: number[]; links: number[][] }[];
}

export const HANDS: FixtureHand[] =
  JSON.parse(readFileSync(new URL('./fixtures/hands.json', import.meta.url), 'utf8'));

const DEGREE = Math.PI / 180;

/** Product of two quaternions x, y, z, w. */
function times(p: number[], q: number[]): number[] {
  return [
    p[3] * q[0] + p[0] * q[3] + p[1] * q[2] - p[2] * q[1],
    p[3] * q[1] - p[0] * q[2] + p[1] * q[3] + p[2] * q[0],
    p[3] * q[2] + p[0] * q[1] - p[1] * q[0] + p[2] * q[3],
    p[3] * q[3] - p[0] * q[0] - p[1] * q[1] - p[2] * q[2],
  ];
}

/** Poses of all links at device coordinates q: θ = θ₀ + G q, then along the tree. */
export function forwardKinematics(hand: FixtureHand, q: readonly number[]): Float64Array {
  const theta = hand.theta0.map((t, j) => t + hand.synergy[j].reduce((s, g, i) => s + g * q[i], 0));
  const out = new Float64Array(hand.links.length * POSE_STRIDE);
  hand.links.forEach((link, i) => {
    const parent = link.parent < 0 ? [0, 0, 0, 0, 0, 0, 1] : [...out.slice(link.parent * POSE_STRIDE, (link.parent + 1) * POSE_STRIDE)];
    let turn = times(parent.slice(3), link.parent_to_link.slice(3));
    let at = toWorld(parent, 0, link.parent_to_link.slice(0, 3) as unknown as Vec);
    const angle = link.joint < 0 ? 0 : theta[link.joint];
    if (link.type === 'prismatic') at = add(at, toWorld([0, 0, 0, ...turn], 0, [link.axis[0] * angle, link.axis[1] * angle, link.axis[2] * angle]));
    if (link.type === 'revolute') {
      const s = Math.sin(angle / 2);
      turn = times(turn, [link.axis[0] * s, link.axis[1] * s, link.axis[2] * s, Math.cos(angle / 2)]);
    }
    out.set([...at, ...turn], i * POSE_STRIDE);
  });
  return out;
}

/** Device coordinates: base [m], fingers, circumduction, thumb [degrees]. */
export function posture(base: Vec, fingers: number, circumduction: number, thumb: number): number[] {
  return [...base, fingers * DEGREE, circumduction * DEGREE, thumb * DEGREE];
}

/** The whole range of fingers and thumb, on a grid with its corners. */
export function allPostures(): number[][] {
  const out: number[][] = [];
  for (const fingers of [0, 30, 65, 100, 131, 155, 180])
    for (const circumduction of [0, 20, 45, 70, 90])
      for (const thumb of [0, 30, 55, 80]) out.push(posture([0.02, -0.03, 0.04], fingers, circumduction, thumb));
  return out;
}

/** The part of a scene that the skin uses. */
export function fixtureScene(hand: FixtureHand): Pick<SceneT, 'capsules' | 'rightHand'> {
  const v = (p: Vec) => ({ x: p[0], y: p[1], z: p[2] });
  return {
    rightHand: hand.right_hand,
    capsules: hand.capsules.map((c) => ({ name: c.name, part: c.part, link: c.link, aM: v(c.a_m), bM: v(c.b_m), radiusM: c.radius_m })),
  } as unknown as Pick<SceneT, 'capsules' | 'rightHand'>;
}
