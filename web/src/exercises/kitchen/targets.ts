import type { SceneT } from '../../protocol';
import type { GraspTargets, Position } from '../exercise';
import { ExerciseValues } from '../values';
import { moved, placedOf, pointOf } from './joint';
import { handleOf, jointOf, usedBodies, type KitchenTask } from './task';

/** Between these a handle is held well [N]. */
const HELD = { low_n: 2, high_n: 6 } as const;
/** On a hinge the hand is led along the arc, so far ahead at most [rad]. */
const AHEAD_RAD = 0.15;

/** The handles of the bodies that the steps use. */
export function kitchenTargets(task: KitchenTask, scene: SceneT): GraspTargets {
  const values = new ExerciseValues(scene.valueNames), bodies = usedBodies(task);
  const grips = bodies.map((body) => ({ body, at_m: handleOf(scene.bodies[body]!).at_m }));
  const stepOf = (state: Parameters<GraspTargets['wanted']>[0]) => task.steps[values.get(state, 'instruction')];
  return {
    grips, counter_z_m: undefined, onJoint: true,
    wanted: (state) => bodies.indexOf(stepOf(state)?.body ?? -1),
    letGo(state) {
      const step = stepOf(state);
      return step === undefined || step.verb === 'let_go';
    },
    zone: () => HELD,
    /** The way of the handle to where its joint is to be. */
    awayFromUse(state, grip): Position | undefined {
      const step = stepOf(state), body = bodies[grip], joint = body === undefined ? undefined : jointOf(task, body);
      const now = body === undefined ? undefined : placedOf(state.bodies[body]);
      if (!step || !joint || !now || step.body !== body || step.to === undefined) return undefined;
      const left = step.to - values.get(state, 'joint_q'), ahead = joint.type === 'hinge' ? Math.max(-AHEAD_RAD, Math.min(AHEAD_RAD, left)) : left;
      const { at_m } = grips[grip]!;
      return pointOf(moved(now, joint, ahead), at_m).sub(pointOf(now, at_m));
    },
  };
}
