// A guest from the counter to the neck: clothes with folds, arms and hands. Frame: y up from the counter, z forwards [m].

import { Color, Matrix4, Vector3 } from 'three';
import { ballAt, profile, smooth, through, type ParametricMesh, type Paint } from './parametric_mesh';
import type { Look } from './guest_looks';

/** A hand: position of its wrist, direction of the fingers, and direction of the palm. */
export interface HandPlace {
  readonly wrist: Vector3; readonly ahead: Vector3; readonly palm: Vector3;
  /** Flexion of each finger joint, and angle between adjacent fingers [rad]. */
  readonly curl: number; readonly spread: number;
}
export interface ArmPlace extends HandPlace { readonly elbow: Vector3 }

/** The trunk by height: half its breadth and half its depth [m]. */
const breadth = profile([[-0.02, 0.080], [0.03, 0.084], [0.065, 0.092], [0.086, 0.0945], [0.102, 0.088], [0.115, 0.066], [0.125, 0.044], [0.132, 0.033], [0.138, 0.0285]]);
const depth = profile([[-0.02, 0.047], [0.03, 0.051], [0.065, 0.055], [0.086, 0.053], [0.102, 0.048], [0.115, 0.042], [0.125, 0.036], [0.132, 0.031], [0.138, 0.0285]]);
const HIGH = { from: 0.0012, to: 0.138 } as const;
const SHOULDER = { x: 0.072, y: 0.088, z: -0.008 } as const;
/** Points of the neck's axis, which leans forwards. */
const NECK = [new Vector3(0, 0.11, -0.010), new Vector3(0, 0.14, -0.005), new Vector3(0, 0.165, 0)];

/** Darkens the valleys of the folds, which receive less light. */
function clothPaint(color: Color, fold: (u: number, v: number) => number): Paint {
  const dark = color.clone().multiplyScalar(0.78);
  return (u, v, to) => to.copy(color).lerp(dark, Math.min(1, Math.max(0, -fold(u, v) / 0.0016)));
}

export function addTrunk(cloth: ParametricMesh, skin: ParametricMesh, look: Look): void {
  const color = new Color(look.cloth), trim = new Color(look.trim);
  // Folds from armpit to waist, and across below the chest.
  const fold = (u: number, v: number): number => {
    const turn = 2 * Math.PI * u, y = HIGH.from + (HIGH.to - HIGH.from) * v, aside = Math.sin(turn);
    const drape = Math.sin(7 * turn * Math.sign(aside) + 130 * y) * smooth(0.35, 0.8, Math.abs(aside)) * smooth(0.10, 0.07, y);
    return 0.0019 * drape + 0.0012 * Math.sin(190 * y + 2.2 * Math.cos(turn)) * smooth(0.05, 0.02, y);
  };
  cloth.put((u, v, to) => trunk(look, 2 * Math.PI * u, HIGH.from + (HIGH.to - HIGH.from) * v, fold(u, v), to), clothPaint(color, fold), [44, 26]);
  const base = new Color(look.skin), shade = base.clone().multiply(new Color('#b97a62'));
  skin.tube(through(NECK), (t) => 0.0255 - 0.003 * Math.sin(Math.PI * t), (_, v, to) => to.copy(base).lerp(shade, 0.85 * smooth(0.3, 0.8, v)), [28, 10]);
  if (look.collar === 'crew') ring(cloth, trim, 0.0315, 0.0048, 0.134, 0);
  if (look.collar === 'scarf') {
    ring(cloth, trim, 0.034, 0.0105, 0.132, 0.0016);
    ring(cloth, trim, 0.040, 0.0085, 0.122, 0.0014);
    cloth.tube(through([new Vector3(0.022, 0.122, 0.036), new Vector3(0.026, 0.10, 0.055), new Vector3(0.028, 0.066, 0.060), new Vector3(0.027, 0.045, 0.059)]),
      (t, turn) => (0.0085 + 0.0035 * t + 0.0012 * Math.sin(4 * turn + 5 * t)) * smooth(1.02, 0.97, t), trim, [20, 18]);
  }
  if (look.collar === 'shirt') addShirtFront(cloth, look, trim);
}

function trunk(look: Look, turn: number, y: number, over_m: number, to: Vector3): Vector3 {
  // A superellipse, since a chest is squarer than an ellipse.
  const s = Math.sin(turn), c = Math.cos(turn), n = 2.35, r = (Math.abs(s) ** n + Math.abs(c) ** n) ** (-1 / n);
  const wide = breadth(y) * (1 + (look.broad - 1) * smooth(0.13, 0.10, y));
  return to.set(s * r * (wide + over_m), y, c * r * (depth(y) + over_m) - 0.010);
}

