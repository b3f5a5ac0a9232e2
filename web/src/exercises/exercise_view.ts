// What an exercise adds to the picture. Apart from exercise.ts: three.js comes later than the words.

import type { Group, PerspectiveCamera, SpotLight, Vector3 } from 'three';
import type { SkinUniforms } from '../hand/skin_shader';
import type { SceneT, WorldStateT } from '../protocol';
import type { CameraPlace } from '../scene/camera';
import type { Quality } from '../scene/quality';
import { barOf } from './cocktail_bar/bar';
import { BarView } from './cocktail_bar/bar_view';

/** Points that words of the page stand at, three.js's frame [m]. */
export interface Anchors {
  readonly goal: Vector3 | undefined;     // where the goal of the present step is marked
  readonly target: Vector3 | undefined;   // the grip of what is to be grasped
}

export interface ExerciseView {
  readonly root: Group;
  /** Height of the rail over the counter [m]. */
  readonly rail_m: number;
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
}

/** The view of a scene's exercise; undefined where its bodies are all there is to see. */
export function viewOf(scene: SceneT, quality: Quality): ExerciseView | undefined {
  const bar = barOf(scene);
  return bar && new BarView(bar, scene, quality);
}
