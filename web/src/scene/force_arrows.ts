// Draws each force on the hand as an arrow from its contact point, with a length proportional to the force. Program's frame.

import { ConeGeometry, CylinderGeometry, Group, InstancedMesh, Matrix4, Quaternion, Vector3, type BufferGeometry } from 'three';
import type { ContactPointT } from '../protocol';
import { flat } from './materials';

const COLOR = '#2457E6';
const MOST = 32;
/** Weaker forces are not shown [N]. */
const WEAKEST_N = 0.05;
const LENGTH_PER_N = 0.015;
const SHORTEST_M = 0.012;
const LONGEST_M = 0.12;
const RADIUS_M = 0.0016;
const HEAD_M = 0.009;
const HEAD_RADIUS_M = 0.0042;

/** Start, direction and length of an arrow [m]. */
export interface Arrow { readonly from: Vector3; readonly along: Vector3; readonly length_m: number }

/** The strongest forces as arrows. */
export function arrowsOf(contacts: readonly ContactPointT[]): Arrow[] {
  const strong = contacts.flatMap(({ pointM, forceN }) => {
    const force_n = forceN ? Math.hypot(forceN.x, forceN.y, forceN.z) : 0;
    return pointM && forceN && force_n >= WEAKEST_N ? [{ pointM, forceN, force_n }] : [];
  }).sort((a, b) => b.force_n - a.force_n).slice(0, MOST);
  return strong.map(({ pointM, forceN, force_n }) => ({
    from: new Vector3(pointM.x, pointM.y, pointM.z), along: new Vector3(forceN.x, forceN.y, forceN.z).divideScalar(force_n),
    length_m: Math.min(LONGEST_M, Math.max(SHORTEST_M, LENGTH_PER_N * force_n)),
  }));
}

export class ForceArrows {
  readonly root = new Group();
  private readonly shafts = instances(new CylinderGeometry(RADIUS_M, RADIUS_M, 1, 8).translate(0, 0.5, 0));
  private readonly heads = instances(new ConeGeometry(HEAD_RADIUS_M, HEAD_M, 12).translate(0, HEAD_M / 2, 0));

  constructor() {
    this.root.add(this.shafts, this.heads);
  }

  take(contacts: readonly ContactPointT[]): void {
    const arrows = arrowsOf(contacts);
    const up = new Vector3(0, 1, 0);
    arrows.forEach(({ from, along, length_m }, i) => {
      const turn = new Quaternion().setFromUnitVectors(up, along);
      const shaft_m = length_m - HEAD_M;
      this.shafts.setMatrixAt(i, new Matrix4().compose(from, turn, new Vector3(1, shaft_m, 1)));
      this.heads.setMatrixAt(i, new Matrix4().compose(from.clone().addScaledVector(along, shaft_m), turn, new Vector3(1, 1, 1)));
    });
    for (const mesh of [this.shafts, this.heads]) {
      mesh.count = arrows.length;
      mesh.instanceMatrix.needsUpdate = true;
    }
  }
}

/** Arrows are drawn over the hand, which would hide them. */
function instances(geometry: BufferGeometry): InstancedMesh {
  const mesh = new InstancedMesh(geometry, flat(COLOR, { depthTest: false, transparent: true, opacity: 0.9 }), MOST);
  mesh.renderOrder = 11;
  mesh.frustumCulled = false;
  mesh.count = 0;
  return mesh;
}