/** A ring of cloth around the neck, with folds. */
function ring(cloth: ParametricMesh, color: Color, radius: number, thick: number, y: number, fold_m: number): void {
  cloth.tube((t, to) => to.set(-radius * Math.sin(2 * Math.PI * t), y + 0.006 * Math.cos(2 * Math.PI * t), -radius * Math.cos(2 * Math.PI * t) - 0.007),
    (t, turn) => thick + fold_m * Math.sin(3 * turn + 14 * Math.PI * t), color, [12, 44]);
}

/** The two wings of a collar, and the strip with the buttons. */
function addShirtFront(cloth: ParametricMesh, look: Look, trim: Color): void {
  for (const side of [-1, 1]) {
    cloth.tube(through([new Vector3(0, 0.143, -0.034), new Vector3(side * 0.025, 0.142, -0.016), new Vector3(side * 0.0265, 0.138, 0.006), new Vector3(side * 0.006, 0.126, 0.027)]),
      () => 0.0042, trim, [10, 20]);
    wing(cloth, trim, new Vector3(side * 0.003, 0.130, 0.029), new Vector3(side * 0.032, 0.134, 0.008), new Vector3(side * 0.027, 0.103, 0.042));
  }
  const at = new Vector3();
  const strip = new Color(look.cloth).multiplyScalar(0.9);
  cloth.tube((t, to) => trunk(look, 0, 0.003 + 0.117 * t, 0.0002, to), (_, turn) => 0.0014 + 0.0055 * Math.abs(Math.cos(turn)) ** 3, strip, [16, 14]);
  for (const y of [0.04, 0.066, 0.092]) cloth.ball(ballAt(trunk(look, 0, y, 0.0022, at), 0.0026, 0.0026, 0.0012), trim, [10, 6]);
}

/** A flat leaf from the edge a-b to its tip. */
function wing(cloth: ParametricMesh, color: Color, a: Vector3, b: Vector3, tip: Vector3): void {
  const middle = a.clone().lerp(b, 0.5), half = b.clone().sub(a).multiplyScalar(0.5), down = tip.clone().sub(middle);
  const out = new Vector3().crossVectors(down, half).normalize();
  out.multiplyScalar(0.0024 * Math.sign(out.z));
  cloth.put((u, v, to) => {
    const turn = 2 * Math.PI * u * Math.sign(half.x), end = Math.sqrt(Math.max(0, 1 - Math.max(0, (v - 0.8) / 0.2) ** 2));
    return to.copy(middle).addScaledVector(down, v).addScaledVector(half, Math.cos(turn) * (1 - 0.75 * v) * end).addScaledVector(out, (Math.sin(turn) * 0.8 + Math.sin(Math.PI * v)) * (0.4 + 0.6 * end));
  }, color, [14, 12]);
}

/** A line from the shoulder over the elbow to the wrist, rounded at the bend. */
function armLine(from: Vector3, elbow: Vector3, to: Vector3): (t: number, at: Vector3) => Vector3 {
  const a = from.clone().lerp(elbow, 0.62), b = elbow.clone().lerp(to, 0.38), p = new Vector3(), q = new Vector3();
  return (t, at) => {
    if (t < 0.38) return at.copy(from).lerp(a, t / 0.38);
    if (t > 0.62) return at.copy(b).lerp(to, (t - 0.62) / 0.38);
    const s = (t - 0.38) / 0.24;
    p.copy(a).lerp(elbow, s);
    q.copy(elbow).lerp(b, s);
    return at.copy(p).lerp(q, s);
  };
}

