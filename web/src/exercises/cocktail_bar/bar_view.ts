// The cocktail bar in the picture: dispensers, signs, glass, stream, guest.

import { Group, Vector3, type PerspectiveCamera, type SpotLight } from 'three';
import { RunState, ShapeType, type BodyT, type PoseT, type SceneT, type WorldStateT } from '../../protocol';
import type { SkinUniforms } from '../../hand/skin_shader';
import { DEFAULT_PLACE, type CameraPlace } from '../../scene/camera';
import { quaternionToThree, toThree } from '../../scene/frames';
import type { Quality } from '../../scene/quality';
import type { Sign } from '../../scene/sign';
import type { Anchors, ExerciseView, ViewOf } from '../exercise_view';
import { ExerciseValues } from '../values';
import { barOf, Stage, type Bar } from './bar';
import { BubblesView } from './bubbles';
import { makeDispenser, makeSign, type Shell } from './dispenser';
import { FLOOR_M, GlassView, innerRadius, rimHeight } from './glass';
import { GuestView } from './guest';
import { nameOf } from './i18n';
import { layersOf, lineHeight, surfaceHeight } from './layers';
import { liquidLook } from './liquids';
import { bottlesOf, outlineOf } from './outline';
import { ServingClock, type Serving } from './serving';
import { makeShelf } from './shelf';
import { StreamView } from './stream';

/** Position of signs: above the rail, and in front of it [m]. */
const SIGN_OVER_M = 0.012;
const SIGN_BEFORE_M = 0.014;
/** The finished glass: its distance in front of the guest, and its way out of the picture [m]. */
const GLASS_BEFORE_GUEST_M = 0.15;
const GLASS_AWAY_M = 0.8;
/** The guest stands higher by this share of a shelf's height: the chest is visible over it, and the face below the signs. */
const SEEN_OVER_SHELF = 0.42;

/** Air returns within this time into a bottle that nobody holds [s]. */
const AIR_S = 0.3;

interface HungDispenser { readonly body: number; readonly root: Group; readonly shell: Shell; readonly sign: Sign; pressed_l: number; keeps: number }

/** Steps of a drink whose poured amounts the program reports. */
const STEPS = [0, 1, 2, 3, 4, 5, 6, 7] as const;

export class BarView implements ExerciseView {
  readonly root = new Group();
  private readonly values: ExerciseValues;
  private readonly hung: HungDispenser[];
  private readonly glass: GlassView;
  private readonly stream: StreamView;
  private readonly air = new BubblesView();
  private readonly guest: GuestView;
  private readonly serving = new ServingClock();
  private readonly still = matchMedia('(prefers-reduced-motion: reduce)');
  private readonly glassBody: number;
  private readonly railBody: number;
  private line_m: number | undefined;
  private target = -1;
  private bottles: Vector3[] = [];   // positions in three.js's frame
  private shelf_m = 0;               // height of objects on the counter that hide what is behind them
  private readonly shelves: { readonly body: number; readonly root: Group }[] = [];

  constructor(private readonly bar: Bar, private readonly scene: SceneT, quality: Quality) {
    const bodyIndex = (name: string) => scene.bodies.findIndex((b) => String(b.name) === name);
    this.values = new ExerciseValues(scene.valueNames);
    this.glassBody = bodyIndex(bar.glass.body);
    this.railBody = bodyIndex('rail');
    this.glass = new GlassView(bar.glass, quality);
    this.stream = new StreamView(quality);
    this.guest = new GuestView(quality);
    this.root.add(this.glass.root, this.stream.root, this.air.root, this.guest.root, this.guest.counterEnd);
    scene.bodies.forEach((body, i) => {
      const half = body.shapes[0]?.halfExtentsM;
      if (!half || !this.isShelf(body)) return;
      const root = makeShelf(new Vector3(half.y, half.z, half.x), quality);   // in three.js's frame
      this.root.add(root);
      this.shelves.push({ body: i, root });
    });
    this.hung = bar.dispensers.map((d) => {
      const { root, shell } = makeDispenser(d, quality, bar.rail_z_m - d.grip_m[2]);
      const sign = makeSign(d.liquid);
      this.root.add(root, sign.root);
      return { body: bodyIndex(d.body), root, shell, sign, pressed_l: 0, keeps: 0 };
    });
  }

  /** Whether a body is a box fixed on the counter that does not belong to the counter itself. */
  private isShelf({ name, fixed, shapes }: BodyT): boolean {
    return fixed && shapes.length === 1 && shapes[0].type === ShapeType.Box && !this.isPart(String(name));
  }

