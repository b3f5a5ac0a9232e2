import type { SceneT } from '../../protocol';
import type { GraspTargets } from '../exercise';
import { ExerciseValues } from '../values';
import { Instruction, type Grip } from './grip';

/** The grip as a grasp target: it is squeezed into the current band, and released after the band was held. */
export function gripTargets(grip: Grip, scene: SceneT): GraspTargets {
  const values = new ExerciseValues(scene.valueNames);
  return {
    grips: [{ body: grip.body, at_m: { x: 0, y: 0, z: 0 } }], counter_z_m: undefined,
    wanted: (state) => values.get(state, 'instruction') === Instruction.Done ? -1 : 0,
    letGo: (state) => values.get(state, 'instruction') >= Instruction.LetGo,
    zone: (state) => ({ squeeze: values.get(state, 'squeeze_n'), low: values.get(state, 'goal_low_n'), high: values.get(state, 'goal_high_n') }),
  };
}
