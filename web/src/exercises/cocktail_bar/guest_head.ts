// A guest's head: a skull with facial features as bumps. Frame: y up from its middle, z forwards [m].

import { Color, Matrix4, Vector3 } from 'three';
import { smooth, type ParametricMesh } from './parametric_mesh';
import type { Look } from './guest_looks';
import type { Pose } from './serving';

/** Radii of the skull: lateral, vertical, forward [m]. */
export const SKULL = { x: 0.0475, y: 0.063, z: 0.051 } as const;

/** A bump: angle from the front [rad], height -1 .. 1, widths of both, height over the skull [m]. It is mirrored to the other side. */
type Bump = readonly [turn: number, up: number, wide: number, high: number, over_m: number];
const BUMPS: readonly Bump[] = [
  [0, -0.02, 0.10, 0.17, 0.0045], [0, -0.19, 0.13, 0.085, 0.0095], [0.15, -0.25, 0.07, 0.05, 0.0035],   // nose: bridge, tip, wings
  [0.37, 0.06, 0.17, 0.11, -0.004], [0.34, 0.27, 0.24, 0.09, 0.002],                                       // sockets, brows
  [0.55, -0.25, 0.26, 0.19, 0.0035], [0, -0.52, 0.34, 0.12, 0.0025], [0, -0.83, 0.4, 0.13, 0.0045],        // cheeks, mouth, chin
];

/** A point on the head, or at a height over it. */
export function headPoint(look: Look, turn: number, up: number, over_m: number, to: Vector3): Vector3 {
  const away = Math.abs(turn), round = Math.sqrt(Math.max(0, 1 - up * up));
  let over = over_m;
  // There are no bumps behind the ears.
  if (away < 1.4) for (const [t, u, wide, high, m] of BUMPS) over += m * Math.exp(-(((away - t) / wide) ** 2) - ((up - u) / high) ** 2);
  const jaw = up < 0 ? 1 - 0.13 * up * up : 1, skull = Math.cos(turn) < 0 ? 1.1 : 1;
  const x = Math.sin(turn) * round, z = Math.cos(turn) * round;
  return to.set(x * (SKULL.x * jaw + over), up * (SKULL.y * look.face + over), z * (SKULL.z * skull * (up < 0 ? 1 - 0.06 * up * up : 1) + over));
}

/** More segments in front than behind. */
export const turnAt = (u: number): number => { const s = 2 * Math.PI * (u - 0.5); return s - 0.55 * Math.sin(s); };
export const upAt = (v: number): number => -Math.cos(Math.PI * v);

/** A frame on the head: x lateral, y up, z outwards. */
function onHead(look: Look, turn: number, up: number, over_m: number, x: number, y: number, z: number): Matrix4 {
  const at = headPoint(look, turn, up, over_m, new Vector3()), lean = up * 0.5;
  return new Matrix4().makeRotationY(turn).multiply(new Matrix4().makeRotationX(-lean)).scale(new Vector3(x, y, z)).setPosition(at);
}

/** A line on the face: angle and height at its ends, and sag of its middle. */
function faceLine(look: Look, from: number, to: number, up: number, hang: number, over_m: number) {
  return (t: number, at: Vector3): Vector3 => headPoint(look, from + (to - from) * t, up - hang * (1 - (2 * t - 1) ** 2), over_m, at);
}

const EYE = { turn: 0.36, up: 0.045 } as const;
const MOUTH_UP = -0.5;
/** Parts that a pose does not show are hidden at this depth [m]. */
const HIDDEN_M = -0.012;
const thin = (r: number) => (t: number): number => r * Math.sqrt(Math.max(0, Math.sin(Math.PI * Math.min(1, Math.max(0, t)))));

export function addHead(skin: ParametricMesh, look: Look): void {
  const base = new Color(look.skin), fold = base.clone().multiply(new Color('#c98a72')), warm = base.clone().lerp(new Color('#d9604a'), 0.32);
  const spot = (turn: number, up: number, t: number, u: number, wide: number, high: number) => Math.exp(-(((Math.abs(turn) - t) / wide) ** 2) - ((up - u) / high) ** 2);
  skin.put((u, v, to) => headPoint(look, turnAt(u), upAt(v), 0, to), (u, v, to) => {
    const turn = turnAt(u), up = upAt(v);
    return to.copy(base)
      .lerp(warm, Math.min(1, spot(turn, up, 0.6, -0.24, 0.24, 0.16) + 0.5 * spot(turn, up, 0, -0.2, 0.16, 0.08)))
      .lerp(fold, 0.55 * Math.min(1, spot(turn, up, 0.36, 0.12, 0.2, 0.09) + spot(turn, up, 0, -0.34, 0.16, 0.04) + smooth(-0.82, -1, up)));
  }, [48, 36]);
  for (const side of [-1, 1]) {
    const ear = (x: number, y: number, z: number, out_m: number) => new Matrix4().makeRotationZ(side * -0.12).multiply(new Matrix4().makeRotationY(side * 0.45))
      .scale(new Vector3(x, y, z)).setPosition(side * (SKULL.x + out_m), -0.004, -0.006);
    skin.ball(ear(0.0055, 0.0145, 0.0095, 0.002), base, [12, 8]);
    skin.ball(ear(0.003, 0.009, 0.005, 0.0062), fold, [8, 8]);
  }
}

