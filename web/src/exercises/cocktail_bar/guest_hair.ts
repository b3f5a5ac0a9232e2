// A guest's hair: a shell over the head, thick where hair grows and below the skin elsewhere, with grooves of locks.

import { Color, Vector3 } from 'three';
import { ballAt, smooth, type ParametricMesh, type Paint } from './parametric_mesh';
import { headPoint, SKULL, turnAt, upAt } from './guest_head';
import type { Hair, Look } from './guest_looks';

/** Depth of the shell below the skin where no hair grows [m]. */
const BARE_M = -0.004;

/** Height of the hairline by the angle from the front: forehead, temples, nape. */
const LINES: Readonly<Record<Hair, readonly [forehead: number, temple: number, side: number, nape: number]>> = {
  short: [0.6, 0.5, -0.12, -0.62], bun: [0.56, 0.42, 0.02, -0.5], curls: [0.56, 0.42, 0.0, -0.5],
  bald: [2, 2, -0.05, -0.55], long: [0.58, 0.36, -0.35, -0.8], bob: [0.47, 0.3, -0.4, -0.8],
};
const THICK_M: Readonly<Record<Hair, number>> = { short: 0.0085, bun: 0.006, curls: 0.019, bald: 0.005, long: 0.0085, bob: 0.0095 };

function hairline(hair: Hair, away: number): number {
  const [forehead, temple, side, nape] = LINES[hair];
  const before = forehead + (temple - forehead) * smooth(0.3, 0.85, away);
  const aside = before + (side - before) * smooth(0.85, 1.25, away);
  return aside + (nape - aside) * smooth(1.5, 2.2, away);
}

/** Rows of the hair's mesh follow the hairline, so that its edge is clean: from just below it to the crown, or to the bald part. */
function upOf(look: Look, turn: number, v: number): number {
  const away = Math.abs(turn), from = Math.asin(Math.min(0.5, edge(look.hair, turn) - 0.1)), end = look.hair === 'bald' ? 0.5 + 0.1 * Math.cos(2 * away) : Math.PI / 2;
  return Math.sin(from + (end - from) * v);
}

/** Variation of the hairline along its angle. */
function edge(hair: Hair, turn: number): number {
  const swept = hair === 'bob' ? 0.1 * Math.sin(1.6 * turn + 0.6) : hair === 'short' ? 0.05 * Math.sin(2.2 * turn) : hair === 'long' ? 0.08 * Math.cos(turn) : 0;
  return hairline(hair, Math.abs(turn)) + swept * smooth(1.2, 0.5, Math.abs(turn));
}

/** Thickness of the hair over the skull. */
function thickness(hair: Hair, turn: number, up: number): number {
  const round = Math.sqrt(Math.max(0, 1 - up * up)), away = Math.abs(turn), crown = smooth(0.15, 0.6, round);
  const grown = smooth(-0.1, hair === 'curls' ? 0.35 : 0.12, up - edge(hair, turn));
  const at = hair === 'long' ? 0 : 0.5, parted = hair === 'long' || hair === 'short' || hair === 'bob';
  const parting = parted ? 0.003 * Math.exp(-(((turn - at) / 0.12) ** 2)) * crown : 0;
  const quiff = hair === 'short' ? 0.006 * Math.exp(-(((turn + 0.15) / 0.6) ** 2)) * smooth(0.5, 0.75, up) * crown : 0;
  const bald = hair === 'bald' ? smooth(0.62, 0.3, up) * smooth(1.0, 1.3, away) : 1;
  const locks = hair === 'curls' ? 0.0042 * Math.cos(9 * turn) * Math.cos(11 * Math.asin(up)) * round : 0.0007 * Math.sin(26 * turn + 5 * up) * crown;
  return BARE_M + (THICK_M[hair] + quiff - parting + locks - BARE_M) * grown * bald;
}

/** Lighter on the ridges of the locks. */
function strands(color: Color, count: number): Paint {
  const dark = color.clone().multiplyScalar(0.84), light = color.clone().lerp(new Color('#fff0dc'), 0.08);
  return (u, v, to) => to.copy(dark).lerp(light, 0.5 + 0.5 * Math.sin(count * turnAt(u) + 5 * upAt(v)) * Math.sin(Math.PI * v) ** 0.5);
}

export function addHair(cloth: ParametricMesh, look: Look): void {
  const { hair } = look, color = new Color(look.hairColor);
  cloth.put((u, v, to) => {
    const turn = turnAt(u), up = upOf(look, turn, v);
    return headPoint(look, turn, up, thickness(hair, turn, up), to);
  }, hair === 'curls' ? color : strands(color, 26), hair === 'curls' ? [64, 32] : [60, 22]);
  if (hair === 'bun') cloth.ball(ballAt(new Vector3(0, SKULL.y + 0.012, -0.016), 0.024, 0.021, 0.024), strands(color, 9), [24, 12]);
  if (hair === 'bob') fall(cloth, color, { top: 0.045, end: -0.056, wide: 0.057, curl: -0.010 });
  if (hair === 'long') fall(cloth, color, { top: 0.045, end: -0.094, wide: 0.055, curl: 0.010 });
  if (look.beard) addBeard(cloth, look);
}

/** Hair that falls beside and behind the face: a round wall, open in front. */
function fall(cloth: ParametricMesh, color: Color, { top, end, wide, curl }: { top: number; end: number; wide: number; curl: number }): void {
  const paint: Paint = (u, v, to) => to.copy(color).multiplyScalar(0.84 + 0.16 * Math.sin(60 * u) + 0.12 * smooth(0, 0.4, v));
  // The wall's cross-section: inner side from left to right and outer side back, so that it has a thickness and a round edge.
  cloth.put((u, v, to) => {
    const s = 2 * Math.PI * u, thick = 0.017, sweep = 2.0;
    const turn = Math.PI + sweep * Math.cos(s), out = thick * 0.5 * Math.sin(s);
    const down = 1 - v, y = end + (top - end) * v, flare = curl * smooth(0.35, 1, down), close = smooth(0, 0.12, down) * smooth(1, 0.94, down) ;
    const r = wide - 0.003 + flare + out * (0.25 + 0.75 * close) + 0.0008 * Math.sin(40 * turn) - 0.014 * smooth(0.75, 1, v);
    return to.set(Math.sin(turn) * r, y + 0.006 * Math.sin(3 * turn) * down, Math.cos(turn) * r * 0.92 - 0.006);
  }, paint, [52, 12]);
}

function addBeard(cloth: ParametricMesh, look: Look): void {
  const color = new Color(look.hairColor);
  cloth.put((u, v, to) => {
    const turn = (u - 0.5) * 3.1, away = Math.abs(turn);
    const upper = -0.44 + 0.42 * smooth(0.35, 1.3, away) - 0.26 * Math.exp(-((turn / 0.3) ** 2)), up = -0.99 + (upper + 1.04) * v;
    const grown = smooth(0.05, -0.1, up - upper) * smooth(1.55, 1.2, away);
    return headPoint(look, turn, up, BARE_M + (0.0068 + 0.0005 * Math.sin(30 * turn) - BARE_M) * grown, to);
  }, strands(color, 30), [36, 14]);
  for (const side of [-1, 1])
    cloth.tube((t, to) => headPoint(look, side * (0.02 + 0.36 * t), -0.375 - 0.2 * t * t, 0.0004, to), (t) => 0.0038 * Math.sqrt(Math.max(0, 1 - 0.7 * t)) * smooth(-0.08, 0.1, t), color, [10, 12]);
}
