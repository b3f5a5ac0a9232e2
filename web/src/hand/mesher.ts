// The skin of one link as triangles: naive surface nets over a grid, then projection onto the field's zero set.

import { capsuleDistance, colliderField, skinField } from './field';
import type { HandCapsule } from './shape';

export interface LinkMesh {
  readonly positions: Float32Array;   // link frame [m], three a vertex
  readonly triangles: Uint32Array;    // outward by the right-hand rule
}

/** Cells are evaluated in cubes of this many per side; a cube without surface costs one distance. */
const BLOCK = 4;
const NEWTON_STEPS = 4;
/** Capsules farther from a point than the nearest by this do not affect the field there [m]. */
const FIELD_REACH_M = 8e-3;

interface Grid {
  readonly origin: readonly [number, number, number];
  readonly size: readonly [number, number, number];   // samples along each axis
  readonly step: number;
  readonly values: Float32Array;
}

function gridAround(capsules: readonly HandCapsule[], step: number): Grid {
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  for (const c of capsules)
    for (const end of [c.a, c.b])
      for (let i = 0; i < 3; i++) {
        low[i] = Math.min(low[i], end[i] - c.radius - 2 * step);
        high[i] = Math.max(high[i], end[i] + c.radius + 2 * step);
      }
  const samples = (i: number) => Math.ceil((high[i] - low[i]) / step / BLOCK) * BLOCK + 1;
  const size = [samples(0), samples(1), samples(2)] as const;
  return { origin: [low[0], low[1], low[2]], size, step,
           values: new Float32Array(size[0] * size[1] * size[2]).fill(1) };
}

/** The capsules that shape the field within `around` metres of a point. */
function nearCapsules(capsules: readonly HandCapsule[], x: number, y: number, z: number, around: number): HandCapsule[] {
  const distances = capsules.map((c) => capsuleDistance(c, x, y, z));
  const limit = Math.min(...distances) + 2 * around + FIELD_REACH_M;
  return capsules.filter((_, i) => distances[i] < limit);
}

function sampleBlock(grid: Grid, capsules: readonly HandCapsule[], I: number, J: number, K: number): void {
  const { origin, size: [nx, ny], step, values } = grid;
  const reach = 0.5 * BLOCK * step * Math.sqrt(3);
  const at = [I, J, K].map((n, axis) => origin[axis] + (n + BLOCK / 2) * step);
  const middle = colliderField(capsules, at[0], at[1], at[2]);
  const apart = Math.abs(middle) > reach + 1e-3;
  const near = apart ? [] : nearCapsules(capsules, at[0], at[1], at[2], reach);
  for (let k = K; k <= K + BLOCK; k++)
    for (let j = J; j <= J + BLOCK; j++)
      for (let i = I; i <= I + BLOCK; i++) {
        const index = (k * ny + j) * nx + i;
        // A neighbouring block may have sampled its border; the grid's initial value means outside.
        if (!apart) values[index] = skinField(near, origin[0] + i * step, origin[1] + j * step, origin[2] + k * step);
        else if (middle < 0 && values[index] === 1) values[index] = -1;
      }
}

function sample(grid: Grid, capsules: readonly HandCapsule[]): void {
  const [nx, ny, nz] = grid.size;
  for (let K = 0; K < nz - 1; K += BLOCK)
    for (let J = 0; J < ny - 1; J += BLOCK)
      for (let I = 0; I < nx - 1; I += BLOCK) sampleBlock(grid, capsules, I, J, K);
}

