// The 3D view of an exercise: an interface. It is separate from exercise.ts because three.js is loaded later than the texts.

import type { Group, PerspectiveCamera, SpotLight, Vector3 } from 'three';
import type { SkinUniforms } from '../hand/skin_shader';
import type { SceneT, WorldStateT } from '../protocol';
import type { CameraPlace } from '../scene/camera';
import type { Quality } from '../scene/quality';
import type { Setting } from '../scene/stage';
import type { Marks } from './exercise';

/** Anchor points of the page's texts, in three.js's frame [m]. */
export interface Anchors {
  readonly goal: Vector3 | undefined;     // the mark of the current step's goal
  readonly target: Vector3 | undefined;   // the grip of the current target
}

export interface ExerciseView {
  readonly root: Group;
  /** Height of the rail over the counter [m]; undefined: no rail. */
  readonly rail_m: number | undefined;
  /** The room; undefined: the fluted wall. */
  readonly setting?: Setting;
  /** Whether this view draws a body of the scene; then nothing else draws it. */
  owns(body: string): boolean;
  /** The camera's place, and the corners of the region that must be visible; before the first state, as far as known. */
  placement(state: WorldStateT | undefined): { place: CameraPlace; outline: Vector3[] };
  /** Called after the camera was placed. */
  placeBehind(camera: PerspectiveCamera, place: CameraPlace): void;
  /** @param eye the camera's position */
  update(state: WorldStateT, eye: Vector3, dt_s: number): void;
  /** Deforms soft objects around the hand. */
  yieldTo(skin: SkinUniforms): void;
  /** Moves the soft spot of light to the target. */
  lightTarget(light: SpotLight, dt_s: number): void;
  /** z of the rail in three.js's frame; undefined where the program has none. */
  railZ(state: WorldStateT): number | undefined;
  anchors(camera: PerspectiveCamera): Anchors;
  /** Sets the marks that the page remembers. */
  mark?(marks: Marks): void;
}

/** The view of a scene's exercise; undefined for another exercise. */
export type ViewOf = (scene: SceneT, quality: Quality) => ExerciseView | undefined;
