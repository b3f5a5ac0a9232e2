// Free grasping in the picture: the objects, the sign of the proposed one, the stars in the window.
import { Group, Mesh, RingGeometry, Vector3, type PerspectiveCamera, type SpotLight } from 'three';
import type { SceneT, WorldStateT } from '../../protocol';
import { DEFAULT_PLACE, turnOf, type CameraPlace } from '../../scene/camera';
import { intoProgramFrame, toThree } from '../../scene/frames';
import { flat } from '../../scene/materials';
import { outlineOfScene } from '../../scene/outline';
import type { Quality } from '../../scene/quality';
import { Sign } from '../../scene/sign';
import type { Setting } from '../../scene/stage';
import type { Marks } from '../exercise';
import type { Anchors, ExerciseView, ViewOf } from '../exercise_view';
import { cabin } from './cabin';
import { text } from './i18n';
import { makeThing } from './models';
import { Stars } from './stars';
import { thingsOf, type Thing } from './things';

const SIGN = { wide_m: 0.085, over_m: 0.02 } as const;
/** Size of the ring around the proposed object [m]. */
const RING_M = 0.012;
const STARS_Z_M = -0.63;

/** Distance of an object's farthest point from its middle [m]. */
function reachOf({ kind, shape }: Thing): number {
  const h = shape.halfExtentsM;
  return kind === 'cube' && h ? Math.hypot(h.x, h.y, h.z) : kind === 'sphere' ? shape.radiusM : Math.hypot(shape.radiusM, shape.lengthM / 2);
}

export class CabinView implements ExerciseView {
  readonly root = new Group();
  readonly rail_m = undefined;
  readonly setting: Setting;
  private readonly program = new Group();
  private readonly models: Group[];
  private readonly window = new Group();   // turned like the room
  private readonly stars: Stars;
  private readonly sign = new Sign(SIGN.wide_m);
  private readonly ring = new Group();
  private readonly still = matchMedia('(prefers-reduced-motion: reduce)');
  private shown: Marks = { proposed: -1, held: [] };

  constructor(private readonly things: readonly Thing[], private readonly scene: SceneT, quality: Quality) {
    this.setting = cabin(scene.rightHand);
    intoProgramFrame(this.program);
    this.models = things.map((thing) => makeThing(thing, quality));
    this.program.add(...this.models);
    this.stars = new Stars(things.map(({ color }) => color), scene.rightHand ? 1 : -1);
    this.stars.root.position.z = STARS_Z_M;
    this.window.add(this.stars.root);
    this.ring.add(new Mesh(new RingGeometry(1, 1 + 0.2, 64), flat('#1c1410')), new Mesh(new RingGeometry(1.045, 1 + 0.155, 64), flat('#ffb938')));
    this.ring.children[1]!.position.z = 0.0005;
    this.root.add(this.program, this.window, this.ring, this.sign.root);
  }

  owns(name: string): boolean { return this.things.some((thing) => thing.name === name); }

  placement(state: WorldStateT | undefined): { place: CameraPlace; outline: Vector3[] } {
    return { place: { ...DEFAULT_PLACE, right: this.scene.rightHand }, outline: outlineOfScene(this.scene, state) };
  }

  placeBehind(_camera: PerspectiveCamera, { right, counter_y, row_z }: CameraPlace): void {
    this.window.position.set(0, counter_y, row_z);
    this.window.rotation.y = turnOf(right);
  }

  mark(marks: Marks): void { this.shown = marks; }

  update(state: WorldStateT, eye: Vector3, dt_s: number): void {
    this.things.forEach(({ body }, i) => {
      const p = state.bodies[body]?.positionM, q = state.bodies[body]?.orientationXyzw;
      if (!p || !q) return;
      this.models[i]!.position.set(p.x, p.y, p.z);
      this.models[i]!.quaternion.set(q.x, q.y, q.z, q.w);
    });
    this.stars.update(this.shown.held, this.still.matches, dt_s);
    this.propose(state, eye);
  }

  yieldTo(): void { /* Nothing here is soft. */ }

  lightTarget(light: SpotLight): void {
    const at = this.models[this.shown.proposed]?.position;
    if (at) light.target.position.x = light.position.x = toThree(at).x;
  }

  railZ(): undefined { return undefined; }

  anchors(): Anchors {
    const model = this.models[this.shown.proposed];
    return { goal: undefined, target: model && toThree(model.position) };
  }

  /** Shows a ring around an object, behind it as seen from the camera, and its name above it. */
  private propose(state: WorldStateT, eye: Vector3): void {
    const thing = this.things[this.shown.proposed], at = thing && state.bodies[thing.body]?.positionM;
    this.ring.visible = this.sign.root.visible = at !== undefined && at !== null;
    if (!thing || !at) return;
    const middle = toThree(at), reach = reachOf(thing), away = middle.clone().sub(eye).normalize();
    this.ring.position.copy(middle).addScaledVector(away, reach);
    this.ring.scale.setScalar(reach + RING_M);
    this.ring.lookAt(eye);
    this.sign.show(text(thing.kind), true);
    this.sign.root.position.copy(middle).add(new Vector3(0, reach + RING_M + SIGN.over_m, 0));
    this.sign.root.rotation.y = this.window.rotation.y;
  }
}

export const viewOf: ViewOf = (scene, quality) => {
  const things = thingsOf(scene);
  return things && new CabinView(things, scene, quality);
};
