// Comparing two bottles in the picture: both on a post, the wanted one in the light.
import { Group, Vector3, type PerspectiveCamera, type SpotLight } from 'three';
import type { SkinUniforms } from '../../hand/skin_shader';
import type { SceneT, WorldStateT } from '../../protocol';
import { DEFAULT_PLACE, type CameraPlace } from '../../scene/camera';
import { Dent, pressingOn } from '../../scene/dent';
import { quaternionToThree, toThree } from '../../scene/frames';
import { outlineOfScene } from '../../scene/outline';
import type { Quality } from '../../scene/quality';
import type { Anchors, ExerciseView, ViewOf } from '../exercise_view';
import { ExerciseValues } from '../values';
import { pairOf, type Pair } from './bottles';
import { ABOVE_M, FOOT_M, makeBottle, makePost } from './post';

/** Time constant of the light that goes to the wanted bottle [s]. */
const LIGHT_S = 0.25;

export class PairView implements ExerciseView {
  readonly root = new Group();
  readonly rail_m = undefined;
  private readonly values: ExerciseValues;
  private readonly bottles: readonly { readonly root: Group; readonly dent: Dent | undefined }[];
  private post: Group | undefined;
  private wanted = -1;

  constructor(private readonly pair: Pair, private readonly scene: SceneT, private readonly quality: Quality) {
    this.values = new ExerciseValues(scene.valueNames);
    this.bottles = pair.bottles.map((bottle, i) => {
      const { root, side } = makeBottle(bottle, i as 0 | 1, quality);
      this.root.add(root);
      return { root, dent: quality === 'high' ? new Dent(side, bottle.radius_m) : undefined };
    });
  }

  owns(name: string): boolean {
    return [this.pair.counter, ...this.pair.bottles.map(({ body }) => body)].some((body) => String(this.scene.bodies[body]?.name ?? '') === name);
  }

  placement(state: WorldStateT | undefined): { place: CameraPlace; outline: Vector3[] } {
    const { pair, scene } = this, at = state?.bodies[pair.bottles[0].body]?.positionM;
    const counter_y = this.counterOf(state), row_z = at ? -at.x : DEFAULT_PLACE.row_z;
    const ends = this.postAt(state), post = ends ? [ends.foot.clone().setZ(ends.foot.z + FOOT_M), new Vector3(ends.foot.x, ends.foot.y + ends.tall_m, ends.foot.z)] : [];
    return { place: { right: scene.rightHand, counter_y, row_z }, outline: [...outlineOfScene(scene, state), ...post] };
  }

  placeBehind(): void {}

  update(state: WorldStateT): void {
    this.wanted = this.values.get(state, 'wanted');
    this.pair.bottles.forEach(({ body }, i) => {
      const at = state.bodies[body], { root } = this.bottles[i]!;
      if (!at?.positionM || !at.orientationXyzw) return;
      toThree(at.positionM, root.position);
      quaternionToThree(at.orientationXyzw, root.quaternion);
    });
    const ends = this.postAt(state);
    if (!ends) return;
    if (!this.post) this.root.add(this.post = makePost(ends.tall_m, this.quality));
    this.post.position.copy(ends.foot);
  }

  yieldTo(skin: SkinUniforms): void {
    this.bottles.forEach(({ root, dent }, i) => dent?.update(pressingOn(root, skin, this.pair.bottles[i]!.radius_m)));
  }

  lightTarget(light: SpotLight, dt_s: number): void {
    const { position } = this.bottles[Math.max(0, this.wanted)]!.root, follow = 1 - Math.exp(-dt_s / LIGHT_S);
    light.target.position.x = light.position.x = position.x;
    light.target.position.y += (position.y - light.target.position.y) * follow;
  }

  railZ(): undefined { return undefined; }

  anchors(_camera: PerspectiveCamera): Anchors { return { goal: undefined, target: this.wanted < 0 ? undefined : this.bottles[this.wanted]!.root.position.clone() }; }

  /** The post's foot on the counter, and its height with the knob. */
  private postAt(state: WorldStateT | undefined): { foot: Vector3; tall_m: number } | undefined {
    const [lower, upper] = this.pair.bottles.map(({ body }) => state?.bodies[body]?.positionM), counter_z = this.counterOf(state);
    return lower && upper ? { foot: toThree({ x: lower.x, y: lower.y, z: counter_z }), tall_m: upper.z + this.pair.bottles[1].height_m / 2 + ABOVE_M - counter_z } : undefined;
  }

  private counterOf(state: WorldStateT | undefined): number {
    const { pair: { counter }, scene } = this, at = state?.bodies[counter]?.positionM;
    return at ? at.z + (scene.bodies[counter]?.shapes[0]?.halfExtentsM?.z ?? 0) : DEFAULT_PLACE.counter_y;
  }
}

export const viewOf: ViewOf = (scene, quality) => {
  const pair = pairOf(scene);
  return pair && new PairView(pair, scene, quality);
};
