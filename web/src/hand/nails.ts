// Nails: thin shells on the last capsule of each digit, in the frame of its link.

import type { BufferGeometry } from 'three';
import { HandPart } from '../protocol';
import { gridGeometry } from './grid';
import type { HandCapsule, HandShape } from './shape';
import { palmarDirection } from './skin_mesh';
import { add, cross, length, scale, sub, type Vec } from './vector';

/** Height of the nail over the skin, and depth of its edge below it [m]; the skin may be up to 0.07 mm below its reach. */
const OVER_M = 0.34e-3;
const UNDER_M = -0.25e-3;
const CELLS = 18;
/** Half width and length, in radii of the fingertip. */
const HALF_WIDTH = 0.83;
const LENGTH = 1.62;
/** Distance of the nail's end beyond the centre of the tip, in radii. */
const BEYOND = 0.62;

/** The last capsule of each digit. */
export function fingertips(shape: HandShape): HandCapsule[] {
  const last = new Map<HandPart, HandCapsule>();
  for (const c of shape.capsules) if (c.part !== HandPart.Palm) last.set(c.part, c);
  return [...last.values()];
}

/** Maps a square to a rounded one, each coordinate -1 .. 1. */
function squircle(a: number, b: number): [number, number] {
  const e = 3.4, even = Math.pow(Math.abs(a) ** e + Math.abs(b) ** e, 1 / e);
  const k = even > 0 ? Math.max(Math.abs(a), Math.abs(b)) / even : 1;
  return [a * k, b * k];
}

export function nailGeometry(shape: HandShape, tip: HandCapsule): BufferGeometry {
  const axis = sub(tip.b, tip.a), long = length(axis), along = scale(axis, 1 / long);
  const dorsal = scale(palmarDirection(shape, tip.link), -1), side = cross(along, dorsal);
  const r = tip.skinB, extent = r * LENGTH, start = long + r * BEYOND - extent;
  const at: number[] = [];
  for (let j = 0; j <= CELLS; j++)
    for (let i = 0; i <= CELLS; i++) {
      const u = 2 * i / CELLS - 1, v = 2 * j / CELLS - 1, [a, b] = squircle(u, v);
      const s = start + (b + 1) / 2 * extent, beyond = Math.max(0, s - long), angle = a * HALF_WIDTH;
      const here = tip.skinA + (r - tip.skinA) * Math.min(1, s / long);
      const rim = Math.max(Math.abs(u), Math.abs(v)) > 0.93;
      const radius = Math.sqrt(Math.max(0.2 * r * r, here * here - 0.86 * beyond * beyond)) + (rim ? UNDER_M : OVER_M);
      const p: Vec = add(add(add(tip.a, scale(along, s)), scale(dorsal, radius * Math.cos(angle))), scale(side, radius * Math.sin(angle)));
      at.push(...p);
    }
  return gridGeometry(at, CELLS);
}
