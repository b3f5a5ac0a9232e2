// The guest behind the counter: one flat card, drawn once for each drink, at the wall where neither bottle
// nor card of the page is in front of the face.

import { Mesh, Plane, PlaneGeometry, Ray, Vector3, type PerspectiveCamera, type Texture } from 'three';
import { turnOf, type CameraPlace } from '../../scene/camera';
import { flat } from '../../scene/materials';
import { drawGuest, poseOffset, SHEET_PX } from './guest_figure';
import { picture } from '../../scene/textures';
import type { Pose } from './serving';

/** Of the card, and how far it is from the row [m]: before the wall. */
const SIZE_M = 0.31;
const BEHIND_M = 0.56;
/** From old pose to new one, through nothing [s]. */
const FADE_S = 0.4;
/**
 * Where it may stand, as parts of the picture's width: not behind the hand at rest, and while it is served beside the
 * praise card (game.css), which lies on the side that has no arm.
 */
const LANDSCAPE = { right: [0.52, 0.68], left: [0.6, 0.85] } as const;
const SERVED = { right: LANDSCAPE.right, left: [0.12, 0.24] } as const;
const UPRIGHT = { right: [0.3, 0.6], left: [0.4, 0.7] } as const;

export class GuestView {
  readonly root = new Mesh(new PlaneGeometry(SIZE_M, SIZE_M), flat('#efe4d4', { transparent: true, opacity: 0, depthWrite: false }));
  private drawn = -1;
  private wanted = -1;
  private pose: Pose = 'waits';
  private served = false;
  /** Where it waits, and where it is served. */
  private readonly places = [new Vector3(), new Vector3()] as const;

  constructor() { this.root.visible = false; }

  /** Behind the counter, facing the picture as the room does. @param lift_m over what stands on it */
  place(camera: PerspectiveCamera, { right, counter_y, row_z }: CameraPlace, bottles: readonly Vector3[], lift_m = 0): void {
    const turn_rad = turnOf(right);
    const ahead = new Vector3(0, 0, 1).applyAxisAngle(new Vector3(0, 1, 0), turn_rad);
    const wall = new Plane().setFromNormalAndCoplanarPoint(ahead, new Vector3(0, counter_y, row_z).addScaledVector(ahead, -BEHIND_M));
    this.places.forEach((place, served) => {
      const at = atPlane(camera, freeAcross(camera, right, bottles, served === 1), wall);
      if (at) place.set(at.x, counter_y + SIZE_M / 2 + lift_m, at.z);
    });
    this.root.position.copy(this.places[Number(this.served)]);
    this.root.rotation.y = turn_rad;
  }

  get servedAt(): Vector3 { return this.places[1]; }

  /** @param guest which one: a number of its own for every drink; -1: nobody */
  update(guest: number, pose: Pose, served: boolean, dt_s: number): void {
    const material = this.root.material as ReturnType<typeof flat>;
    const same = guest === this.wanted && pose === this.pose && served === this.served && guest === this.drawn;
    const step = dt_s / (FADE_S / 2);
    if (!same && material.opacity > 0) material.opacity = Math.max(0, material.opacity - step);
    else if (!same) this.change(guest, pose, served);
    else material.opacity = Math.min(1, material.opacity + step);
    this.root.visible = this.drawn >= 0 && material.opacity > 0;
  }

  private change(guest: number, pose: Pose, served: boolean): void {
    const material = this.root.material as ReturnType<typeof flat>;
    if (guest >= 0 && guest !== this.drawn) {
      material.map?.dispose();
      const had = material.map !== null;
      material.map = sheet(guest);
      if (!had) material.needsUpdate = true;
    }
    this.drawn = this.wanted = guest;
    this.pose = pose;
    this.served = served;
    this.root.position.copy(this.places[Number(served)]);
    material.map?.offset.set(poseOffset(pose), 0);
  }
}

function sheet(guest: number): Texture {
  const texture = picture(SHEET_PX.width, SHEET_PX.height, (pen) => drawGuest(pen, guest));
  texture.repeat.set(SHEET_PX.height / SHEET_PX.width, 1);
  return texture;
}

/** The part of the picture's width that is farthest from every bottle. */
export function freeAcross(camera: PerspectiveCamera, right: boolean, bottles: readonly Vector3[], served = false): number {
  const [from, to] = (camera.aspect <= 1.1 ? UPRIGHT : served ? SERVED : LANDSCAPE)[right ? 'right' : 'left'];
  const taken = bottles.map((bottle) => bottle.clone().project(camera).x * 0.5 + 0.5);
  const places = Array.from({ length: 25 }, (_, i) => from + (to - from) * i / 24);
  // Half a picture away is as good as any farther.
  const room = (place: number) => Math.min(0.2, ...taken.map((x) => Math.abs(x - place)));
  return places.reduce((best, place) => room(place) > room(best) + 1e-9 ? place : best);
}

/** Where the vertical line of the picture meets an upright plane. */
function atPlane(camera: PerspectiveCamera, across: number, plane: Plane): Vector3 | null {
  const from = camera.position.clone(), way = new Vector3(2 * across - 1, 0, 0.5).unproject(camera).sub(from).normalize();
  return new Ray(from, way).intersectPlane(plane, new Vector3());
}
