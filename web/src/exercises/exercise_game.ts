// How an exercise is played: an interface.
import type { SceneT } from '../protocol';
import type { GraspTargets, Play } from './exercise';
import type { ExercisePanel } from './panel';

/** Each function returns nothing for a scene of another exercise. */
export interface ExerciseGame {
  targetsOf(scene: SceneT): GraspTargets | undefined;
  /** @param before the play of an earlier scene, which may continue */
  playOf(scene: SceneT, panel: ExercisePanel | null, before: Play | null): Play | null | undefined;
}
