// Distance fields of the colliders and of the skin around those of one link, and the weights of the shading.
//
//   skin = clamp(smooth union of the skin's capsules, hard union of the colliders ± SKIN_REACH_M)
//
// so that on its zero set no point is further than SKIN_REACH_M from the colliders.

import { SKIN_REACH_M, type HandCapsule } from './shape';

/** Width of the fillet between capsules of one link [m]. */
const FILLET_M = 5e-3;
/** Rounding radius where SKIN_REACH_M limits the fillet [m]. */
const CLAMP_M = 0.3e-3;

/** Minimum with a parabola of width k around the corner; equal to the minimum for |a - b| >= k. */
export function smoothMin(a: number, b: number, k: number): number {
  const h = Math.max(k - Math.abs(a - b), 0) / k;
  return Math.min(a, b) - h * h * k * 0.25;
}
const smoothMax = (a: number, b: number, k: number): number => -smoothMin(-a, -b, k);

/** Position along the capsule's axis from a to b that is nearest to (x, y, z), 0 .. 1. */
function along(c: HandCapsule, x: number, y: number, z: number): number {
  const bx = c.b[0] - c.a[0], by = c.b[1] - c.a[1], bz = c.b[2] - c.a[2];
  const squared = bx * bx + by * by + bz * bz;
  if (squared <= 0) return 0;
  const h = ((x - c.a[0]) * bx + (y - c.a[1]) * by + (z - c.a[2]) * bz) / squared;
  return h < 0 ? 0 : h > 1 ? 1 : h;
}

function axisDistance(c: HandCapsule, h: number, x: number, y: number, z: number): number {
  const dx = x - c.a[0] - (c.b[0] - c.a[0]) * h;
  const dy = y - c.a[1] - (c.b[1] - c.a[1]) * h;
  const dz = z - c.a[2] - (c.b[2] - c.a[2]) * h;
  return Math.sqrt(dx * dx + dy * dy + dz * dz);
}

/** Signed distance to a collider, in its link's frame [m]. */
export function capsuleDistance(c: HandCapsule, x: number, y: number, z: number): number {
  return axisDistance(c, along(c, x, y, z), x, y, z) - c.radius;
}

/** Signed distance to the skin's own capsule, whose radius changes linearly along the axis [m]. */
export function skinCapsuleDistance(c: HandCapsule, x: number, y: number, z: number): number {
  const h = along(c, x, y, z);
  return axisDistance(c, h, x, y, z) - (c.skinA + (c.skinB - c.skinA) * h);
}

/** Signed distance to the union of the colliders of one link [m]. */
export function colliderField(capsules: readonly HandCapsule[], x: number, y: number, z: number): number {
  let nearest = Infinity;
  for (const c of capsules) nearest = Math.min(nearest, capsuleDistance(c, x, y, z));
  return nearest;
}

/** The skin field around the capsules of one link: zero on the skin, negative inside [m]. */
export function skinField(capsules: readonly HandCapsule[], x: number, y: number, z: number): number {
  let soft = Infinity, hard = Infinity;
  for (const c of capsules) {
    const h = along(c, x, y, z), d = axisDistance(c, h, x, y, z);
    const own = d - (c.skinA + (c.skinB - c.skinA) * h);
    soft = soft === Infinity ? own : smoothMin(soft, own, FILLET_M);
    if (d - c.radius < hard) hard = d - c.radius;
  }
  return smoothMin(smoothMax(soft, hard - SKIN_REACH_M, CLAMP_M), hard + SKIN_REACH_M, CLAMP_M);
}

/**
 * Adds a capsule's share of the shading at a point: its outward direction, weighted by exp(-d / width).
 * The direction of the sum over capsules is the normal for the light: smoother than the geometry,
 * so that the surface looks like skin while the geometry stays at the colliders.
 * x, y, z and the weight itself are added to `sum`.
 */
export function addShading(sum: Float64Array, c: HandCapsule, x: number, y: number, z: number): void {
  const h = along(c, x, y, z);
  const dx = x - c.a[0] - (c.b[0] - c.a[0]) * h;
  const dy = y - c.a[1] - (c.b[1] - c.a[1]) * h;
  const dz = z - c.a[2] - (c.b[2] - c.a[2]) * h;
  const d = Math.sqrt(dx * dx + dy * dy + dz * dz) || 1e-9;
  const weight = Math.exp(-(d - (c.skinA + (c.skinB - c.skinA) * h)) / c.shading);
  sum[0] += weight * dx / d;
  sum[1] += weight * dy / d;
  sum[2] += weight * dz / d;
  sum[3] += weight;
}
