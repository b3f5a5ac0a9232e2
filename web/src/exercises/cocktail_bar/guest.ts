// The guest behind the counter: one figure, made once for each drink, at a place where neither a bottle nor a card of
// the page covers the face.

import {
  BufferGeometry, Color, Group, Mesh, MeshBasicMaterial, Plane, Ray, Vector3, type BufferAttribute, type Material, type PerspectiveCamera,
} from 'three';
import { turnOf, type CameraPlace } from '../../scene/camera';
import { surface, type Finish } from '../../scene/materials';
import type { Quality } from '../../scene/quality';
import { counterEnd, placeCounterEnd } from './counter_end';
import { makeFigure, STUFFS, type Figure, type Stuff } from './guest_figure';
import { smooth, type Shape } from './parametric_mesh';
import type { Pose } from './serving';

/** Distance of its middle from the row, distance of the wall, and end of the counter before it [m]. */
const BEHIND_M = 0.46;
const WALL_M = 0.585;
const COUNTER_END_M = 0.414;
/** Time to fade a guest out and in at another place, and to change from one pose to the next [s]. */
const FADE_S = 0.4;
const MOVE_S = 0.6;
/** Time budget per frame for making a figure [ms], so that the page stays responsive. */
const MAKING_MS = 4;
const FINENESS: Readonly<Record<Quality, number>> = { high: 1, low: 0.5 };
/** In high quality the wall's lamps are near and would overexpose it. */
const SHARE_OF_LIGHT: Readonly<Record<Quality, number>> = { high: 0.6, low: 1 };
/** Finishes of skin and cloth: as the player's own, with less gloss so near the lamps. */
const FINISHES: Readonly<Record<Stuff, Finish>> = {
  skin: { roughness: 0.62, sheen: 0.2, sheenRoughness: 0.5, sheenColor: new Color('#ffb59a'), specularIntensity: 0.42 },
  cloth: { roughness: 0.95, sheen: 0.12, sheenRoughness: 0.6, sheenColor: new Color('#dfe6ea') },
  gloss: { roughness: 0.2, clearcoat: 0.6, clearcoatRoughness: 0.2 },
};
/**
 * Allowed places, as parts of the picture's width: a waiting guest is not behind the arm, and a served one is beside the
 * praise card (game.css), which is on the side without the arm.
 */
const LANDSCAPE = { right: [0.38, 0.68], left: [0.5, 0.85] } as const;
const SERVED = { right: [0.48, 0.68], left: [0.12, 0.24] } as const;
const UPRIGHT = { right: [0.18, 0.6], left: [0.82, 0.4] } as const;

/** One material of the guest, and a depth prepass that hides its far side while it fades. */
class Layer {
  readonly mesh: Mesh<BufferGeometry, Material>;
  readonly veil: Mesh<BufferGeometry>;

  constructor(quality: Quality, finish: Finish) {
    const material = surface(quality, { ...finish, color: new Color().setScalar(SHARE_OF_LIGHT[quality]), transparent: true });
    material.vertexColors = true;
    this.mesh = new Mesh(new BufferGeometry(), material);
    this.mesh.castShadow = this.mesh.receiveShadow = true;
    this.veil = new Mesh(this.mesh.geometry, new MeshBasicMaterial({ colorWrite: false }));
    this.veil.renderOrder = -1;
  }

  wear(geometry: BufferGeometry): void {
    this.mesh.geometry.dispose();
    this.mesh.geometry = this.veil.geometry = geometry;
  }

  fade(opacity: number): void {
    this.mesh.material.opacity = opacity;
    this.mesh.castShadow = opacity > 0.5;
    this.veil.visible = opacity < 1;
  }
}

export class GuestView {
  readonly root = new Group();
  readonly counterEnd = counterEnd(WALL_M - COUNTER_END_M);
  private readonly layers: Readonly<Record<Stuff, Layer>>;
  private figure: Figure | undefined;
  private making: { readonly guest: number; readonly steps: Generator<undefined, Figure>; figure?: Figure } | undefined;
  private from: Readonly<Record<Stuff, Shape>> | undefined;
  private moved = 1;           // progress from `from` to the pose
  private opacity = 0;
  private drawn = -1;
  private pose: Pose = 'waits';
  private served = false;
  /** The place for waiting, and the place for being served. */
  private readonly places = [new Vector3(), new Vector3()] as const;

  constructor(private readonly quality: Quality) {
    this.layers = { skin: new Layer(quality, FINISHES.skin), cloth: new Layer(quality, FINISHES.cloth), gloss: new Layer(quality, FINISHES.gloss) };
    for (const { mesh, veil } of Object.values(this.layers)) this.root.add(mesh, veil);
    this.root.visible = false;
  }

