import type { SceneT } from '../../protocol';
import type { GraspTargets, Position } from '../exercise';
import { ExerciseValues } from '../values';
import { armOf, moved, placedOf, pointOf } from './joint';
import { askedOf, jointOf, metAt, pointMet, usedBodies, type KitchenTask } from './task';

/** Range of the pressing force, relative to the asked force. */
const FIRMLY = { low: 1.1, high: 2.2 } as const;
/** Range of grip force in which a handle is held well [N]. */
const HELD = { low: 2, high: 6 } as const;
/** On a hinge the hand is led along the arc, at most this far ahead [rad, m]. */
const AHEAD_RAD = 0.5;
const AHEAD_M = 0.02;

/** The handles of the bodies that the steps use, as grasp targets. */
export function kitchenTargets(task: KitchenTask, scene: SceneT): GraspTargets {
  const values = new ExerciseValues(scene.valueNames), bodies = usedBodies(task);
  const grips = bodies.map((body) => ({ body, at_m: pointMet(task, scene.bodies[body]!, body, undefined) }));
  const stepAt = (state: Parameters<GraspTargets['wanted']>[0]) => task.steps[Math.min(values.get(state, 'instruction'), task.steps.length - 1)];
  const stepOf = (state: Parameters<GraspTargets['wanted']>[0]) => task.steps[values.get(state, 'instruction')];
  return {
    grips, counter_z_m: undefined, onJoint: true,
    wanted: (state) => bodies.indexOf(stepOf(state)?.body ?? -1),
    letGo(state) {
      const step = stepOf(state);
      return step === undefined || step.verb === 'let_go';
    },
    zone(state) {
      const step = stepOf(state), asked_n = step?.verb === 'press' ? askedOf(step, scene, state) : 0;
      return { squeeze: values.get(state, 'squeeze_n'), ...(asked_n > 0 ? { low: FIRMLY.low * asked_n, high: FIRMLY.high * asked_n } : HELD) };
    },
    met(state, grip) {
      const met = metAt(task, values.get(state, 'instruction')), body = bodies[grip];
      if (!met || body === undefined || met.means === 'grasp' || stepAt(state)?.body !== body) return undefined;
      const triple = ([x, y, z]: readonly [number, number, number]): Position => ({ x, y, z });
      return { at_m: pointMet(task, scene.bodies[body]!, body, met), base_m: triple(met.base_m), pushes: met.means === 'push' ? triple(met.toward) : undefined };
    },
    goesOn: (state) => values.get(state, 'instruction') < task.steps.length - 1,
    /** Path of the handle to the goal of its joint. */
    awayFromUse(state, grip): Position | undefined {
      const step = stepOf(state), body = bodies[grip], joint = body === undefined ? undefined : jointOf(task, body);
      const now = body === undefined ? undefined : placedOf(state.bodies[body]);
      if (!step || !joint || !now || step.body !== body || step.to === undefined) return undefined;
      const { at_m } = this.met?.(state, grip) ?? grips[grip]!, far = joint.type === 'hinge' ? Math.min(AHEAD_RAD, AHEAD_M / Math.max(armOf(now, joint, at_m), 1e-3)) : Infinity;
      const left = step.to - values.get(state, 'joint_q'), ahead = Math.max(-far, Math.min(far, left));
      return pointOf(moved(now, joint, ahead), at_m).sub(pointOf(now, at_m));
    },
  };
}
