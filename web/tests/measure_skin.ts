// Distance between the drawn skin and the colliders, over many postures.

import { capsuleDistance, colliderField } from '../src/hand/field';
import { SKIN_REACH_M, type HandCapsule, type HandShape } from '../src/hand/shape';
import type { SkinMesh } from '../src/hand/skin_mesh';
import { length, mix, sub, toWorld, type Vec } from '../src/hand/vector';

export interface Distances {
  readonly outside: number;   // largest distance outside the colliders [m]
  readonly inside: number;    // largest distance inside them [m]
  readonly p995: number;      // 99.5th percentile of the absolute distance [m]
  readonly count: number;     // number of measured points
}

export interface SkinDistances {
  /** Distances to the colliders of the vertex's own link: the same in every posture. */
  readonly vertices: Distances;
  readonly centres: Distances;      // centres of triangles
  /** Distances to all colliders of the posed hand, of all visible points. */
  readonly posedVertices: Distances;
  readonly posedCentres: Distances;
}

class DistanceStatistics {
  private readonly all: number[] = [];
  private out = 0;
  private in = 0;
  add(distance: number): void {
    this.all.push(Math.abs(distance));
    this.out = Math.max(this.out, distance);
    this.in = Math.max(this.in, -distance);
  }
  result(): Distances {
    const sorted = Float64Array.from(this.all).sort();
    const p995 = sorted.length ? sorted[Math.min(sorted.length - 1, Math.floor(0.995 * sorted.length))] : 0;
    return { outside: this.out, inside: this.in, p995, count: sorted.length };
  }
}

function points(mesh: SkinMesh): { vertices: { p: Vec; slot: number }[]; centres: { p: Vec; slot: number }[] } {
  const at = (v: number): Vec => [mesh.positions[3 * v], mesh.positions[3 * v + 1], mesh.positions[3 * v + 2]];
  const vertices = Array.from(mesh.links, (slot, v) => ({ p: at(v), slot }));
  const centres = [];
  for (let t = 0; t < mesh.triangles.length; t += 3) {
    const [a, b, c] = [0, 1, 2].map((i) => at(mesh.triangles[t + i]));
    centres.push({ p: [0, 1, 2].map((i) => (a[i] + b[i] + c[i]) / 3) as unknown as Vec, slot: mesh.links[mesh.triangles[t]] });
  }
  return { vertices, centres };
}

/** The colliders in a posture, in the world. */
function posedColliders(shape: HandShape, poses: ArrayLike<number>): HandCapsule[] {
  return shape.capsules.map((c) => ({ ...c, a: toWorld(poses, c.link, c.a), b: toWorld(poses, c.link, c.b) }));
}

/** The colliders that may be nearest to a point of the link's skin, or hide it: its own and overlapping ones. */
function collidersNear(colliders: readonly HandCapsule[], link: number): HandCapsule[] {
  const reach_m = 2e-3, middle = (c: HandCapsule) => mix(c.a, c.b, 0.5), size = (c: HandCapsule) => length(sub(c.b, c.a)) / 2 + c.radius;
  const own = colliders.filter((c) => c.link === link);
  return colliders.filter((c) => own.some((o) => length(sub(middle(o), middle(c))) <= size(o) + size(c) + reach_m));
}

/**
 * Distance of a point of the world to the union of all colliders. Undefined if another link's
 * skin hides the point: that skin is at most SKIN_REACH_M inside its own colliders.
 */
function posedDistance(colliders: readonly HandCapsule[], link: number, p: Vec): number | undefined {
  let nearest = Infinity;
  for (const c of colliders) {
    const d = capsuleDistance(c, p[0], p[1], p[2]);
    if (c.link !== link && d < -SKIN_REACH_M) return undefined;
    if (d < nearest) nearest = d;
  }
  return nearest;
}

export function measureSkin(shape: HandShape, mesh: SkinMesh, postures: readonly ArrayLike<number>[]): SkinDistances {
  const { vertices, centres } = points(mesh);
  const own = shape.links.map((link) => shape.capsules.filter((c) => c.link === link));
  const still = (list: typeof vertices) => {
    const statistics = new DistanceStatistics();
    for (const { p, slot } of list) statistics.add(colliderField(own[slot], p[0], p[1], p[2]));
    return statistics.result();
  };
  const posed = (list: typeof vertices) => {
    const statistics = new DistanceStatistics();
    for (const poses of postures) {
      const colliders = posedColliders(shape, poses), near = shape.links.map((link) => collidersNear(colliders, link));
      for (const { p, slot } of list) {
        const d = posedDistance(near[slot], shape.links[slot], toWorld(poses, shape.links[slot], p));
        if (d !== undefined) statistics.add(d);
      }
    }
    return statistics.result();
  };
  return { vertices: still(vertices), centres: still(centres), posedVertices: posed(vertices), posedCentres: posed(centres) };
}
