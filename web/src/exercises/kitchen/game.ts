import type { ExerciseGame } from '../exercise_game';
import { KitchenPlay } from './play';
import { kitchenTargets } from './targets';
import { taskOf } from './task';

export const game: ExerciseGame = {
  targetsOf(scene) {
    const task = taskOf(scene);
    return task && kitchenTargets(task, scene);
  },
  playOf(scene, panel) {
    const task = taskOf(scene);
    return panel && task && new KitchenPlay(task, panel, scene);
  },
};
