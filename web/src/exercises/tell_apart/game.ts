// Comparing two bottles in the game: the bottles are grasp targets; the panel is the card.
import type { GraspTargets } from '../exercise';
import type { ExerciseGame } from '../exercise_game';
import { ExerciseValues } from '../values';
import { Instruction, pairOf } from './bottles';
import { PairPlay } from './play';

/** Each bottle is squeezed up to its mark, and released; which one answers is the person's choice. */
export const game: ExerciseGame = {
  targetsOf(scene): GraspTargets | undefined {
    const pair = pairOf(scene), values = new ExerciseValues(scene.valueNames);
    return pair && {
      grips: pair.bottles.map(({ body }) => ({ body, at_m: { x: 0, y: 0, z: 0 } })), counter_z_m: undefined,
      wanted: (state) => values.get(state, 'wanted'),
      letGo: (state) => ![Instruction.First, Instruction.Second, Instruction.Hold, Instruction.Answer].some((step) => values.get(state, 'instruction') === step),
      goesOn: (state) => values.get(state, 'wanted') >= 0,
      zone: (state) => ({ squeeze: values.get(state, 'pressed'), low: values.get(state, 'pressed_low'), high: values.get(state, 'pressed_high') }),
    };
  },
  playOf: (scene, panel) => (panel && pairOf(scene) ? new PairPlay(panel, scene) : undefined),
};
