// Sleeve and cuff over the wrist, in the palm's frame (x distal, y radial, z dorsal): the forearm goes
// back to the guest and leaves the picture to the side of the back of the hand.

import { BufferAttribute, BufferGeometry } from 'three';

/** Of the wrist against the palm's origin [m]: below it the arm begins to bend. */
const WRIST_M = -0.055;
/** How far the forearm's direction leans to ulnar and to dorsal, far from the wrist, and how soon. */
const LEAN_ULNAR = 0.52;
const LEAN_DORSAL = 0.32;
const BEND_M = 0.05;
const CENTRE_DORSAL_M = -0.003;
/** Width in the palm's plane and across it, against the profile's radius. */
const WIDE = 1.02;
const DEEP = 0.86;
const AROUND = 64;

/** Radius and place along the arm [m]. */
type Profile = readonly (readonly [number, number])[];

function sweep(profile: Profile, wrinkle_m: number): BufferGeometry {
  const at: number[] = [], index: number[] = [];
  profile.forEach(([radius, x], row) => {
    const beyond = Math.max(0, WRIST_M - x), bend = Math.sqrt(beyond * beyond + BEND_M * BEND_M) - BEND_M;
    for (let i = 0; i <= AROUND; i++) {
      const angle = 2 * Math.PI * (i % AROUND) / AROUND;
      const fold = wrinkle_m * (0.45 * Math.sin(x / 0.01 + 2 * angle) + Math.sin(x / 0.031 + 3 * angle));
      at.push(x, Math.cos(angle) * (radius * WIDE + fold) - LEAN_ULNAR * bend,
              Math.sin(angle) * (radius * DEEP + fold) + CENTRE_DORSAL_M + LEAN_DORSAL * bend);
    }
    if (row === 0) return;
    for (let i = 0; i < AROUND; i++) {
      const q = (row - 1) * (AROUND + 1) + i;
      index.push(q, q + 1, q + AROUND + 1, q + 1, q + AROUND + 2, q + AROUND + 1);
    }
  });
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(new Float32Array(at), 3));
  geometry.setIndex(index);
  geometry.computeVertexNormals();
  closeSeam(geometry, profile.length);
  return geometry;
}

/** First and last vertex of a ring are one point: they take one normal. */
function closeSeam(geometry: BufferGeometry, rows: number): void {
  const normal = geometry.attributes.normal as BufferAttribute;
  for (let row = 0; row < rows; row++) {
    const a = row * (AROUND + 1), b = a + AROUND;
    const sum = [normal.getX(a) + normal.getX(b), normal.getY(a) + normal.getY(b), normal.getZ(a) + normal.getZ(b)];
    const l = Math.hypot(...sum) || 1;
    for (const i of [a, b]) normal.setXYZ(i, sum[0] / l, sum[1] / l, sum[2] / l);
  }
}

/** Dark quiet cloth, from the elbow to under the cuff. @param size breadth of the hand against the median */
export function sleeveGeometry(size: number): BufferGeometry {
  const rows: [number, number][] = [];
  for (let x = -0.64; x < -0.058; x += 0.007) rows.push([(0.0314 + Math.min(0.006, (-0.058 - x) * 0.04)) * size, x]);
  rows.push([0.0314 * size, -0.057], [0.03 * size, -0.055]);
  return sweep(rows, 0.001);
}

/** The light rolled cuff. */
export function cuffGeometry(size: number): BufferGeometry {
  const rolled: Profile = [[31, -62], [33.6, -60.5], [34.2, -57], [33.8, -48], [33.2, -40], [32.2, -37], [30.6, -36.4], [29.4, -37.4], [28.4, -43], [27.6, -62]];
  return sweep(rolled.map(([r, x]) => [r * 1e-3 * size, x * 1e-3]), 0);
}
