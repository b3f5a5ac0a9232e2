// What an exercise adds to the picture. Apart from exercise.ts: three.js comes later than the words.

import type { Group, PerspectiveCamera, SpotLight, Vector3 } from 'three';
import type { SkinUniforms } from '../hand/skin_shader';
import type { SceneT, WorldStateT } from '../protocol';
import type { CameraPlace } from '../scene/camera';
import type { Quality } from '../scene/quality';
import type { Setting } from '../scene/stage';
import { barOf } from './cocktail_bar/bar';
import { BarView } from './cocktail_bar/bar_view';
import type { Marks } from './exercise';
import { thingsOf } from './free_grasping/things';
import { CabinView } from './free_grasping/cabin_view';
import { KitchenView } from './kitchen/kitchen_view';
import { taskOf } from './kitchen/task';
import { gripOf } from './squeeze_to_level/grip';
import { HutView } from './squeeze_to_level/hut_view';

/** Points that words of the page stand at, three.js's frame [m]. */
export interface Anchors {
  readonly goal: Vector3 | undefined;     // where the goal of the present step is marked
  readonly target: Vector3 | undefined;   // the grip of what is to be grasped
}

export interface ExerciseView {
  readonly root: Group;
  /** Height of the rail over the counter [m]; undefined: no rail. */
  readonly rail_m: number | undefined;
  /** Where the exercise takes place; undefined: before the fluted wall. */
  readonly setting?: Setting;
  /** Whether this view draws a body of the scene: nothing else does then. */
  owns(body: string): boolean;
  /** Where the row stands, and the corners of what must be seen at once; before the first state, as far as it is known. */
  placement(state: WorldStateT | undefined): { place: CameraPlace; outline: Vector3[] };
  /** The camera was placed. */
  placeBehind(camera: PerspectiveCamera, place: CameraPlace): void;
  /** @param eye where the picture is taken from */
  update(state: WorldStateT, eye: Vector3, dt_s: number): void;
  /** What is soft yields to the hand. */
  yieldTo(skin: SkinUniforms): void;
  /** Moves the soft spot of light to the target. */
  lightTarget(light: SpotLight, dt_s: number): void;
  /** Where the rail is, three.js's frame; undefined where the program has none. */
  railZ(state: WorldStateT): number | undefined;
  anchors(camera: PerspectiveCamera): Anchors;
  /** Takes what the page remembers. */
  mark?(marks: Marks): void;
}

/** The view of a scene's exercise; undefined where its bodies are all there is to see. */
export function viewOf(scene: SceneT, quality: Quality): ExerciseView | undefined {
  const bar = barOf(scene), grip = gripOf(scene), things = thingsOf(scene), task = taskOf(scene);
  if (bar) return new BarView(bar, scene, quality);
  if (grip) return new HutView(grip, scene, quality);
  if (task) return new KitchenView(task, scene, quality);
  return things && new CabinView(things, scene, quality);
}
