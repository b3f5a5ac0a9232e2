// Squeezed plastic deforms around the skin: where a finger is inside a soft object, its wall moves in as far as the
// finger does. So the hand never appears inside the object. A wall that lost its content keeps part of the dent.

import { Vector3, type BufferGeometry, type Object3D } from 'three';
import type { SkinUniforms } from '../hand/skin_shader';
import { toThree } from './frames';

/** A capsule of the skin in the object's frame, y along its axis [m]. */
export interface PressingCapsule { readonly a: Vector3; readonly b: Vector3; readonly radiusA: number; readonly radiusB: number }

/** Vertices nearer to the axis than this share of the radius belong to the ends and stay. */
const WALL_SHARE = 0.95;
const STEPS = 3;

/** Depth of a point in the nearest of the capsules; 0 outside [m]. */
export function depthIn(list: readonly PressingCapsule[], x: number, y: number, z: number): number {
  let depth = 0;
  for (const { a, b, radiusA, radiusB } of list) {
    const ux = b.x - a.x, uy = b.y - a.y, uz = b.z - a.z, px = x - a.x, py = y - a.y, pz = z - a.z;
    const along = (px * ux + py * uy + pz * uz) / Math.max(ux * ux + uy * uy + uz * uz, 1e-12);
    const h = along < 0 ? 0 : along > 1 ? 1 : along;
    depth = Math.max(depth, radiusA + (radiusB - radiusA) * h - Math.hypot(px - ux * h, py - uy * h, pz - uz * h));
  }
  return depth;
}

/** The hand's capsules that reach into a cylinder around the object's y axis. */
export function pressingOn(object: Object3D, skin: SkinUniforms, radius_m: number): PressingCapsule[] {
  object.updateMatrixWorld();
  const inverse = object.matrixWorld.clone().invert(), out: PressingCapsule[] = [];
  skin.capsuleA.value.forEach((a, i) => {
    const b = skin.capsuleB.value[i];
    const p = { a: toThree(a).applyMatrix4(inverse), b: toThree(b).applyMatrix4(inverse), radiusA: Math.abs(a.w), radiusB: b.w };
    // Lower bound of the segment's distance to the axis: fast, and never too large.
    const dx = p.b.x - p.a.x, dz = p.b.z - p.a.z, h = Math.min(1, Math.max(0, -(p.a.x * dx + p.a.z * dz) / Math.max(dx * dx + dz * dz, 1e-12)));
    if (Math.hypot(p.a.x + dx * h, p.a.z + dz * h) < radius_m + Math.max(p.radiusA, p.radiusB)) out.push(p);
  });
  return out;
}

export class Dent {
  private readonly rest: Float32Array;
  /** For each vertex: its radius relative to that at rest. */
  private readonly parts: Float32Array;
  /** For each vertex: 0 at the wall's ends, 1 in its middle. */
  private readonly middle: Float32Array;
  private dented = false;

  constructor(private readonly geometry: BufferGeometry, private readonly radius_m: number) {
    this.rest = Float32Array.from(geometry.attributes.position.array);
    this.parts = new Float32Array(this.rest.length / 3).fill(1);
    const walls = [...this.parts.keys()].filter((v) => this.isWall(v)), heights = walls.map((v) => this.rest[3 * v + 1]);
    const low = Math.min(...heights), long = Math.max(...heights) - low;
    this.middle = new Float32Array(this.parts.length);
    walls.forEach((v, i) => { this.middle[v] = Math.sin(Math.PI * (heights[i] - low) / Math.max(long, 1e-9)) ** 2; });
  }

  private isWall(v: number): boolean { return Math.hypot(this.rest[3 * v], this.rest[3 * v + 2]) > WALL_SHARE * this.radius_m; }

  /**
   * @param keeps share of the dent that stays where nothing presses any more, 0 .. 1
   * @param waist relative narrowing of the whole wall in its middle, 0 .. 1
   */
  update(list: readonly PressingCapsule[], keeps = 0, waist = 0): void {
    if (list.length === 0 && !this.dented && waist === 0) return;
    this.dented = false;
    const at = this.geometry.attributes.position, to = at.array, { rest, parts } = this;
    for (let i = 0, v = 0; i < rest.length; i += 3, v++) {
      const x = rest[i], y = rest[i + 1], z = rest[i + 2], r = Math.hypot(x, z);
      let part = 1 - waist * this.middle[v];
      if (this.isWall(v))
        for (let n = 0; n < STEPS; n++) {
          const depth = depthIn(list, part * x, y, part * z);
          if (depth <= 0) break;
          part *= Math.max(0.5, 1 - depth / (part * r));
        }
      parts[v] = Math.min(part, 1 - keeps * (1 - parts[v]));
      this.dented ||= parts[v] < 1;
      to[i] = parts[v] * x;
      to[i + 2] = parts[v] * z;
    }
    at.needsUpdate = true;
  }
}
