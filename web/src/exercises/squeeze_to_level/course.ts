// The balloon's course in the window: two ribbons that bound the band, the held share of its time, and chevrons.
import { DoubleSide, Group, Mesh, PlaneGeometry, Shape, ShapeGeometry, type Material } from 'three';
import { flat } from '../../scene/materials';
import type { Flight } from './flight';

/** The basket's course: lowest and highest point over the counter, and width of the ribbons [m]. */
export const COURSE = { low_m: 0.105, high_m: 0.44, wide_m: 0.26 } as const;
const RIBBON_M = 0.004;
const EDGE_M = 0.0085;
/** Size of the chevrons beside the basket [m]. */
const CHEVRON = { wide_m: 0.034, tall_m: 0.017, thick_m: 0.0075, apart_m: 0.02, aside_m: 0.07 } as const;

/** Height over the counter for 0 .. 1 of the course [m]. */
export const overCounter = (height: number): number => COURSE.low_m + (COURSE.high_m - COURSE.low_m) * height;

const plane = (wide: number, tall: number, material: Material, z: number): Mesh => {
  const mesh = new Mesh(new PlaneGeometry(wide, tall), material);
  mesh.position.z = z;
  return mesh;
};

function ribbon(): Group {
  const root = new Group();
  root.add(plane(COURSE.wide_m + 0.004, EDGE_M, flat('#1c1410'), 0), plane(COURSE.wide_m, RIBBON_M, flat('#ffffff'), 0.0005));
  return root;
}

/** A chevron that points up. @param grow width of its edge [m] */
function chevron(color: string, grow: number): Mesh {
  const { wide_m, tall_m, thick_m } = CHEVRON, half = wide_m / 2 + grow, shape = new Shape();
  shape.moveTo(-half, -grow);
  shape.lineTo(0, tall_m + 0.4 * grow);
  shape.lineTo(half, -grow);
  shape.lineTo(half, -thick_m - 1.4 * grow);
  shape.lineTo(0, tall_m - thick_m - 1.6 * grow);
  shape.lineTo(-half, -thick_m - 1.4 * grow);
  const mesh = new Mesh(new ShapeGeometry(shape), flat(color, { side: DoubleSide }));
  mesh.position.z = grow > 0 ? 0 : 0.0005;
  return mesh;
}

export class Course {
  readonly root = new Group();
  private readonly low = ribbon();
  private readonly high = ribbon();
  private readonly goal = plane(1, 1, flat('#fff4d8', { transparent: true, opacity: 0.34, depthWrite: false }), -0.002);
  private readonly held = plane(1, 1, flat('#ffc24a', { transparent: true, opacity: 0.78, depthWrite: false }), -0.001);
  private readonly band = new Group();
  private readonly chevrons = new Group();

  constructor() {
    this.band.add(this.goal, this.held, this.low, this.high);
    for (let i = 0; i < 3; i++) {
      const one = new Group();
      one.add(chevron('#1c1410', 0.003), chevron('#ffb938', 0));
      one.position.y = (i - 1) * CHEVRON.apart_m;
      this.chevrons.add(one);
    }
    this.root.add(this.band, this.chevrons);
  }

  update({ band, held, cue, height }: Flight): void {
    this.band.visible = band !== null;
    if (band) {
      const low = overCounter(band.low), high = overCounter(band.high), tall = high - low, { wide_m } = COURSE;
      this.low.position.y = low;
      this.high.position.y = high;
      for (const [mesh, share] of [[this.goal, 1], [this.held, held]] as const) {
        mesh.visible = share > 0;
        mesh.scale.set(wide_m * share, tall, 1);
        mesh.position.set(-wide_m * (1 - share) / 2, low + tall / 2, mesh.position.z);
      }
    }
    this.chevrons.visible = cue === 'up' || cue === 'down' || (cue === 'open' && height > 0.02);
    this.chevrons.rotation.z = cue === 'up' ? 0 : Math.PI;
    this.chevrons.position.set(CHEVRON.aside_m, overCounter(height), 0);
  }
}
