// A kitchen task in the picture: its bodies as furniture, the kitchen around them, the cue of the present step.
import { Group, Vector3, type SpotLight } from 'three';
import type { SceneT, ShapeT, WorldStateT } from '../../protocol';
import { DEFAULT_PLACE, type CameraPlace } from '../../scene/camera';
import { intoProgramFrame, toThree } from '../../scene/frames';
import { outlineOfHand } from '../../scene/outline';
import type { Quality } from '../../scene/quality';
import type { Setting } from '../../scene/stage';
import type { Anchors, ExerciseView, ViewOf } from '../exercise_view';
import { ExerciseValues } from '../values';
import { applianceOf, type Appliance } from './appliances';
import { Cues, makeGhost } from './cues';
import { colorOf, frontOf, makeContents, makePiece, Workshop, type Size } from './furniture';
import { Lamp } from './lamp';
import { moved, placedOf, pointOf, type Placement } from './joint';
import { kitchen, makeBase, makeInside, makeRow, makeThings, makeWall, makeWorktop, wallBehind, type Extent } from './room';
import { taskOf, askedOf, doneShare, handleOf, hasBar, isOn, jointOf, switchOf, metAt, pointMet, usedBodies, type KitchenTask } from './task';

/** A fixed body of at most this relative thickness is a worktop; the widest one is used. */
const FLAT = 0.25;
/** If the scene has no worktop: its extent in front of the targets, its thickness [m], and its colour. */
const BEFORE_M = 0.25;
const SLAB_M = 0.03;
const BEECH = '#d9b98c';
/** A fixed vertical board of at least this width and height is the wall [m]; objects in front of it leave this free on each side. */
const WALL_M = 0.35;
const FREE_M = 0.22;
/** Colour of fronts that no task uses. */
const SAGE = '#8fb0a0';
/** The camera looks this far below the worktop at something built in [m]. */
const LOOK_UNDER_M = 0.24;
/** Room for the cue beyond a handle's ends [m]. */
const CUE_M = 0.05;

export class KitchenView implements ExerciseView {
  readonly root = new Group();
  readonly rail_m = undefined;
  readonly setting: Setting;
  private readonly values: ExerciseValues;
  private readonly shop: Workshop;
  private readonly program = new Group();
  private readonly appliance: Appliance | undefined;
  private readonly modelled = new Set<number>();
  private readonly pieces = new Map<number, Group>();
  private readonly cues: Cues;
  private readonly names: ReadonlySet<string>;
  private place: CameraPlace | undefined;   // known from the first state on
  private target: Vector3 | undefined;
  private lamp: Lamp | undefined;

  constructor(private readonly task: KitchenTask, private readonly scene: SceneT, quality: Quality) {
    this.setting = kitchen(scene.rightHand);
    this.values = new ExerciseValues(scene.valueNames);
    this.shop = new Workshop(quality);
    this.names = new Set(scene.bodies.map(({ name }) => String(name)));
    intoProgramFrame(this.program);
    const ghosts = new Map<number, Group>(), used = usedBodies(task);
    this.appliance = applianceOf(task.name, scene.rightHand, this.shop);
    scene.bodies.forEach((body, i) => {
      const model = this.appliance?.model(body), piece = model ?? makePiece(body, this.shop, used.includes(i) && !hasBar(body));
      if (model) this.modelled.add(i);
      this.pieces.set(i, piece);
      this.program.add(piece);
    });
    for (const body of used) {
      const piece = this.pieces.get(body)!, ghost = makeGhost(makePiece(scene.bodies[body]!, this.shop), scene.bodies[body]!, frontOf(scene.bodies[body]!));
      if (hasBar(scene.bodies[body]!)) piece.add(makeContents(scene.bodies[body]!, this.shop));
      ghosts.set(body, ghost);
      this.program.add(ghost);
    }
    this.cues = new Cues(ghosts);
    this.root.add(this.program, this.cues.root);
  }

  owns(name: string): boolean { return this.names.has(name); }

