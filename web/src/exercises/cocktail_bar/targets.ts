import type { SceneT, WorldStateT } from '../../protocol';
import type { GraspTargets } from '../exercise';
import { ExerciseValues } from '../values';
import { Stage, type Bar } from './bar';

/** The help goes on to so many tolerances before the line: a hand that opens lets some more run. */
const BEFORE_LINE = 0.3;

/** The dispensers, as what the hand grasps. */
export function barTargets(bar: Bar, scene: SceneT): GraspTargets {
  const values = new ExerciseValues(scene.valueNames);
  const bodies = scene.bodies.map(({ name }) => String(name));
  const grips = bar.dispensers.map(({ body, grip_m: [x, y, z] }, dispenser) => ({ dispenser, body: bodies.indexOf(body), at_m: { x, y, z } }))
    .filter(({ body }) => body >= 0);
  return {
    grips, counter_z_m: bar.counter_z_m,
    wanted: (state) => grips.findIndex(({ dispenser }) => dispenser === values.get(state, 'target_dispenser', -1)),
    letGo: (state) => isToLetGo(values, state),
  };
}

/** A step may end a tolerance early, and the help fills it further. After it nothing is held either. */
function isToLetGo(values: ExerciseValues, state: WorldStateT): boolean {
  const stage = values.get(state, 'stage');
  if (stage !== Stage.LetGo) return stage > Stage.LetGo;
  return values.get(state, 'flow_l_s') === 0 || values.get(state, 'poured_l') >= values.get(state, 'asked_l') - BEFORE_LINE * values.get(state, 'tolerance_l');
}
