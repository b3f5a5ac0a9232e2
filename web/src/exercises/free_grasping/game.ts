import type { ExerciseGame } from '../exercise_game';
import { GraspPlay } from './play';
import { thingsOf } from './things';

export const game: ExerciseGame = {
  targetsOf: () => undefined,
  playOf(scene, panel) {
    const things = thingsOf(scene);
    return panel && things && new GraspPlay(things, panel);
  },
};