/** Makes a vertex for every cell that the surface crosses, at the mean of its edges' crossings. */
function placeVertices(grid: Grid): { positions: number[]; vertexOf: Int32Array } {
  const { origin, size: [nx, ny, nz], step, values } = grid;
  const edges = [0, 1, 0, 2, 0, 4, 1, 3, 1, 5, 2, 3, 2, 6, 3, 7, 4, 5, 4, 6, 5, 7, 6, 7];
  const positions: number[] = [], vertexOf = new Int32Array(values.length).fill(-1), v = new Float32Array(8);
  for (let k = 0; k < nz - 1; k++)
    for (let j = 0; j < ny - 1; j++)
      for (let i = 0; i < nx - 1; i++) {
        const cell = (k * ny + j) * nx + i;
        let inside = 0;
        for (let c = 0; c < 8; c++) {
          v[c] = values[cell + (c & 1) + ((c >> 1) & 1) * nx + (c >> 2) * nx * ny];
          if (v[c] < 0) inside++;
        }
        if (inside === 0 || inside === 8) continue;
        let n = 0, x = 0, y = 0, z = 0;
        for (let e = 0; e < edges.length; e += 2) {
          const a = edges[e], b = edges[e + 1];
          if ((v[a] < 0) === (v[b] < 0)) continue;
          const t = v[a] / (v[a] - v[b]);
          n++;
          x += (a & 1) + t * ((b & 1) - (a & 1));
          y += ((a >> 1) & 1) + t * (((b >> 1) & 1) - ((a >> 1) & 1));
          z += (a >> 2) + t * ((b >> 2) - (a >> 2));
        }
        vertexOf[cell] = positions.length / 3;
        positions.push(origin[0] + (i + x / n) * step, origin[1] + (j + y / n) * step, origin[2] + (k + z / n) * step);
      }
  return { positions, vertexOf };
}

/** Makes two triangles for every grid edge that the surface crosses, between the four cells around it. */
function connect(grid: Grid, vertexOf: Int32Array): number[] {
  const { size: [nx, ny, nz], values } = grid, triangles: number[] = [];
  const stride = [1, nx, nx * ny];
  for (let k = 1; k < nz - 1; k++)
    for (let j = 1; j < ny - 1; j++)
      for (let i = 1; i < nx - 1; i++) {
        const cell = (k * ny + j) * nx + i, inside = values[cell] < 0;
        for (let axis = 0; axis < 3; axis++) {
          if (inside === values[cell + stride[axis]] < 0) continue;
          const u = stride[(axis + 1) % 3], w = stride[(axis + 2) % 3];
          const quad = [cell - u - w, cell - w, cell, cell - u].map((c) => vertexOf[c]);
          if (quad.some((vertex) => vertex < 0)) continue;
          const [a, b, c, d] = inside ? quad : [quad[0], quad[3], quad[2], quad[1]];
          triangles.push(a, b, c, a, c, d);
        }
      }
  return triangles;
}

/** Moves every vertex to the field's zero set by Newton's method along the gradient. */
function project(positions: Float32Array, capsules: readonly HandCapsule[], step: number): void {
  const e = 0.1e-3;
  for (let v = 0; v < positions.length; v += 3) {
    let x = positions[v], y = positions[v + 1], z = positions[v + 2];
    const near = nearCapsules(capsules, x, y, z, step);
    for (let n = 0; n < NEWTON_STEPS; n++) {
      const d = skinField(near, x, y, z);
      if (Math.abs(d) < 1e-6) break;
      const gx = skinField(near, x + e, y, z) - skinField(near, x - e, y, z);
      const gy = skinField(near, x, y + e, z) - skinField(near, x, y - e, z);
      const gz = skinField(near, x, y, z + e) - skinField(near, x, y, z - e);
      const g = Math.hypot(gx, gy, gz) || 1, move = Math.max(-step, Math.min(step, d)) / g;
      x -= gx * move; y -= gy * move; z -= gz * move;
    }
    positions[v] = x; positions[v + 1] = y; positions[v + 2] = z;
  }
}

/** The closed skin around the capsules of one link, in its frame. @param step grid spacing [m] */
export function meshLink(capsules: readonly HandCapsule[], step: number): LinkMesh {
  const grid = gridAround(capsules, step);
  sample(grid, capsules);
  const { positions, vertexOf } = placeVertices(grid);
  const triangles = connect(grid, vertexOf);
  const out = { positions: new Float32Array(positions), triangles: new Uint32Array(triangles) };
  project(out.positions, capsules, step);
  return out;
}
