// The balloon as a display of the task: its basket's height is the squeeze, and two ribbons are the band. Pure.
import type { WorldStateT } from '../../protocol';
import type { ExerciseValues } from '../values';
import { Instruction } from './grip';

/** Squeeze at which the balloon is at its highest [N]. The strongest band ends below. */
const FULL_N = 8;

/** Flow at which the burner's flame is as high as it is modelled [ml/s]. */
const FULL_ML_S = 2;

/** Height of the balloon, 0 .. 1. */
export const heightOf = (force_n: number): number => Math.min(1, Math.max(0, force_n / FULL_N));

/** The next action: to the grip, up, down, stay, open the hand; 'none' when all is done. */
export type Cue = 'grip' | 'up' | 'down' | 'stay' | 'open' | 'none';

const CUES: Readonly<Record<number, Cue>> = {
  [Instruction.Reach]: 'grip', [Instruction.More]: 'up', [Instruction.Hold]: 'stay', [Instruction.Less]: 'down',
  [Instruction.LetGo]: 'open', [Instruction.Done]: 'none',
};

export interface Flight {
  readonly cue: Cue;
  readonly height: number;                                                  // height of the balloon, 0 .. 1
  readonly band: { readonly low: number; readonly high: number } | null;    // goal range of the height
  readonly flame: number;                                                   // burner flame, 0 .. 1: the flow out of the grip
  readonly held: number;                                                    // held share of the band's time, 0 .. 1
  readonly lit: number;                                                     // number of finished bands
  readonly bands: number;
}

/** @param hold_s holding time of a band */
export function flightOf(values: ExerciseValues, state: Pick<WorldStateT, 'values'>, hold_s: number): Flight {
  const cue = CUES[values.get(state, 'instruction')] ?? 'none';
  // While the hand must open, the goal is zero squeeze.
  const banded = cue !== 'open' && cue !== 'none';
  return {
    cue, height: heightOf(values.get(state, 'squeeze_n')),
    band: banded ? { low: heightOf(values.get(state, 'goal_low_n')), high: heightOf(values.get(state, 'goal_high_n')) } : null,
    flame: Math.sqrt(Math.min(1, Math.max(0, values.get(state, 'flow_ml_s') / FULL_ML_S))),
    held: Math.min(1, values.get(state, 'held_s') / Math.max(hold_s, 1e-6)),
    lit: values.get(state, 'bands_done'), bands: values.get(state, 'bands'),
  };
}
