// The model of a guest that waits, drinks and thanks. Frame: on the counter, y up, z forwards [m].

import { Color, Matrix4, Vector3, type BufferGeometry } from 'three';
import { ParametricMesh, geometryOf, shapeOf, type Lumps, type Shape } from './parametric_mesh';
import { addArm, addTrunk, type ArmPlace } from './guest_body';
import { addHair } from './guest_hair';
import { addFace, addGlasses, addHead, addMoustache } from './guest_head';
import { lookOf } from './guest_looks';
import type { Pose } from './serving';

/** The materials of a guest. */
export const STUFFS = ['skin', 'cloth', 'gloss'] as const;
export type Stuff = (typeof STUFFS)[number];
export const POSES: readonly Pose[] = ['waits', 'drinks', 'thanks'];

export interface Figure {
  readonly geometry: Readonly<Record<Stuff, BufferGeometry>>;
  readonly poses: Readonly<Record<Pose, Readonly<Record<Stuff, Shape>>>>;
}

const v = (x: number, y: number, z: number): Vector3 => new Vector3(x, y, z);

/** Resting arms, right and left in the picture. */
const REST: readonly [ArmPlace, ArmPlace] = [
  { elbow: v(0.110, 0.037, 0.034), wrist: v(0.052, 0.031, 0.082), ahead: v(-0.95, -0.08, 0.3), palm: v(0, -1, 0.1), curl: 0.3, spread: 0.05 },
  { elbow: v(-0.110, 0.037, 0.034), wrist: v(-0.045, 0.0235, 0.089), ahead: v(0.95, -0.14, 0.3), palm: v(0, -1, 0.1), curl: 0.25, spread: 0.06 },
];
const RIGHT: Readonly<Record<Pose, ArmPlace>> = {
  waits: REST[0],
  drinks: { elbow: v(0.118, 0.048, 0.055), wrist: v(0.062, 0.128, 0.088), ahead: v(-0.55, 0.62, 0.25), palm: v(-0.75, -0.3, -0.35), curl: 0.75, spread: 0.02 },
  thanks: { elbow: v(0.128, 0.050, 0.025), wrist: v(0.128, 0.128, 0.040), ahead: v(0.10, 1, 0.05), palm: v(-0.15, 0, 1), curl: 0.06, spread: 0.2 },
};
/** Head posture: backward nod and lateral tilt [rad]. */
const HEAD_TURN: Readonly<Record<Pose, readonly [number, number]>> = { waits: [0.02, 0], drinks: [-0.12, 0.02], thanks: [0.05, -0.09] };
const HEAD_AT = v(0, 0.203, 0.004), NECK_AT = v(0, 0.150, -0.006);

function headFrame(pose: Pose): Matrix4 {
  const [nod, lean] = HEAD_TURN[pose];
  return new Matrix4().makeTranslation(NECK_AT).multiply(new Matrix4().makeRotationZ(lean)).multiply(new Matrix4().makeRotationX(nod))
    .multiply(new Matrix4().makeTranslation(HEAD_AT.clone().sub(NECK_AT)));
}

/** The glass, tipped to the mouth while drinking; in other poses it is hidden where it stood on the counter. */
function addGlass(gloss: ParametricMesh, pose: Pose, drink: readonly Color[]): void {
  const held = pose === 'drinks', rim = held ? v(0.004, 0.180, 0.058) : v(0, 0.0301, 0.14), foot = held ? v(0.040, 0.165, 0.104) : v(0, 0.03, 0.14);
  const size = held ? 1 : 1e-3, axis = rim.clone().sub(foot), radius = (t: number) => size * (0.0150 + 0.0035 * t);
  const clear = new Color('#dfeeed'), paint = (_: number, t: number, to: Color) => to.copy(t < 0.12 || t > 0.72 ? clear : drink[Math.floor((t - 0.12) / 0.6001 * drink.length)] ?? clear);
  gloss.tube((t, to) => to.copy(foot).addScaledVector(axis, t), radius, paint, [24, 24]);
  const x = new Vector3(1, 0, 0).cross(axis).normalize(), y = axis.clone().cross(x).normalize();
  for (const [t, color] of [[0.02, clear], [0.94, clear.clone().multiplyScalar(0.7)]] as const)
    gloss.ball(new Matrix4().makeBasis(x.clone().multiplyScalar(radius(t)), axis.clone().multiplyScalar(0.04), y.clone().multiplyScalar(-radius(t))).setPosition(foot.clone().addScaledVector(axis, t)), color, [20, 8]);
}

type Meshes = Readonly<Record<Stuff, ParametricMesh>>;

const of = <T>(make: (stuff: Stuff) => T): Record<Stuff, T> => ({ skin: make('skin'), cloth: make('cloth'), gloss: make('gloss') });

/**
 * Makes one guest in every pose with the same triangles at other positions. It yields between parts, so that a page can continue.
 * @param drink colours of its layers, the lowest first @param fineness 1: full resolution
 */
export function* makeFigure(guest: number, drink: readonly Color[], fineness: number): Generator<undefined, Figure> {
  const look = lookOf(guest), kneaded = (): Meshes => of(() => new ParametricMesh(fineness)), body = kneaded(), head = kneaded(), still = new Matrix4();
  addTrunk(body.cloth, body.skin, look);
  yield;
  addArm(body.cloth, body.skin, look, -1, REST[1]);
  yield;
  addHead(head.skin, look);
  yield;
  addHair(head.cloth, look);
  if (look.glasses) addGlasses(head.gloss, look);
  if (look.moustache) addMoustache(head.cloth, look);
  const poses: Partial<Record<Pose, Record<Stuff, Shape>>> = {};
  let first: Record<Stuff, Lumps> | undefined;
  for (const pose of POSES) {
    yield;
    const arm = kneaded(), face = kneaded(), frame = headFrame(pose);
    addArm(arm.cloth, arm.skin, look, 1, RIGHT[pose]);
    addGlass(arm.gloss, pose, drink);
    yield;
    addFace(face.skin, face.cloth, face.gloss, look, pose);
    const lumps = of((stuff): Lumps => [[body[stuff], still], [arm[stuff], still], [head[stuff], frame], [face[stuff], frame]]);
    poses[pose] = of((stuff) => shapeOf(lumps[stuff]));
    first ??= lumps;
  }
  yield;
  return { geometry: of((stuff) => geometryOf(first![stuff])), poses: poses as Figure['poses'] };
}