  private isPart(name: string): boolean {
    return ['counter', 'rail', this.bar.glass.body].includes(name) || this.bar.dispensers.some((d) => d.body === name);
  }

  get rail_m(): number { return this.bar.rail_z_m - this.bar.counter_z_m; }

  owns(name: string): boolean {
    return this.isPart(name) || this.shelves.some(({ body }) => String(this.scene.bodies[body].name) === name);
  }

  placement(state: WorldStateT | undefined): { place: CameraPlace; outline: Vector3[] } {
    const { bar, scene } = this;
    this.bottles = state ? bottlesOf(bar, scene, state) : [];
    const row_z = this.bottles[0]?.z ?? DEFAULT_PLACE.row_z;
    this.shelf_m = state ? this.shelfOf(state) : 0;
    return { place: { right: scene.rightHand, counter_y: bar.counter_z_m, row_z }, outline: state ? outlineOf(bar, scene, state) : [] };
  }

  yieldTo(skin: SkinUniforms): void {
    for (const { shell, root, keeps } of this.hung) shell.yieldTo(skin, root, keeps);
  }

  update(state: WorldStateT, eye: Vector3, dt_s: number): void {
    this.target = this.values.get(state, 'target_dispenser');
    const stage = this.values.get(state, 'stage'), done = stage === Stage.DrinkDone || stage === Stage.LevelDone;
    this.placeDispensers(state, eye, done);
    this.showShells(state, eye, dt_s);
    const poured = STEPS.map((i) => this.values.get(state, `layer_l/${i}`)), drink = this.bar.drinks[this.values.get(state, 'drink')];
    const rim = rimHeight(this.bar.glass), rise = this.bar.glass.m_per_l, step = this.values.get(state, 'step');
    const liquids = drink?.steps.map((s) => s.liquid) ?? [];
    this.line_m = done || !drink ? undefined : lineHeight(poured, step, this.values.get(state, 'asked_l'), rise, rim);
    const still = this.still.matches, inUse = stage === Stage.Squeeze || stage === Stage.Pour || stage === Stage.LetGo || stage === Stage.Breathe;
    const serving = this.serving.look(done, inUse, dt_s, still || this.shelf_m > 0);
    this.glass.update(serving.empty ? [] : layersOf(poured, liquids, rise, rim), this.line_m, done && !serving.empty);
    for (const shelf of this.shelves) {
      const at = state.bodies[shelf.body];
      if (at) place(shelf.root, at, 0);
    }
    const body = state.bodies[this.glassBody];
    if (body) place(this.glass.root, body, -this.bar.glass.height_m / 2);
    const guest = this.scene.level * this.bar.drinks.length + this.values.get(state, 'drink');
    this.guest.update(guest, liquids.map((liquid) => liquidLook(liquid).color), serving.pose, done, dt_s, still);
    this.serve(serving);
    // While the glass is drawn elsewhere, a stream into it would hit the counter: it is hidden.
    const away = serving.toMiddle > 0 || serving.away > 0 || serving.seen < 1;
    this.stream.root.visible = !away;
    this.updateStream(state, away ? 0 : this.values.get(state, 'flow_l_s'), surfaceHeight(poured, rise, rim), dt_s);
  }

  /** The line's right end, and the current bottle. */
  anchors(camera: PerspectiveCamera): Anchors {
    const right = new Vector3(1, 0, 0).applyQuaternion(camera.quaternion).setY(0).normalize();
    const up = (h: number) => this.glass.root.position.clone().add(new Vector3(0, h, 0));
    const line = this.line_m === undefined ? undefined
      : up(this.line_m + FLOOR_M).addScaledVector(right, innerRadius(this.bar.glass, this.line_m + FLOOR_M) + 0.003);
    return { goal: line, target: this.hung[this.target]?.root.position.clone() };
  }

  lightTarget(light: SpotLight, dt_s: number): void {
    const at = this.hung[this.target]?.root.position;
    if (!at) return;
    const share = 1 - Math.exp(-dt_s / 0.15), x = light.target.position.x + (at.x - light.target.position.x) * share;
    light.target.position.x = light.position.x = x;
  }

  placeBehind(camera: PerspectiveCamera, place: CameraPlace): void {
    this.guest.place(camera, place, this.bottles, SEEN_OVER_SHELF * this.shelf_m);
  }

  /** Height over the counter of the bodies fixed on it. */
  private shelfOf(state: WorldStateT): number {
    const tops_m = this.shelves.map(({ body }) => {
      const half_m = this.scene.bodies[body].shapes[0]?.halfExtentsM?.z, z_m = state.bodies[body]?.positionM?.z;
      return half_m === undefined || z_m === undefined ? 0 : z_m + half_m - this.bar.counter_z_m;
    });
    return Math.max(0, ...tops_m);
  }

