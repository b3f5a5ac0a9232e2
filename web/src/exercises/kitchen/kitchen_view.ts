// A task of the kitchen in the picture: its bodies as furniture, the kitchen around them, the cue of the present step.
import { Group, Vector3, type SpotLight } from 'three';
import { BodyT, ShapeType, type SceneT, type WorldStateT } from '../../protocol';
import { DEFAULT_PLACE, type CameraPlace } from '../../scene/camera';
import { programFrame, toThree } from '../../scene/frames';
import { outlineOfScene } from '../../scene/outline';
import type { Quality } from '../../scene/quality';
import type { Setting } from '../../scene/stage';
import type { Anchors, ExerciseView } from '../exercise_view';
import { ExerciseValues } from '../values';
import { Cues, makeGhost } from './cues';
import { frontOf, makeCabinet, makePiece, makeTray, Workshop, type Size } from './furniture';
import { moved, placedOf, pointOf, type Placed } from './joint';
import { kitchen, makeRow, TOP_M, type BuiltIn } from './room';
import { handleOf, jointOf, usedBodies, type KitchenTask } from './task';

/** A box is behind a front that is nearer than this [m]. */
const BEHIND_M = 0.03;
/** A drawer's tray is longer than its way by this [m]. */
const TRAY_MORE_M = 0.05;
/** The picture looks at what is so far under a built-in cabinet's worktop [m]. */
const LOOK_UNDER_M = 0.24;
/** Things stand on a worktop, and it under all of them. */
const LEAST_COUNTER_Z = DEFAULT_PLACE.counter_y;

export class KitchenView implements ExerciseView {
  readonly root = new Group();
  readonly rail_m = undefined;
  readonly setting: Setting;
  private readonly values: ExerciseValues;
  private readonly shop: Workshop;
  private readonly program = new Group();
  private readonly pieces = new Map<number, Group>();
  private readonly cues: Cues;
  private readonly names: ReadonlySet<string>;
  private place: CameraPlace | undefined;   // known from the first state on
  private target: Vector3 | undefined;

  constructor(private readonly task: KitchenTask, private readonly scene: SceneT, quality: Quality) {
    this.setting = kitchen(scene.rightHand);
    this.values = new ExerciseValues(scene.valueNames);
    this.shop = new Workshop(quality);
    this.names = new Set(scene.bodies.map(({ name }) => String(name)));
    this.program.matrixAutoUpdate = false;
    this.program.matrix.copy(programFrame());
    const ghosts = new Map<number, Group>();
    scene.bodies.forEach((body, i) => {
      const piece = makePiece(body, this.shop);
      this.pieces.set(i, piece);
      this.program.add(piece);
    });
    for (const body of usedBodies(task)) {
      const ghost = makeGhost(this.pieces.get(body)!);
      ghosts.set(body, ghost);
      this.program.add(ghost);
    }
    this.cues = new Cues(ghosts);
    this.root.add(this.program, this.cues.root);
  }

  owns(name: string): boolean { return this.names.has(name); }

  placement(state: WorldStateT | undefined): { place: CameraPlace; outline: Vector3[] } {
    if (state) this.place ??= this.furnish(state);
    return { place: this.place ?? { ...DEFAULT_PLACE, right: this.scene.rightHand }, outline: outlineOfScene(this.scene, state) };
  }

  placeBehind(): void { /* Nothing here turns with the picture. */ }

  update(state: WorldStateT, eye: Vector3): void {
    this.pieces.forEach((piece, body) => {
      const now = placedOf(state.bodies[body]);
      piece.visible = now !== undefined;
      if (!now) return;
      piece.position.copy(now.at);
      piece.quaternion.copy(now.turn);
    });
    const { task, values } = this, step = task.steps[values.get(state, 'instruction')], now = step && placedOf(state.bodies[step.body]);
    const handle = step && handleOf(this.scene.bodies[step.body]!);
    this.target = now && handle && toThree(pointOf(now, handle.at_m));
    this.cues.update(step && now && handle && { step, now, handle, joint: jointOf(task, step.body), q: values.get(state, 'joint_q'), held_s: values.get(state, 'held_s') }, eye);
  }

