// The skin of a whole hand: one rigid, closed mesh per link, in one set of arrays. A vertex moves
// with its link alone, so its distance to the colliders is the same in every posture; only the
// shading depends on the posture, because it also uses capsules of neighbouring links.

import { HandPart } from '../protocol';
import { addShading, skinCapsuleDistance } from './field';
import { meshLink } from './mesher';
import type { HandCapsule, HandShape } from './shape';
import { inSpatialOrder } from './vertex_order';
import { toLink, toWorld, type Vec } from './vector';

/** Number of other links' capsules that a vertex's shading uses. */
export const NEIGHBOURS = 8;
/** Marks an unused entry of `neighbours`. */
const NO_CAPSULE = 255;

export interface SkinMesh {
  readonly positions: Float32Array;    // frame of the vertex's link [m]
  readonly shading: Float32Array;      // four values a vertex: the share of its own link, see addShading
  readonly links: Uint8Array;          // index into HandShape.links
  readonly neighbours: Uint8Array;     // NEIGHBOURS a vertex: indices into HandShape.capsules
  readonly palmar: Float32Array;       // 1 on the palm's side, -1 on the back
  readonly triangles: Uint32Array;
}

/** Outward direction on the palm's side, in the frame of a link: dorsal is z, and ±y on the thumb. */
export function palmarDirection(shape: HandShape, link: number): Vec {
  if (shape.digitOfLink.get(link) !== HandPart.Thumb) return [0, 0, -1];
  return shape.right ? [0, -1, 0] : [0, 1, 0];
}

/** The capsules of other links that may smooth the shading of this vertex. */
function candidates(shape: HandShape, link: number, own: HandCapsule): number[] {
  const digit = shape.digitOfLink.get(link), isBase = shape.baseLinks.has(link);
  const out: number[] = [];
  shape.capsules.forEach((c, i) => {
    if (c.link === link) return;
    const other = shape.digitOfLink.get(c.link);
    const sameDigit = other === digit && digit !== HandPart.Palm;
    // Digits blend with the palm at their base, and never with each other; but the webs between the
    // fingers belong to the palm, whatever phalanx they move with.
    const toPalm = isBase && c.part === HandPart.Palm;
    const fromPalm = (digit === HandPart.Palm || own.part === HandPart.Palm) && shape.baseLinks.has(c.link);
    if (sameDigit || toPalm || fromPalm) out.push(i);
  });
  return out;
}

/** The NEIGHBOURS capsules of `from` that are nearest to a point of the world. */
function nearest(shape: HandShape, poses: ArrayLike<number>, from: readonly number[], world: Vec): number[] {
  return from
    .map((i) => {
      const p = toLink(poses, shape.capsules[i].link, world);
      return { i, d: skinCapsuleDistance(shape.capsules[i], p[0], p[1], p[2]) };
    })
    .sort((a, b) => a.d - b.d)
    .slice(0, NEIGHBOURS)
    .map((n) => n.i);
}

/**
 * @param poses any posture of the hand, preferably half closed: it shows which parts are neighbours
 * @param step grid spacing [m]: 1.5e-3 looks smooth, 3.0e-3 is quick to draw
 */
export function skinMesh(shape: HandShape, poses: ArrayLike<number>, step: number): SkinMesh {
  const meshes = shape.links.map((link) =>
    inSpatialOrder(meshLink(shape.capsules.filter((c) => c.link === link), step), step));
  const count = meshes.reduce((n, m) => n + m.positions.length / 3, 0);
  const out: SkinMesh = {
    positions: new Float32Array(count * 3), shading: new Float32Array(count * 4),
    links: new Uint8Array(count), neighbours: new Uint8Array(count * NEIGHBOURS).fill(NO_CAPSULE),
    palmar: new Float32Array(count),
    triangles: new Uint32Array(meshes.reduce((n, m) => n + m.triangles.length, 0)),
  };
  let vertex = 0, corner = 0;
  meshes.forEach((mesh, slot) => {
    out.positions.set(mesh.positions, vertex * 3);
    mesh.triangles.forEach((index, i) => { out.triangles[corner + i] = index + vertex; });
    shadeLink(shape, poses, slot, mesh.positions, out, vertex);
    vertex += mesh.positions.length / 3;
    corner += mesh.triangles.length;
  });
  return out;
}

function shadeLink(shape: HandShape, poses: ArrayLike<number>, slot: number, positions: Float32Array,
                   out: SkinMesh, first: number): void {
  const link = shape.links[slot], own = shape.capsules.filter((c) => c.link === link);
  const palmar = palmarDirection(shape, link), sum = new Float64Array(4);
  const from = own.map((c) => candidates(shape, link, c));
  for (let n = 0; n < positions.length / 3; n++) {
    const x = positions[3 * n], y = positions[3 * n + 1], z = positions[3 * n + 2], v = first + n;
    sum.fill(0);
    let closest = 0, distance = Infinity;
    own.forEach((c, i) => {
      addShading(sum, c, x, y, z);
      const d = skinCapsuleDistance(c, x, y, z);
      if (d < distance) { distance = d; closest = i; }
    });
    out.shading.set(sum, v * 4);
    out.links[v] = slot;
    out.neighbours.set(nearest(shape, poses, from[closest], toWorld(poses, link, [x, y, z])), v * NEIGHBOURS);
    const l = Math.hypot(sum[0], sum[1], sum[2]) || 1;
    out.palmar[v] = (sum[0] * palmar[0] + sum[1] * palmar[1] + sum[2] * palmar[2]) / l;
  }
}
