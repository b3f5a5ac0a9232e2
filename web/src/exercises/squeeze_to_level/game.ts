import type { ExerciseGame } from '../exercise_game';
import { gripOf } from './grip';
import { LevelPlay } from './play';
import { gripTargets } from './targets';

export const game: ExerciseGame = {
  targetsOf(scene) {
    const grip = gripOf(scene);
    return grip && gripTargets(grip, scene);
  },
  playOf: (scene, panel) => (panel && gripOf(scene) ? new LevelPlay(panel, scene) : undefined),
};