export function addArm(cloth: ParametricMesh, skin: ParametricMesh, look: Look, side: number, arm: ArmPlace): void {
  const shoulder = new Vector3(side * SHOULDER.x * look.broad, SHOULDER.y, SHOULDER.z), line = armLine(shoulder, arm.elbow, arm.wrist);
  const color = new Color(look.cloth), trim = look.collar === 'scarf' ? color : new Color(look.trim);
  const wrinkle = (u: number, v: number): number => {
    const bend = Math.exp(-(((v - 0.5) / 0.17) ** 2)), end = Math.exp(-(((v - 0.88) / 0.09) ** 2));
    return (0.0017 * bend + 0.0011 * end) * Math.sin(62 * v + 2 * Math.sin(2 * Math.PI * u)) + 0.0006 * Math.sin(24 * v + 6 * Math.PI * u);
  };
  cloth.tube(line, (t, turn) => {
    const thick = 0.0245 - 0.0025 * smooth(0, 0.45, t) - 0.0050 * smooth(0.5, 1, t) + 0.001 * Math.exp(-(((t - 0.5) / 0.1) ** 2));
    return (thick + wrinkle(turn / (2 * Math.PI), t)) * Math.sqrt(smooth(-0.14, 0.05, t));
  }, clothPaint(color, wrinkle), [18, 28]);
  // The rolled cuff, like the player's.
  const end = arm.wrist.clone(), back = line(0.93, new Vector3());
  cloth.tube((t, to) => to.copy(back).lerp(end, 0.2 + 1.0 * t), (t) => 0.0158 + 0.0034 * Math.sqrt(Math.max(0, Math.sin(Math.PI * (0.06 + 0.9 * t)))), trim, [20, 10]);
  addHand(skin, look, side, arm);
}

function addHand(skin: ParametricMesh, look: Look, side: number, { wrist, ahead, palm, curl, spread }: HandPlace): void {
  const base = new Color(look.skin), light = base.clone().lerp(new Color('#ffe2d0'), 0.2), fold = base.clone().multiply(new Color('#d39a80'));
  const x = ahead.clone().normalize(), z = palm.clone().addScaledVector(x, -palm.dot(x)).normalize();
  // Direction to the thumb.
  const y = new Vector3().crossVectors(z, x).multiplyScalar(side);
  const at = (a: number, b: number, c: number) => wrist.clone().addScaledVector(x, a).addScaledVector(y, b).addScaledVector(z, c);
  const tint: Paint = (_, v, to) => to.copy(base).lerp(light, 0.4 * v);
  skin.tube((t, to) => to.copy(at(-0.012 + 0.02 * t, 0, 0)), (t) => 0.0112 + 0.001 * t, base, [14, 4]);
  skin.ball(new Matrix4().makeBasis(x.clone().multiplyScalar(0.0185), y.clone().multiplyScalar(0.0158), z.clone().multiplyScalar(0.0088 * Math.sign(new Vector3().crossVectors(x, y).dot(z)) )).setPosition(at(0.0155, 0, 0)), base, [22, 14]);
  [-1.5, -0.5, 0.5, 1.5].forEach((k, i) => {
    const lengths = [0.80, 0.95, 1, 0.92][i], root = [0.0245, 0.0285, 0.0295, 0.0275][i], away = spread * (k - 0.2);
    const points = [at(root - 0.008, k * 0.0072, 0.0005), at(root, k * 0.0076, 0.0003)];
    let turn = curl * 0.6;
    for (const length of [0.0125, 0.0095, 0.0085]) {
      const p = points[points.length - 1], run = Math.cos(turn);
      points.push(p.clone().addScaledVector(x, length * lengths * run * Math.cos(away)).addScaledVector(y, length * lengths * run * Math.sin(away)).addScaledVector(z, length * lengths * Math.sin(turn)));
      turn += curl;
    }
    finger(skin, points, 0.0049, 0.0041, tint, fold);
  });
  // The thumb, beside and in front of the palm.
  const out = 0.35 + spread;
  finger(skin, [at(0.004, 0.008, 0.002), at(0.013, 0.0145 + 0.003 * out, 0.0035 + 0.003 * curl), at(0.022, 0.0165 + 0.009 * out, 0.005 + 0.006 * curl), at(0.031, 0.0155 + 0.014 * out, 0.0055 + 0.010 * curl)], 0.0060, 0.0045, tint, fold);
}

/** A finger with a round end. */
function finger(skin: ParametricMesh, points: readonly Vector3[], root: number, tip: number, paint: Paint, fold: Color): void {
  const tint: Paint = (u, v, to) => (paint instanceof Color ? to.copy(paint) : to.copy(paint(u, v, to))).lerp(fold, 0.35 * smooth(0.35, 0.12, v));
  const line = through(points), along = (t: number) => Math.sin(1.57 * Math.min(1, Math.max(0, t)));   // more segments at its end
  skin.tube((t, to) => line(along(t), to), (t) => (root + (tip - root) * t) * Math.sqrt(Math.max(0, 1 - (Math.max(0, along(t) - 0.88) / 0.12) ** 2)), tint, [8, 11]);
}