/** Eyes, brows, mouth. Every pose has the same parts, so that poses can be interpolated. */
export function addFace(skin: ParametricMesh, cloth: ParametricMesh, gloss: ParametricMesh, look: Look, pose: Pose): void {
  const open = pose === 'waits', laughs = pose === 'thanks';
  const ink = new Color('#2A1C14'), hair = new Color(look.hairColor).multiplyScalar(look.hair === 'bald' ? 0.8 : 0.75);
  const lid = new Color(look.skin).multiplyScalar(0.86), lips = new Color(look.lips ?? '#9a5a48').lerp(new Color(look.skin), look.lips ? 0.1 : 0.35);
  for (const side of [-1, 1]) {
    const turn = side * EYE.turn, shut = open ? 1 : 0.05, deep = open ? 0 : HIDDEN_M;
    gloss.ball(onHead(look, turn, EYE.up, -0.0012 + deep, 0.0076, 0.0084 * shut, 0.0034), new Color('#f7f1e8'), [12, 8]);
    gloss.ball(onHead(look, turn * 0.96, EYE.up, 0.0010 + deep, 0.0055, 0.0066 * shut, 0.0022), ink, [12, 8]);
    gloss.ball(onHead(look, turn * 0.96 - 0.035, EYE.up + 0.04, 0.0028 + deep, 0.0013, 0.0014, 0.0008), new Color('#ffffff'), [6, 6]);
    // The upper lid; for a shut eye the arc of the lashes.
    const lashes = faceLine(look, turn - 0.17, turn + 0.17, open ? EYE.up + 0.08 : EYE.up - 0.01, open ? -0.06 : -0.08, open ? 0.0018 : 0.0016);
    cloth.tube(lashes, thin(0.00115), ink, [6, 10]);
    skin.ball(onHead(look, turn, EYE.up + 0.02, open ? HIDDEN_M : -0.0022, 0.0086, 0.0080, 0.0035), lid, [12, 8]);
    const brow = laughs ? 0.31 : open ? 0.275 : 0.295;
    cloth.tube(faceLine(look, turn - 0.22, turn + 0.22, brow, -0.045, 0.0006), thin(0.0024), hair, [6, 10]);
  }
  const wide = laughs ? 0.36 : 0.32, hang = laughs ? 0.03 : 0.1;
  // A laughing mouth: dark, with teeth; a closed one is hidden behind the lips.
  const laugh = (over_m: number, x: number, y: number, up: number) => onHead(look, 0, up, laughs ? over_m : HIDDEN_M, x, y, 0.003);
  gloss.ball(laugh(-0.0010, 0.0135, 0.0078, MOUTH_UP - 0.07), new Color('#5a1f1c'), [16, 10]);
  gloss.ball(laugh(0.0003, 0.0115, 0.0030, MOUTH_UP + 0.0), new Color('#fff8ee'), [14, 8]);
  gloss.ball(laugh(0.0004, 0.0075, 0.0030, MOUTH_UP - 0.14), new Color('#c25f58'), [12, 8]);
  skin.tube(faceLine(look, -wide, wide, MOUTH_UP + 0.045, hang, 0.0004), thin(look.lips ? 0.0023 : 0.0017), lips, [8, 16]);
  skin.tube(faceLine(look, -wide * 0.95, wide * 0.95, MOUTH_UP + (laughs ? 0.03 : 0.02), laughs ? 0.22 : hang + 0.035, 0.0002), thin(look.lips ? 0.0026 : 0.0018), lips, [8, 16]);
  cloth.tube(faceLine(look, -wide, wide, MOUTH_UP + 0.03, hang + 0.012, laughs ? HIDDEN_M : 0.0016), thin(0.0009), new Color('#5b2f26'), [6, 14]);
}

/** Glasses: two rings, a bridge, and the temples to the ears. */
export function addGlasses(gloss: ParametricMesh, look: Look): void {
  const frame = new Color('#33251d'), eye = new Vector3();
  for (const side of [-1, 1]) {
    headPoint(look, side * EYE.turn, EYE.up, 0.0065, eye);
    const middle = eye.clone(), lean = side * EYE.turn * 0.5;
    gloss.tube((t, to) => {
      const turn = 2 * Math.PI * t, x = 0.0145 * Math.cos(turn);
      return to.set(middle.x + x * Math.cos(lean), middle.y + 0.0125 * Math.sin(turn), middle.z - x * Math.sin(lean));
    }, () => 0.0011, frame, [6, 24]);
    const hinge = new Vector3(middle.x + side * 0.014, middle.y + 0.003, middle.z - 0.006);
    gloss.tube((t, to) => to.copy(hinge).lerp(new Vector3(side * (SKULL.x + 0.003), 0.004, -0.006), t), () => 0.0010, frame, [6, 6]);
  }
  const z = eye.z + 0.003;
  gloss.tube((t, to) => to.set(0.008 * (2 * t - 1), eye.y + 0.002 + 0.003 * Math.sin(Math.PI * t), z), () => 0.0011, frame, [6, 8]);
}

export function addMoustache(cloth: ParametricMesh, look: Look): void {
  const color = new Color(look.hairColor);
  for (const side of [-1, 1])
    cloth.tube((t, to) => headPoint(look, side * (0.02 + 0.42 * t), -0.37 - 0.16 * t * t, 0.001, to), (t, turn) => (0.0052 + 0.0004 * Math.sin(5 * turn)) * Math.sqrt(Math.max(0, 1 - t)) * smooth(-0.08, 0.1, t), color, [12, 16]);
}