  placement(state: WorldStateT | undefined): { place: CameraPlace; outline: Vector3[] } {
    // A state before arming has no poses.
    if (state && this.pieces.size <= state.bodies.length) this.place ??= this.furnish(state);
    return { place: this.place ?? { ...DEFAULT_PLACE, right: this.scene.rightHand }, outline: this.outline(state) };
  }

  placeBehind(): void { /* Nothing here turns with the camera. */ }

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
    const light = switchOf(task);
    if (this.lamp && light && step?.body === light.body) this.lamp.lit = isOn(light, values.get(state, 'joint_q'));
    const joint = step && jointOf(task, step.body), q = values.get(state, 'joint_q');
    this.appliance?.show(doneShare(task, values.get(state, 'instruction'), q, values.get(state, 'held_s')), q / (joint?.most ?? Infinity));
    const body = step && this.scene.bodies[step.body];
    this.cues.update(step && body && now && handle && {
      step, now, handle, barred: hasBar(body), point: pointMet(task, body, step.body, metAt(task, values.get(state, 'instruction'))),
      joint, q, held_s: values.get(state, 'held_s'), force: values.get(state, 'handle_n') / askedOf(step, this.scene, state),
    }, eye);
  }

  yieldTo(): void { /* Nothing here is soft. */ }

  lightTarget(light: SpotLight): void {
    if (this.target) light.target.position.x = light.position.x = this.target.x;
  }

  railZ(): undefined { return undefined; }

  anchors(): Anchors { return { goal: undefined, target: this.target?.clone() }; }

  /** Corners of the hand, of handles now and at their goals, and of a device. */
  private outline(state: WorldStateT | undefined): Vector3[] {
    if (!state) return [];
    const handles = this.task.steps.flatMap(({ body, to }) => {
      const shut = this.shutOf(body, state), joint = jointOf(this.task, body), { at_m, length_m } = handleOf(this.scene.bodies[body]!);
      if (!shut) return [];
      return [shut, ...(joint && to !== undefined ? [moved(shut, joint, to)] : [])].flatMap((there) =>
        [-1, 1].map((end) => toThree(pointOf(there, { ...at_m, z: at_m.z + end * (length_m / 2 + CUE_M) }))));
    });
    const device = this.appliance ? this.scene.bodies.flatMap((body, i) => (this.modelled.has(i) && body.fixed ? cornersOf(extentOf(placedOf(state.bodies[i]), body.shapes)) : [])) : [];
    return [...outlineOfHand(this.scene), ...handles, ...device];
  }

  /** Pose of a body at its joint's 0. The program reports the coordinate of the present step's body; other bodies are at 0. */
  private shutOf(body: number, state: WorldStateT): Placement | undefined {
    const { steps } = this.task, now = steps[Math.min(this.values.get(state, 'instruction'), steps.length - 1)]!;
    const placed = placedOf(state.bodies[body]), joint = jointOf(this.task, body);
    return placed && joint && now.body === body ? moved(placed, joint, -this.values.get(state, 'joint_q')) : placed;
  }

  /** Builds the surroundings of the bodies at their initial poses. */
  private furnish(state: WorldStateT): CameraPlace {
    const { scene, task, shop, program } = this, { body } = task.steps[0]!, placed = this.shutOf(body, state);
    const row_x = placed ? pointOf(placed, handleOf(scene.bodies[body]!).at_m).x : -DEFAULT_PLACE.row_z;
    const fixed = [...this.pieces].flatMap(([i, piece]) => (scene.bodies[i]!.fixed ? [{ i, piece, ...extentOf(placedOf(state.bodies[i]), scene.bodies[i]!.shapes) }] : []));
    const wide = ({ low, high }: Extent): number => (high[0] - low[0]) * (high[1] - low[1]);
    const slab = fixed.filter(({ low, high }) => high[2] - low[2] < FLAT * Math.min(high[0] - low[0], high[1] - low[1])).sort((a, b) => wide(b) - wide(a))[0];
    const wall = fixed.find(({ low, high }) => high[0] - low[0] < FLAT * WALL_M && high[1] - low[1] >= WALL_M && high[2] - low[2] >= WALL_M);
    const around = fixed.filter((one) => one !== slab && one !== wall), front = this.shutFront(state), wall_x = wall ? wall.low[0] : wallBehind(row_x);
    const top_z = slab ? slab.high[2] : Math.max(DEFAULT_PLACE.counter_y, Math.min(0, ...around.map(({ low }) => low[2])));
    const place = { right: scene.rightHand, counter_y: top_z, row_z: -row_x };
    // A slab along the wall replaces the body's own.
    slab?.piece.clear();
    wall?.piece.clear();
    if (wall) program.add(makeWall(wall_x, shop));
    const light = switchOf(task), switched = light && this.shutOf(light.body, state);
    if (wall && switched) program.add((this.lamp = new Lamp(switched.at, wall_x, shop)).root);
    const near_x = slab ? slab.low[0] : row_x - BEFORE_M, thick_m = slab ? slab.high[2] - slab.low[2] : SLAB_M;
    program.add(makeWorktop(near_x, top_z, thick_m, wall_x, slab ? colorOf(scene.bodies[slab.i]!) : BEECH, shop));
    program.add(makeThings(wall_x, top_z, scene.rightHand ? 1 : -1, wall ? FREE_M : 0, shop));
    if (front?.turns) program.add(makeInside(front, unionOf([front, ...around]), shop));
    if (!slab || !front || front.high[2] > slab.high[2]) {
      program.add(makeBase({ low: [near_x, 0, top_z - thick_m], high: [wall_x, 0, top_z] }, front?.color ?? SAGE, shop));
      return place;
    }
    program.add(makeRow(front, unionOf([front, ...around]), slab, front.color, shop));
    return { ...place, counter_y: top_z - LOOK_UNDER_M };
  }

  /** The first front that is on a joint, at its joint's 0. */
  private shutFront(state: WorldStateT): Extent & { readonly color: string; readonly turns: boolean } | undefined {
    const { scene, task } = this;
    for (const { body, joint } of task.things) {
      const front = joint && hasBar(scene.bodies[body]!) ? frontOf(scene.bodies[body]!) : undefined, shut = this.shutOf(body, state);
      if (!joint || !front || !shut) continue;
      return { ...extentOf(shut, [front]), color: colorOf(scene.bodies[body]!), turns: joint.type === 'hinge' };
    }
    return undefined;
  }
}

