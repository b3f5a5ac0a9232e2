// The exercises that have a folder here; each folder has a game.ts. Every other exercise is shown by its panel.
import type { SceneT } from '../protocol';
import { BAR_FILE } from './cocktail_bar/bar';
import { text } from './cocktail_bar/i18n';
import { barWords } from './cocktail_bar/words';
import type { GraspTargets, Play } from './exercise';
import type { ExerciseGame } from './exercise_game';
import { ExercisePanel } from './panel';
import { PanelPlay } from './panel_play';

const GAMES = Object.values(import.meta.glob<ExerciseGame>('./*/game.ts', { eager: true, import: 'game' }));
const NO_TARGETS: GraspTargets = { grips: [], counter_z_m: undefined, wanted: () => -1, letGo: () => false };

/** The first value that an exercise gives. */
function firstOf<Value>(of: (game: ExerciseGame) => Value | null | undefined): Value | undefined {
  for (const game of GAMES) {
    const value = of(game);
    if (value) return value;
  }
  return undefined;
}

/** The grasp targets of a scene's exercise. */
export function targetsOf(scene: SceneT): GraspTargets {
  return firstOf((game) => game.targetsOf(scene)) ?? NO_TARGETS;
}

/** The exercise of a scene in the game; null where nothing can be shown. @param before the play of an earlier scene, which may continue */
export function playOf(scene: SceneT, before: Play | null): Play | null {
  const panel = ExercisePanel.of(scene) ?? null;
  return firstOf((game) => game.playOf(scene, panel, before)) ?? (panel && new PanelPlay(panel, scene));
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