  yieldTo(): void { /* Nothing here is soft. */ }

  lightTarget(light: SpotLight): void {
    if (this.target) light.target.position.x = light.position.x = this.target.x;
  }

  railZ(): undefined { return undefined; }

  anchors(): Anchors { return { goal: undefined, target: this.target?.clone() }; }

  /** Builds what stands around the bodies, where they are at first. */
  private furnish(state: WorldStateT): CameraPlace {
    const { scene, task, shop } = this, first = task.steps[0]!.body, placed = placedOf(state.bodies[first]);
    const row_x = placed ? pointOf(placed, handleOf(scene.bodies[first]!).at_m).x : -DEFAULT_PLACE.row_z;
    const cabinet = this.buildIn(state), side = scene.rightHand ? 1 : -1;
    const top_z = cabinet ? cabinet.at[2] + cabinet.size[2] / 2 + TOP_M : this.underAll(state);
    this.program.add(makeRow(top_z, row_x, side, cabinet, shop));
    return { right: scene.rightHand, counter_y: cabinet ? top_z - LOOK_UNDER_M : top_z, row_z: -row_x };
  }

  /** A front on a joint before a fixed box: the box becomes its cabinet, and what slides has a tray. */
  private buildIn(state: WorldStateT): BuiltIn | undefined {
    const { scene, task, shop } = this, step = task.steps[this.values.get(state, 'instruction')] ?? task.steps.at(-1)!;
    for (const joint of task.joints) {
      const body = scene.bodies[joint.body], front = body && frontOf(body), now = placedOf(state.bodies[joint.body]);
      if (!body || !front || !now) continue;
      // Shut: at the joint's 0. Of other bodies than the present step's no coordinate is told; they are where they begin.
      const shut = step.body === joint.body ? moved(now, joint, -this.values.get(state, 'joint_q')) : now;
      const box = scene.bodies.findIndex((one, i) => one.fixed && isBehind(one, placedOf(state.bodies[i]), shut, front));
      const at = placedOf(state.bodies[box])?.at, h = scene.bodies[box]?.shapes[0]?.halfExtentsM;
      if (!at || !h) continue;
      const size: Size = [2 * h.x, 2 * h.y, 2 * h.z], slides = joint.type === 'slide';
      const solid = this.pieces.get(box)!;
      solid.clear();
      solid.add(...makeCabinet(size, String(scene.bodies[box]!.color ?? '') || '#c99a66', !slides, shop).children);
      if (slides) this.pieces.get(joint.body)!.add(...makeTray(front, Math.min(joint.most - joint.least + TRAY_MORE_M, 2 * h.x - 0.03), shop).children);
      return { at: [at.x, at.y, at.z], size, front_m: front.size[0], color: String(body.color ?? '') || '#c99a66' };
    }
    return undefined;
  }

  /** The lowest end of what stands fixed [m]. */
  private underAll(state: WorldStateT): number {
    const ends = this.scene.bodies.flatMap((body, i) => {
      const at = placedOf(state.bodies[i])?.at;
      return body.fixed && at ? body.shapes.map((shape) => at.z + (shape.inBody?.positionM?.z ?? 0) - (shape.halfExtentsM?.z || shape.lengthM / 2)) : [];
    });
    return Math.max(LEAST_COUNTER_Z, Math.min(...ends, 0) === 0 ? LEAST_COUNTER_Z : Math.min(...ends));
  }
}

/** Whether a body is one box that begins at a front's back and goes around it. */
function isBehind({ shapes }: BodyT, box: Placed | undefined, shut: Placed, { at: [x, y, z], size: [deep] }: { readonly at: Size; readonly size: Size }): boolean {
  const h = shapes[0]?.halfExtentsM;
  if (!box || !h || shapes.length !== 1 || shapes[0]!.type !== ShapeType.Box) return false;
  const back = pointOf(shut, { x: x + deep / 2, y, z }), near_x = box.at.x - h.x;
  return h.x > BEHIND_M && Math.abs(near_x - back.x) < BEHIND_M && Math.abs(back.y - box.at.y) < h.y && Math.abs(back.z - box.at.z) < h.z;
}