/** Bounds of the boxes and bars of an upright body. */
function extentOf(placed: Placement | undefined, shapes: readonly ShapeT[]): Extent {
  const at = placed?.at ?? new Vector3();
  return unionOf(shapes.map(({ inBody, halfExtentsM: h, radiusM: r, lengthM }) => {
    const p = inBody?.positionM, x = at.x + (p?.x ?? 0), y = at.y + (p?.y ?? 0), z = at.z + (p?.z ?? 0), [a, b, c] = [h?.x || r, h?.y || r, h?.z || lengthM / 2 || r];
    return { low: [x - a, y - b, z - c], high: [x + a, y + b, z + c] };
  }));
}

/** In three.js's frame. */
const cornersOf = ({ low, high }: Extent): Vector3[] => [low[0], high[0]].flatMap((x) => [low[1], high[1]].flatMap((y) => [low[2], high[2]].map((z) => toThree({ x, y, z }))));

function unionOf(extents: readonly Extent[]): Extent {
  const over = (pick: (...of: number[]) => number, end: keyof Extent): Size => [0, 1, 2].map((i) => pick(...extents.map((one) => one[end][i]!))) as unknown as Size;
  return { low: over(Math.min, 'low'), high: over(Math.max, 'high') };
}

export const viewOf: ViewOf = (scene, quality) => {
  const task = taskOf(scene);
  return task && new KitchenView(task, scene, quality);
};
