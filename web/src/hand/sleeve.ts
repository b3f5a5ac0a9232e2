// Sleeve and cuff over the wrist, in a right palm's frame (x distal, y radial, z dorsal): the forearm extends
// backwards and leaves the picture on the side of the back of the hand.

import type { BufferAttribute, BufferGeometry } from 'three';
import { gridGeometry } from './grid';

/** Position of the wrist along x of the palm [m]; the arm begins to bend here. */
const WRIST_M = -0.06;
/** The forearm's inclination to ulnar and to dorsal far from the wrist, and the length of the transition. */
const LEAN_ULNAR = 0.52;
const LEAN_DORSAL = 0.32;
const BEND_M = 0.05;
/** Middle of the cuff; the wrist's colliders end under it [m]. */
const CUFF_M = -0.049;
const CENTRE_DORSAL_M = -0.003;
/** Width in the palm's plane and across it, relative to the profile's radius. */
const WIDE = 1.02;
const DEEP = 0.86;

/** Radius and position along the arm [m]. */
type Profile = readonly (readonly [number, number])[];

function sweep(profile: Profile, wrinkle_m: number, around: number): BufferGeometry {
  const at: number[] = [];
  profile.forEach(([radius, x]) => {
    const beyond = Math.max(0, WRIST_M - x), bend = Math.sqrt(beyond * beyond + BEND_M * BEND_M) - BEND_M;
    for (let i = 0; i <= around; i++) {
      const angle = 2 * Math.PI * (i % around) / around;
      const fold = wrinkle_m * (0.45 * Math.sin(x / 0.01 + 2 * angle) + Math.sin(x / 0.031 + 3 * angle));
      at.push(x, Math.cos(angle) * (radius * WIDE + fold) - LEAN_ULNAR * bend,
              Math.sin(angle) * (radius * DEEP + fold) + CENTRE_DORSAL_M + LEAN_DORSAL * bend);
    }
  });
  const geometry = gridGeometry(at, around);
  closeSeam(geometry, profile.length, around);
  return geometry;
}

/** Gives the first and last vertex of a ring, which coincide, one normal. */
function closeSeam(geometry: BufferGeometry, rows: number, around: number): void {
  const normal = geometry.attributes.normal as BufferAttribute;
  for (let row = 0; row < rows; row++) {
    const a = row * (around + 1), b = a + around;
    const sum = [normal.getX(a) + normal.getX(b), normal.getY(a) + normal.getY(b), normal.getZ(a) + normal.getZ(b)];
    const l = Math.hypot(...sum) || 1;
    for (const i of [a, b]) normal.setXYZ(i, sum[0] / l, sum[1] / l, sum[2] / l);
  }
}

/** Resolution of cloth: segments along a ring, and length of a row [m]. */
export interface ClothResolution { readonly around: number; readonly row_m: number }

/** Dark plain cloth, from the elbow to under the cuff. @param size breadth of the hand relative to the median */
export function sleeveGeometry(size: number, weave: ClothResolution): BufferGeometry {
  const rows: [number, number][] = [];
  for (let x = -0.64; x < CUFF_M - 0.016; x += weave.row_m) rows.push([(0.0314 + Math.min(0.006, (CUFF_M - 0.016 - x) * 0.04)) * size, x]);
  rows.push([0.0314 * size, CUFF_M - 0.015], [0.03 * size, CUFF_M - 0.013]);
  return sweep(rows, 0.001, weave.around);
}

/** The light rolled cuff: radius, and position relative to CUFF_M [mm]. */
const ROLLED: Profile = [[31, -20], [33.6, -18.5], [34.2, -15], [33.8, -6], [33.2, 2], [32.2, 5], [30.6, 5.6], [29.4, 4.6], [28.4, -1], [27.6, -20]];

export function cuffGeometry(size: number, weave: ClothResolution): BufferGeometry {
  return sweep(ROLLED.map(([r, x]) => [r * 1e-3 * size, CUFF_M + x * 1e-3]), 0, weave.around);
}
