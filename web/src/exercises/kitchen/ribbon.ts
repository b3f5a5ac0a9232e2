// A band along a path that turns its flat side to the camera: arrows and rings of the cues.
import { BufferAttribute, BufferGeometry, DoubleSide, Group, Mesh, Vector3 } from 'three';
import { flat } from '../../scene/materials';

const AMBER = '#ffb938';
const INK = '#1c1410';
/** Width of the dark edge around it, and its distance behind the band [m]. */
const EDGE_M = 0.0026;
const BEHIND_M = 0.001;

/** Half width at a point of the path. @param left_m remaining length to the end */
export type HalfWidth = (left_m: number, edge_m: number) => number;

function band(points: number, color: string, above: boolean): Mesh<BufferGeometry> {
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(new Float32Array(6 * points), 3));
  geometry.setIndex(Array.from({ length: points - 1 }, (_, i) => [2 * i, 2 * i + 1, 2 * i + 2, 2 * i + 2, 2 * i + 1, 2 * i + 3]).flat());
  const mesh = new Mesh(geometry, flat(color, { side: DoubleSide, depthTest: !above, transparent: above }));
  mesh.renderOrder = above ? 10 : 0;
  mesh.frustumCulled = false;
  return mesh;
}

export class Ribbon {
  readonly root = new Group();
  private readonly bands: readonly (readonly [Mesh<BufferGeometry>, number])[];

  /** @param above drawn over the hand */
  constructor(private readonly points: number, { color = AMBER, above = false } = {}) {
    this.bands = [[band(points, INK, above), EDGE_M], [band(points, color, above), 0]];
    this.bands[1]![0].renderOrder += 1;
    this.root.add(...this.bands.map(([mesh]) => mesh));
  }

  /** @param path as many points as given to the constructor @param share drawn share of the path, 0 .. 1 */
  lay(path: readonly Vector3[], eye: Vector3, half: HalfWidth, share = 1): void {
    const left = new Float64Array(this.points);
    for (let i = this.points - 2; i >= 0; i--) left[i] = left[i + 1]! + path[i]!.distanceTo(path[i + 1]!);
    for (const [mesh, edge_m] of this.bands) {
      const at = mesh.geometry.attributes.position as BufferAttribute;
      path.forEach((p, i) => {
        const way = path[Math.min(i + 1, this.points - 1)]!.clone().sub(path[Math.max(i - 1, 0)]!), sight = p.clone().sub(eye).normalize();
        const aside = way.cross(sight).normalize().multiplyScalar(half(left[i]!, edge_m)), middle = p.clone().addScaledVector(sight, edge_m > 0 ? BEHIND_M : 0);
        at.setXYZ(2 * i, middle.x + aside.x, middle.y + aside.y, middle.z + aside.z);
        at.setXYZ(2 * i + 1, middle.x - aside.x, middle.y - aside.y, middle.z - aside.z);
      });
      at.needsUpdate = true;
      mesh.geometry.setDrawRange(0, 6 * Math.round(share * (this.points - 1)));
    }
  }
}
