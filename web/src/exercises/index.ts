// The exercises that have a folder here. Every other exercise is shown by its panel.
import type { SceneT } from '../protocol';
import { BAR_FILE, barOf } from './cocktail_bar/bar';
import { BarPlay } from './cocktail_bar/play';
import { barTargets } from './cocktail_bar/targets';
import { barWords } from './cocktail_bar/words';
import { text } from './cocktail_bar/i18n';
import type { GraspTargets, Play } from './exercise';
import { GraspPlay } from './free_grasping/play';
import { thingsOf } from './free_grasping/things';
import { KitchenPlay } from './kitchen/play';
import { kitchenTargets } from './kitchen/targets';
import { taskOf } from './kitchen/task';
import { ExercisePanel } from './panel';
import { PanelPlay } from './panel_play';
import { gripOf } from './squeeze_to_level/grip';
import { LevelPlay } from './squeeze_to_level/play';
import { gripTargets } from './squeeze_to_level/targets';

const NO_TARGETS: GraspTargets = { grips: [], counter_z_m: undefined, wanted: () => -1, letGo: () => false };

/** The grasp targets of a scene's exercise. */
export function targetsOf(scene: SceneT): GraspTargets {
  const bar = barOf(scene), grip = gripOf(scene), task = taskOf(scene);
  if (bar) return barTargets(bar, scene);
  if (task) return kitchenTargets(task, scene);
  return grip ? gripTargets(grip, scene) : NO_TARGETS;
}

/** The exercise of a scene in the game; null where nothing can be shown. @param before the play of an earlier scene, which may continue */
export function playOf(scene: SceneT, before: Play | null): Play | null {
  const bar = barOf(scene);
  if (bar) return new BarPlay(bar, scene, before instanceof BarPlay ? before : undefined);
  const panel = ExercisePanel.of(scene), things = thingsOf(scene), task = taskOf(scene);
  if (panel && gripOf(scene)) return new LevelPlay(panel, scene);
  if (panel && things) return new GraspPlay(things, panel);
  if (panel && task) return new KitchenPlay(task, panel, scene);
  return panel && new PanelPlay(panel, scene);
}

/** The exercise that the game loads if the present one cannot be shown; it is described before a scene has come. */
export const FIRST = {
  file: BAR_FILE,
  words: barWords,
  pageTitle: () => text('title'),
  pictureLabel: () => text('picture'),
  /** The text if the browser cannot draw. */
  noPicture: () => text('noPicture'),
} as const;
