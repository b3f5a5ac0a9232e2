import { Quaternion, Vector3 } from 'three';
import type { GraspTargets, Position } from '../exercises/exercise';
import { ExerciseValues } from '../exercises/values';
import { HandPart, type SceneT, type WorldStateT } from '../protocol';
import type { Triple } from './wish';
import { nearestOf } from './guide';
import type { HandContact } from './obstacle_response';

/**
 * Offset of a grasped upright cylinder's axis from the base of a right palm in a handshake posture [m]; the grasp that the
 * simulation holds. A left hand has the mirror image in y.
 */
export const GRIP_FROM_PALM: Readonly<Triple> = { x: 0.049, y: 0.041, z: 0.004 };

/** A point in the plane of the row of targets [m, world: y left, z up]. */
export interface RowPoint { y_m: number; z_m: number }

/** The parts of the program's state that aiming uses. */
export interface Perception {
  /** Device coordinates, in the order of the axes. */
  device: ArrayLike<number>;
  /** Grip pose of every target [m, device coordinates]. */
  grips: readonly Triple[];
  /** Vector from each carried target to the place where it is squeezed [m]; undefined: it is squeezed where it is. */
  awayFromUse?: readonly (Triple | undefined)[];
  /** The targets are on joints: one is moved along its joint while it is held, and never lifted. */
  onJoint?: boolean;
  /** Direction in which the current target is pushed with straight fingers. */
  pushes?: Triple;
  /** Another action follows after the release. */
  goesOn?: boolean;
  /** The side of the hand on which a target is gripped: +1 left (a right hand), -1 right. */
  beside: number;
  /** Summed normal force on the grasped target, and the range in which it is held well [N]. */
  squeeze_n: number;
  squeezeLow_n: number;
  squeezeHigh_n: number;
  /** The current target, an index of `grips`; -1: none. */
  target: number;
  /** The hand must hold nothing now: the step is finished, the row moves, or the task is done. */
  letGo: boolean;
  /** The grip must be eased, and squeezed again later. */
  easesOff?: boolean;
  /** Contacts on the hand. */
  touches: readonly HandContact[];
}

/** A cursor points at a target within this lateral distance of its axis [m]. */
const POINTED_M = 0.055;

/** Position of a body's grip in the world [m]; undefined: the program does not report the body. */
function gripOf(body: WorldStateT['bodies'][number] | undefined, at_m: Position): Triple | undefined {
  const p = body?.positionM, q = body?.orientationXyzw;
  if (!p || !q) return undefined;
  return new Vector3(at_m.x, at_m.y, at_m.z).applyQuaternion(new Quaternion(q.x, q.y, q.z, q.w)).add(p);
}

/** Extracts a Perception from every state. It is made once for a scene. */
export class Perceiver {
  private readonly axes: Record<keyof Triple, number>;
  private readonly values: ExerciseValues;
  private readonly side: number;
  private readonly palmLink: number;

  constructor(scene: SceneT, private readonly targets: GraspTargets) {
    const axis = (name: string): number => scene.axes.findIndex((a) => a.name === name);
    this.axes = { x: axis('x'), y: axis('y'), z: axis('z') };
    this.values = new ExerciseValues(scene.valueNames);
    this.side = scene.rightHand ? 1 : -1;
    // The link of the palm: every axis of the base moves it.
    this.palmLink = scene.capsules.find((capsule) => capsule.part === HandPart.Palm)?.link ?? 0;
  }

  /** Whether the exercise has grasp targets. */
  get hasTargets(): boolean {
    return this.targets.grips.length > 0;
  }

  onState(state: WorldStateT): Perception {
    const { targets, values } = this;
    const zone = targets.zone?.(state) ?? { squeeze: values.get(state, 'squeeze_n'), low: values.get(state, 'squeeze_low_n'), high: values.get(state, 'squeeze_high_n') };
    return {
      device: state.qM,
      grips: this.gripsNow(state),
      awayFromUse: targets.grips.map((_, grip) => targets.awayFromUse?.(state, grip)),
      onJoint: targets.onJoint,
      pushes: targets.met?.(state, Math.max(0, targets.wanted(state)))?.pushes,
      goesOn: targets.goesOn?.(state),
      beside: this.side,
      squeeze_n: zone.squeeze,
      squeezeLow_n: zone.low,
      squeezeHigh_n: zone.high,
      target: targets.wanted(state),
      letGo: targets.letGo(state),
      easesOff: targets.easesOff?.(state),
      touches: state.contacts.map(({ body, forceN }) => ({
        at: targets.grips.findIndex((grip) => grip.body === body), force_n: forceN ?? { x: 0, y: 0, z: 0 },
      })),
    };
  }

  /** The target at a place of the row [m, world]; undefined: none is near. */
  targetAt(state: WorldStateT, { y_m, z_m }: RowPoint): number | undefined {
    return nearestOf(this.targets.grips.map(({ body, at_m }) => gripOf(state.bodies[body], at_m)), z_m, ({ y }) => Math.abs(y - y_m), POINTED_M);
  }

  /** Device coordinates at which the palm's grip would be at a place of the row [m, world]. */
  palmAt(state: WorldStateT, { y_m, z_m }: RowPoint): { y: number; z: number } | undefined {
    const palm = state.links[this.palmLink]?.positionM;
    if (!palm) return undefined;
    return {
      y: y_m - this.side * GRIP_FROM_PALM.y - (palm.y - (state.qS[this.axes.y] ?? 0)),
      z: z_m - GRIP_FROM_PALM.z - (palm.z - (state.qS[this.axes.z] ?? 0)),
    };
  }

  /** Device coordinates at which the palm grips each target. */
  private gripsNow(state: WorldStateT): Triple[] {
    const palm = state.links[this.palmLink]?.positionM;
    if (!palm) return [];
    return this.targets.grips.flatMap(({ body, at_m }, i) => {
      const met = this.targets.met?.(state, i), at = gripOf(state.bodies[body], met?.at_m ?? at_m);
      if (!at) return [];
      if (met) return [{ x: at.x + met.base_m.x, y: at.y + met.base_m.y, z: at.z + met.base_m.z }];
      // The offset between the palm's world position and the avatar's coordinates, wherever the device stands.
      const device = (key: keyof Triple, fromPalm: number): number =>
        at[key] - fromPalm - (palm[key] - (state.qS[this.axes[key]] ?? 0));
      return [{
        x: device('x', GRIP_FROM_PALM.x), y: device('y', this.side * GRIP_FROM_PALM.y), z: device('z', GRIP_FROM_PALM.z),
      }];
    });
  }
}
