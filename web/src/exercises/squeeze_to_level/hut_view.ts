// Squeezing to a level in the picture: the handle, and the balloon over the valley that shows the squeeze.
import { Group, Vector3, type PerspectiveCamera, type SpotLight } from 'three';
import type { SkinUniforms } from '../../hand/skin_shader';
import type { SceneT, WorldStateT } from '../../protocol';
import { DEFAULT_PLACE, turnOf, type CameraPlace } from '../../scene/camera';
import { quaternionToThree, toThree } from '../../scene/frames';
import { outlineOfScene } from '../../scene/outline';
import type { Quality } from '../../scene/quality';
import { Sign } from '../../scene/sign';
import type { Setting } from '../../scene/stage';
import { Dent, pressingOn } from '../../scene/dent';
import type { Anchors, ExerciseView, ViewOf } from '../exercise_view';
import { ExerciseValues } from '../values';
import { BASKET_Y, makeBalloon, makeFlame } from './balloon';
import { Course, overCounter } from './course';
import { Fleet } from './fleet';
import { flightOf } from './flight';
import { gripOf, type Grip } from './grip';
import { makeHandle } from './handle';
import { hut, POST_X_M, WINDOW } from './hut';
import { text } from './i18n';
import { Lantern } from './lanterns';
import { holdOf } from './play';

/** The balloon's course: middle of its pane, relative to the stage's middle, and distance in front of the window [m]. */
const COURSE_X_M = POST_X_M - WINDOW.pane_m / 2;
const COURSE_Z_M = -0.56;
const BALLOON_M = 0.036;
const LANTERN = { apart_m: 0.085, z_m: -0.55 } as const;
/** Size and offset of the sign over the handle [m]. */
const SIGN = { wide_m: 0.15, over_m: 0.045, before_m: 0.02 } as const;
/** Time constant of the balloon, which follows the squeeze slowly [s]. */
const FOLLOW_S = 0.12;

export class HutView implements ExerciseView {
  readonly root = new Group();
  readonly rail_m = undefined;
  readonly setting: Setting;
  private readonly values: ExerciseValues;
  private readonly hold_s: number;
  private readonly handle: Group;
  private readonly dent: Dent | undefined;
  private readonly outside = new Group();   // turned like the room
  private readonly balloon: Group;
  private readonly flame = makeFlame();
  private readonly course = new Course();
  private readonly fleet: Fleet;
  private readonly lanterns: Lantern[] = [];
  private readonly sign = new Sign(SIGN.wide_m);
  private readonly side: 1 | -1;
  private readonly still = matchMedia('(prefers-reduced-motion: reduce)');
  private height = 0;
  private burns = 0;

  constructor(private readonly grip: Grip, private readonly scene: SceneT, private readonly quality: Quality) {
    this.side = scene.rightHand ? 1 : -1;
    this.setting = hut(scene.rightHand);
    this.values = new ExerciseValues(scene.valueNames);
    this.hold_s = holdOf(scene);
    const { root, side } = makeHandle(grip, quality);
    this.handle = root;
    // Plain materials need no dent, as a finger is at most a few millimetres inside.
    this.dent = quality === 'high' ? new Dent(side, grip.radius_m) : undefined;
    this.balloon = makeBalloon(BALLOON_M, { main: '#C8452F', stripe: '#FFE3A3' }, quality);
    this.balloon.add(this.flame);
    this.fleet = new Fleet(this.side, quality);
    this.fleet.root.position.z = COURSE_Z_M - 0.02;
    this.course.root.position.set(this.side * COURSE_X_M, 0, COURSE_Z_M);
    this.outside.add(this.balloon, this.course.root, this.fleet.root);
    this.root.add(this.handle, this.sign.root, this.outside);
  }

  owns(name: string): boolean {
    return [this.grip.body, this.grip.counter].some((body) => String(this.scene.bodies[body]?.name ?? '') === name);
  }