  /** Moves the drawn glass to the guest and away; the program's glass stays. */
  private serve({ toMiddle, away, seen }: Serving): void {
    const glass = this.glass.root, facing = new Vector3(0, 0, 1).applyQuaternion(this.guest.root.quaternion);
    const middle = this.guest.servedAt.clone().addScaledVector(facing, GLASS_BEFORE_GUEST_M).setY(glass.position.y);
    glass.position.lerp(middle, toMiddle);
    glass.position.addScaledVector(new Vector3(-1, 0, 0).applyQuaternion(this.guest.root.quaternion), GLASS_AWAY_M * away);
    this.glass.fade(seen);
  }

  private placeDispensers(state: WorldStateT, eye: Vector3, done: boolean): void {
    const slid = this.values.get(state, 'row_y_m') + (this.bottles[0]?.x ?? 0);
    this.hung.forEach((h, i) => {
      const body = state.bodies[h.body], d = this.bar.dispensers[i];
      if (!body) return;
      place(h.root, body, 0);
      const home = this.bottles[i] ?? h.root.position;
      // A free dispenser moves away; its sign stays on the rail, and slides with the row.
      const x = d.free ? home.x - slid : h.root.position.x;
      // On the rail, wherever that is, and over the dispenser as seen from the camera.
      const z = (this.railZ(state) ?? home.z) + SIGN_BEFORE_M, further = (eye.z - z) / (eye.z - home.z);
      h.sign.root.position.set(eye.x + (x - eye.x) * further, this.bar.rail_z_m + SIGN_OVER_M, z);
      const running = state.runState === RunState.Rendering || state.runState === RunState.Disarmed;
      h.sign.show(nameOf('liquid', d.liquid), i === this.target && !done && running);
    });
  }

  /** Shows the deformation of the shells, and the air that returns into them. */
  private showShells(state: WorldStateT, eye: Vector3, dt_s: number): void {
    const engaged = this.values.get(state, 'engaged_dispenser', -1), reported_l = this.values.get(state, 'pressed_l');
    this.hung.forEach((h, i) => {
      const { liquid } = this.bar.dispensers[i], before_l = h.pressed_l;
      h.pressed_l = i === engaged ? reported_l : before_l * Math.exp(-dt_s / AIR_S);
      h.keeps = before_l > 0 ? Math.min(1, h.pressed_l / before_l) : 0;
      h.shell.show(h.pressed_l, this.values.get(state, `left_l/${liquid}`, 1) === 0);
      if (!this.still.matches) this.air.take(this.bar.dispensers[i], h.root, eye, before_l - h.pressed_l);
    });
    this.air.advance(dt_s);
  }

  railZ(state: WorldStateT): number | undefined {
    const at = state.bodies[this.railBody]?.positionM;
    return at ? toThree(at).z : undefined;
  }

  private updateStream(state: WorldStateT, flow: number, surface_m: number, dt_s: number): void {
    const engaged = this.values.get(state, 'engaged_dispenser');
    const which = engaged >= 0 ? engaged : this.target, h = this.hung[which], d = this.bar.dispensers[which];
    if (!h || !d) return;
    const tip = toThree({ x: d.nozzle_m[0], y: d.nozzle_m[1], z: d.nozzle_m[2] }).applyQuaternion(h.root.quaternion).add(h.root.position);
    const over = this.values.get(state, 'over_glass') > 0.5;
    const floor = over ? this.glass.root.position.y + FLOOR_M + surface_m : this.bar.counter_z_m;
    this.stream.update({
      liquid: d.liquid, viscosity_pa_s: this.bar.viscosities_pa_s[d.liquid], flow_l_s: flow, from: tip, floor_m: floor, overGlass: over,
      counter_m: this.bar.counter_z_m, spilt_l: this.values.get(state, 'spilt_l'),
    }, dt_s);
  }
}

/** @param lift offset of the model's origin along the body's vertical axis [m] */
function place(root: Group, pose: PoseT, lift: number): void {
  if (!pose.positionM || !pose.orientationXyzw) return;
  quaternionToThree(pose.orientationXyzw, root.quaternion);
  toThree(pose.positionM, root.position).add(new Vector3(0, lift, 0).applyQuaternion(root.quaternion));
}

export const viewOf: ViewOf = (scene, quality) => {
  const bar = barOf(scene);
  return bar && new BarView(bar, scene, quality);
};