  /** Places it behind the counter, facing the camera as the room does. @param lift_m height over objects on the counter */
  place(camera: PerspectiveCamera, { right, counter_y, row_z }: CameraPlace, bottles: readonly Vector3[], lift_m = 0): void {
    const turn_rad = turnOf(right);
    const ahead = new Vector3(0, 0, 1).applyAxisAngle(new Vector3(0, 1, 0), turn_rad), row = new Vector3(0, counter_y, row_z);
    const plane = new Plane().setFromNormalAndCoplanarPoint(ahead, row.clone().addScaledVector(ahead, -BEHIND_M));
    this.places.forEach((place, served) => {
      const at = atPlane(camera, freeAcross(camera, right, bottles, served === 1), plane);
      if (at) place.set(at.x, counter_y + lift_m, at.z);
    });
    this.root.position.copy(this.places[Number(this.served)]);
    this.root.rotation.y = turn_rad;
    placeCounterEnd(this.counterEnd, row.addScaledVector(ahead, -COUNTER_END_M), turn_rad);
  }

  get servedAt(): Vector3 { return this.places[1]; }

  /**
   * @param guest number of the guest, one for every drink; -1: none
   * @param drink colours of its layers, the lowest first @param still no motion, poses change at once
   */
  update(guest: number, drink: readonly string[], pose: Pose, served: boolean, dt_s: number, still: boolean): void {
    const stays = guest === this.drawn && served === this.served, step = dt_s / (FADE_S / 2);
    if (stays) this.opacity = Math.min(1, this.opacity + step);
    else {
      this.opacity = Math.max(0, this.opacity - step);
      if (this.isMade(guest, drink) && this.opacity === 0) this.change(guest, pose, served);
    }
    if (stays && pose !== this.pose) this.take(pose);
    if (this.moved < 1) this.move(still ? 1 : Math.min(1, this.moved + dt_s / MOVE_S));
    for (const stuff of STUFFS) this.layers[stuff].fade(this.opacity);
    this.root.visible = this.figure !== undefined && this.opacity > 0;
  }

  /** Continues making a guest, while the one before it leaves. */
  private isMade(guest: number, drink: readonly string[]): boolean {
    if (guest < 0 || guest === this.drawn) return true;
    if (this.making?.guest !== guest) this.making = { guest, steps: makeFigure(guest, drink.map((color) => new Color(color)), FINENESS[this.quality]) };
    const { making } = this, begun_ms = performance.now();
    while (!making.figure && performance.now() - begun_ms < MAKING_MS) {
      const made = making.steps.next();
      if (made.done) making.figure = made.value;
    }
    return making.figure !== undefined;
  }

  /** While invisible: changes to another guest, or to another place. */
  private change(guest: number, pose: Pose, served: boolean): void {
    if (guest !== this.drawn) {
      this.figure = this.making?.figure;
      this.making = undefined;
      for (const stuff of STUFFS) if (this.figure) this.layers[stuff].wear(this.figure.geometry[stuff]);
    }
    this.drawn = guest;
    this.served = served;
    this.root.position.copy(this.places[Number(served)]);
    this.take(pose);
    this.move(1);
  }

  private take(pose: Pose): void {
    this.pose = pose;
    this.moved = 0;
    const { figure } = this;
    if (!figure) return;
    const now = (stuff: Stuff): Shape => {
      const { position, normal } = figure.geometry[stuff].attributes;
      return { position: Float32Array.from(position.array), normal: Float32Array.from(normal.array) };
    };
    this.from = { skin: now('skin'), cloth: now('cloth'), gloss: now('gloss') };
  }

  private move(moved: number): void {
    this.moved = moved;
    const { figure, from, pose } = this, share = smooth(0, 1, moved);
    if (!figure || !from) return;
    for (const stuff of STUFFS) {
      for (const name of ['position', 'normal'] as const) {
        const attribute = figure.geometry[stuff].attributes[name] as BufferAttribute, to = attribute.array, a = from[stuff][name], b = figure.poses[pose][stuff][name];
        for (let i = 0; i < to.length; i++) to[i] = a[i] + (b[i] - a[i]) * share;
        attribute.needsUpdate = true;
      }
    }
  }
}

/** The part of the picture's width that is farthest from every bottle. */
export function freeAcross(camera: PerspectiveCamera, right: boolean, bottles: readonly Vector3[], served = false): number {
  const [from, to] = (camera.aspect <= 1.1 ? UPRIGHT : served ? SERVED : LANDSCAPE)[right ? 'right' : 'left'];
  const taken = bottles.map((bottle) => bottle.clone().project(camera).x * 0.5 + 0.5);
  const places = Array.from({ length: 25 }, (_, i) => from + (to - from) * i / 24);
  // Distances beyond this count equally.
  const room = (place: number) => Math.min(0.2, ...taken.map((x) => Math.abs(x - place)));
  return places.reduce((best, place) => room(place) > room(best) + 1e-9 ? place : best);
}

/** Intersection of a vertical line of the picture with a vertical plane. */
function atPlane(camera: PerspectiveCamera, across: number, plane: Plane): Vector3 | null {
  const from = camera.position.clone(), way = new Vector3(2 * across - 1, 0, 0.5).unproject(camera).sub(from).normalize();
  return new Ray(from, way).intersectPlane(plane, new Vector3());
}
