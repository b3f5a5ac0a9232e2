// The 3D views of all exercises.
import type { SceneT } from '../protocol';
import type { Quality } from '../scene/quality';
import { barOf } from './cocktail_bar/bar';
import { BarView } from './cocktail_bar/bar_view';
import { thingsOf } from './free_grasping/things';
import { CabinView } from './free_grasping/cabin_view';
import { KitchenView } from './kitchen/kitchen_view';
import { taskOf } from './kitchen/task';
import { gripOf } from './squeeze_to_level/grip';
import { HutView } from './squeeze_to_level/hut_view';
import type { ExerciseView } from './exercise_view';

/** The view of a scene's exercise; undefined where the bodies are drawn plainly. */
export function viewOf(scene: SceneT, quality: Quality): ExerciseView | undefined {
  const bar = barOf(scene), grip = gripOf(scene), things = thingsOf(scene), task = taskOf(scene);
  if (bar) return new BarView(bar, scene, quality);
  if (grip) return new HutView(grip, scene, quality);
  if (task) return new KitchenView(task, scene, quality);
  return things && new CabinView(things, scene, quality);
}
