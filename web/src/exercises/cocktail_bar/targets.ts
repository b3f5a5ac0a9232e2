import { Quaternion, Vector3 } from 'three';
import type { SceneT, WorldStateT } from '../../protocol';
import type { GraspTargets, Position } from '../exercise';
import { ExerciseValues } from '../values';
import { DRIP_L_S, Stage, type Bar, type BarDispenser } from './bar';

/** The flow continues for this long after the hand opens, and after it eases its grip on a carried bottle [s]. */
const OPENS_S = 0.05;
const EASES_S = 0.5;
/** A carried dispenser is squeezed with its nozzle this far above the glass [m]. */
const OVER_GLASS_M = 0.02;

/** A slowing stroke still gives about its flow times this [s]. */
const STROKE_S = 1.3;
/** Whether a stroke reaches the line is decided this far below the line's tolerance; a drink may be off by the second amount [l]. */
const DECIDES_L = 0.0015;
const OFF_L = 0.001;
/** Air has come back into a bottle when this share of its stroke is left. */
const BACK = 0.2;

/**
 * Eases a grip whose stroke would end between the line's tolerance and the line: there the program takes the step as
 * finished, and a new stroke would no longer count.
 */
class Breath {
  private at_l = 0;   // the stroke when it was eased; 0: it is not
  private most_l_s = 0;   // largest flow of the stroke

  constructor(private readonly bar: Bar, private readonly values: ExerciseValues) {}

  eases(state: WorldStateT): boolean {
    const { bar, values } = this, value = (name: string): number => values.get(state, name);
    if (value('stage') === Stage.Breathe) return true;
    if (value('stage') > Stage.Pour) this.at_l = 0;
    const flow_l_s = value('flow_l_s'), slows = flow_l_s < this.most_l_s;
    this.most_l_s = flow_l_s > 0 ? Math.max(this.most_l_s, flow_l_s) : 0;
    if (this.at_l > 0) {
      if (value('pressed_l') < BACK * this.at_l) this.at_l = 0;
      return this.at_l > 0;
    }
    const step = bar.drinks[value('drink')]?.steps[value('step')], left_l = value('asked_l') - value('poured_l');
    if (value('stage') !== Stage.Pour || !step || left_l <= step.tolerance_l || left_l > step.tolerance_l + DECIDES_L) return false;
    if (slows && STROKE_S * flow_l_s < left_l - OFF_L) this.at_l = value('pressed_l');
    return this.at_l > 0;
  }
}

/** The dispensers as grasp targets. */
export function barTargets(bar: Bar, scene: SceneT): GraspTargets {
  const values = new ExerciseValues(scene.valueNames), breath = new Breath(bar, values);
  const bodies = scene.bodies.map(({ name }) => String(name));
  const grips = bar.dispensers.map(({ body, grip_m: [x, y, z] }, dispenser) => ({ dispenser, body: bodies.indexOf(body), at_m: { x, y, z } }))
    .filter(({ body }) => body >= 0);
  const isFree = (state: WorldStateT): boolean => bar.dispensers[values.get(state, 'target_dispenser', -1)]?.free ?? false;
  return {
    grips, counter_z_m: bar.counter_z_m,
    wanted: (state) => grips.findIndex(({ dispenser }) => dispenser === values.get(state, 'target_dispenser', -1)),
    letGo: (state) => isToLetGo(values, state, isFree(state) ? EASES_S : OPENS_S),
    // A carried bottle would fall.
    easesOff: (state) => !isFree(state) && breath.eases(state),
    awayFromUse(state, grip) {
      const dispenser = bar.dispensers[grips[grip]?.dispenser ?? -1];
      return dispenser?.free ? nozzleToGlass(bar, dispenser, state.bodies[grips[grip]!.body], state.bodies[bodies.indexOf(bar.glass.body)]) : undefined;
    },
  };
}

type Body = WorldStateT['bodies'][number] | undefined;

/** Vector from a dispenser's nozzle to its place over the glass [m]. */
function nozzleToGlass(bar: Bar, { nozzle_m }: BarDispenser, dispenser: Body, glass: Body): Position | undefined {
  const at = dispenser?.positionM, turn = dispenser?.orientationXyzw, goal = glass?.positionM;
  if (!at || !turn || !goal) return undefined;
  const nozzle = new Vector3(...nozzle_m).applyQuaternion(new Quaternion(turn.x, turn.y, turn.z, turn.w)).add(at);
  return { x: goal.x - nozzle.x, y: goal.y - nozzle.y, z: goal.z + bar.glass.height_m / 2 + OVER_GLASS_M - nozzle.z };
}

/** Whether the hand must let go. A step may end a tolerance early, and the help fills it to the line. Nothing is held after it. */
function isToLetGo(values: ExerciseValues, state: WorldStateT, lag_s: number): boolean {
  const stage = values.get(state, 'stage');
  if (stage !== Stage.LetGo) return stage > Stage.LetGo && stage !== Stage.Breathe;
  const flow_l_s = values.get(state, 'flow_l_s');
  return flow_l_s < DRIP_L_S || values.get(state, 'poured_l') + flow_l_s * lag_s >= values.get(state, 'asked_l');
}
