// Orders triangles and vertices so that spatial neighbours follow one another: then a vertex that several triangles
// share is shaded once, since a renderer caches only the last few.

import type { LinkMesh } from './mesher';

/** Spreads ten bits so that two more fit between adjacent ones. */
function spread(n: number): number {
  n = (n | (n << 16)) & 0x030000ff;
  n = (n | (n << 8)) & 0x0300f00f;
  n = (n | (n << 4)) & 0x030c30c3;
  return (n | (n << 2)) & 0x09249249;
}

/** @param step about the length of an edge [m] */
export function inSpatialOrder(mesh: LinkMesh, step: number): LinkMesh {
  const { positions, triangles } = mesh, count = triangles.length / 3;
  const low = [0, 1, 2].map((axis) => {
    let least = Infinity;
    for (let i = axis; i < positions.length; i += 3) least = Math.min(least, positions[i]);
    return least;
  });
  const keys = new Float64Array(count);
  for (let t = 0; t < count; t++) {
    let key = 0;
    for (let axis = 0; axis < 3; axis++) {
      const middle = (positions[3 * triangles[3 * t] + axis] + positions[3 * triangles[3 * t + 1] + axis] + positions[3 * triangles[3 * t + 2] + axis]) / 3;
      key |= spread(Math.min(1023, Math.floor((middle - low[axis]) / step))) << axis;
    }
    keys[t] = (key >>> 0) * count + t;   // the index is part of the key, so that plain numbers are sorted
  }
  keys.sort();
  const order = keys.map((key) => key % count);
  const renumbered = new Int32Array(positions.length / 3).fill(-1);
  const out = { positions: new Float32Array(positions.length), triangles: new Uint32Array(triangles.length) };
  let next = 0;
  order.forEach((t, n) => {
    for (let i = 0; i < 3; i++) {
      const old = triangles[3 * t + i];
      if (renumbered[old] < 0) {
        out.positions.set(positions.subarray(3 * old, 3 * old + 3), 3 * next);
        renumbered[old] = next++;
      }
      out.triangles[3 * n + i] = renumbered[old];
    }
  });
  return out;
}
