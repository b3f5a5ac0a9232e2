import type { ExerciseGame } from '../exercise_game';
import { barOf } from './bar';
import { BarPlay } from './play';
import { barTargets } from './targets';

export const game: ExerciseGame = {
  targetsOf(scene) {
    const bar = barOf(scene);
    return bar && barTargets(bar, scene);
  },
  playOf(scene, _panel, before) {
    const bar = barOf(scene);
    return bar && new BarPlay(bar, scene, before instanceof BarPlay ? before : undefined);
  },
};