  placement(state: WorldStateT | undefined): { place: CameraPlace; outline: Vector3[] } {
    const { scene, grip } = this, counter = state?.bodies[grip.counter]?.positionM, at = state?.bodies[grip.body]?.positionM;
    const half_m = scene.bodies[grip.counter]?.shapes[0]?.halfExtentsM?.z ?? 0;
    const place = { right: scene.rightHand, counter_y: counter ? counter.z + half_m : DEFAULT_PLACE.counter_y, row_z: at ? -at.x : DEFAULT_PLACE.row_z };
    return { place, outline: outlineOfScene(scene, state) };
  }

  placeBehind(_camera: PerspectiveCamera, { right, counter_y, row_z }: CameraPlace): void {
    this.outside.position.set(0, counter_y, row_z);
    this.outside.rotation.y = turnOf(right);
  }

  update(state: WorldStateT, eye: Vector3, dt_s: number): void {
    const flight = flightOf(this.values, state, this.hold_s);
    this.placeHandle(state, eye);
    this.sign.show(flight.cue === 'open' ? text('sign.open') : text('sign.grip'), flight.cue === 'grip' || flight.cue === 'open');
    this.sign.root.visible = flight.cue !== 'none';
    const follow = dt_s > 0 ? 1 - Math.exp(-dt_s / FOLLOW_S) : 0;
    this.height += (flight.height - this.height) * follow;
    this.burns += (flight.flame - this.burns) * follow;
    this.flame.visible = this.burns > 0.02;
    this.flame.scale.set(0.6 + 0.4 * this.burns, Math.max(this.burns, 0.02), 0.6 + 0.4 * this.burns);
    // The basket is the part between the ribbons.
    this.balloon.position.set(this.side * COURSE_X_M, overCounter(this.height) - BASKET_Y * BALLOON_M, COURSE_Z_M + 0.03);
    this.course.update({ ...flight, height: this.height });
    this.fleet.update(flight.cue === 'none' && flight.bands > 0, this.still.matches, dt_s);
    this.light(flight.cue === 'none' ? flight.bands : flight.lit, flight.bands, dt_s);
  }

  yieldTo(skin: SkinUniforms): void { this.dent?.update(pressingOn(this.handle, skin, this.grip.radius_m)); }

  lightTarget(light: SpotLight): void { light.target.position.x = light.position.x = this.handle.position.x; }

  railZ(): undefined { return undefined; }

  anchors(): Anchors { return { goal: undefined, target: this.handle.position.clone() }; }

  private placeHandle(state: WorldStateT, eye: Vector3): void {
    const at = state.bodies[this.grip.body];
    if (!at?.positionM || !at.orientationXyzw) return;
    toThree(at.positionM, this.handle.position);
    quaternionToThree(at.orientationXyzw, this.handle.quaternion);
    // Over the handle as seen from the camera.
    const top = this.handle.position.clone().add(new Vector3(0, this.grip.height_m / 2 + SIGN.over_m, 0));
    this.sign.root.position.copy(top).addScaledVector(eye.clone().sub(top).normalize(), SIGN.before_m);
    this.sign.root.rotation.y = this.outside.rotation.y;
  }

  private light(lit: number, bands: number, dt_s: number): void {
    while (this.lanterns.length < bands) {
      const lantern = new Lantern(this.quality);
      this.lanterns.push(lantern);
      this.outside.add(lantern.root);
    }
    this.lanterns.forEach((lantern, i) => {
      lantern.root.position.set(this.side * (COURSE_X_M + (i - (bands - 1) / 2) * LANTERN.apart_m), WINDOW.low_m, LANTERN.z_m);
      lantern.update(i < lit ? 1 : 0, dt_s);
    });
  }
}

export const viewOf: ViewOf = (scene, quality) => {
  const grip = gripOf(scene);
  return grip && new HutView(grip, scene, quality);
};
