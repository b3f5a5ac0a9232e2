import { HandPart, type SceneT, type WorldStateT } from '../protocol';
import type { Perception } from './aim_model';
import type { Triple } from './wish';

/**
 * Axis of a grasped upright bottle from the base of a right palm in a handshake [m]; the grasp the
 * physics holds. A left hand takes the mirror image in y.
 */
export const GRIP_FROM_PALM: Readonly<Triple> = { x: 0.049, y: 0.041, z: 0.004 };

/** A place in the plane in which the row of dispensers stands [m, world: y left, z up]. */
export interface RowPoint { y_m: number; z_m: number }

/** A cursor this far sideways from a dispenser's axis is on it [m]. */
const POINTED_M = 0.055;
/** Of values.stage, docs/exercises.md: let go; those after it hold nothing either. */
const LET_GO = 3;
/** In parts of the tolerance. */
const BEFORE_LINE = 0.3;

interface Grip {
  dispenser: number;
  body: number;
  /** Grip centre in the dispenser's frame [m]; dispensers stand upright. */
  at: Triple;
}

interface DescribedDispenser {
  body?: string;
  grip_m?: number[];
}

/** Finds in every state what aiming looks at. Made once for a scene. */
export class Perceiver {
  private readonly grips: Grip[];
  private readonly axes: Record<keyof Triple, number>;
  private readonly values: { now: number; low: number; high: number; target: number; stage: number; poured: number; asked: number; tolerance: number; flow: number };
  private readonly side: number;
  private readonly palmLink: number;

  constructor(scene: SceneT) {
    const bodies = scene.bodies.map((body) => String(body.name));
    this.grips = describedDispensers(scene.exerciseJson)
      .map(({ body, grip_m: grip = [] }, dispenser) => ({
        dispenser,
        body: bodies.indexOf(String(body)),
        at: { x: grip[0] ?? 0, y: grip[1] ?? 0, z: grip[2] ?? 0 },
      }))
      .filter((grip) => grip.body >= 0);
    const axis = (name: string): number => scene.axes.findIndex((a) => a.name === name);
    this.axes = { x: axis('x'), y: axis('y'), z: axis('z') };
    const value = (name: string): number => scene.valueNames.indexOf(name);
    this.values = { now: value('squeeze_n'), low: value('squeeze_low_n'), high: value('squeeze_high_n'), target: value('target_dispenser'), stage: value('stage'), poured: value('poured_l'), asked: value('asked_l'), tolerance: value('tolerance_l'), flow: value('flow_l_s') };
    this.side = scene.rightHand ? 1 : -1;
    // The link that carries the palm: every axis of the base moves it.
    this.palmLink = scene.capsules.find((capsule) => capsule.part === HandPart.Palm)?.link ?? 0;
  }

  see(state: WorldStateT): Perception {
    const value = (index: number): number => (index < 0 ? 0 : (state.values[index] ?? 0));
    return {
      device: state.qM,
      grips: this.gripsNow(state),
      beside: this.side,
      squeeze_n: value(this.values.now),
      squeezeLow_n: value(this.values.low),
      squeezeHigh_n: value(this.values.high),
      target: this.values.target < 0 ? -1 : this.grips.findIndex((grip) => grip.dispenser === value(this.values.target)),
      letGo: this.values.stage >= 0 && this.letGo(value),
      touches: state.contacts.map(({ body, forceN }) => ({
        at: this.grips.findIndex((grip) => grip.body === body), force_n: forceN ?? { x: 0, y: 0, z: 0 },
      })),
    };
  }

  /** A step may end a tolerance early: help goes on to just before the line, less what still runs while a hand opens. */
  private letGo(value: (index: number) => number): boolean {
    const { stage, poured, asked, tolerance, flow } = this.values;
    if (value(stage) !== LET_GO) return value(stage) > LET_GO;
    return value(flow) === 0 || value(poured) >= value(asked) - BEFORE_LINE * value(tolerance);
  }

  /** The dispenser at a place of the row [m, world y]; undefined: none is near. */
  bottleAt(state: WorldStateT, y_m: number): number | undefined {
    const off_m = this.grips.map(({ body, at }) => Math.abs((state.bodies[body]?.positionM?.y ?? Infinity) + at.y - y_m));
    const nearest = off_m.indexOf(Math.min(...off_m));
    return nearest >= 0 && off_m[nearest]! <= POINTED_M ? nearest : undefined;
  }

  /** Device coordinates at which what the palm grips would be at a place of the row [m, world]. */
  palmAt(state: WorldStateT, { y_m, z_m }: RowPoint): { y: number; z: number } | undefined {
    const palm = state.links[this.palmLink]?.positionM;
    if (!palm) return undefined;
    return {
      y: y_m - this.side * GRIP_FROM_PALM.y - (palm.y - (state.qS[this.axes.y] ?? 0)),
      z: z_m - GRIP_FROM_PALM.z - (palm.z - (state.qS[this.axes.z] ?? 0)),
    };
  }

  /** Device coordinates at which the palm grips each dispenser. */
  private gripsNow(state: WorldStateT): Triple[] {
    const palm = state.links[this.palmLink]?.positionM;
    if (!palm) return [];
    return this.grips.flatMap(({ body, at }) => {
      const position = state.bodies[body]?.positionM;
      if (!position) return [];
      // The palm's place in the world against the avatar's coordinates: wherever the device stands.
      const device = (key: keyof Triple, fromPalm: number): number =>
        position[key] + at[key] - fromPalm - (palm[key] - (state.qS[this.axes[key]] ?? 0));
      return [{
        x: device('x', GRIP_FROM_PALM.x), y: device('y', this.side * GRIP_FROM_PALM.y), z: device('z', GRIP_FROM_PALM.z),
      }];
    });
  }
}

function describedDispensers(json: unknown): DescribedDispenser[] {
  try {
    const parsed = JSON.parse(String(json ?? '')) as { dispensers?: unknown };
    return Array.isArray(parsed.dispensers) ? (parsed.dispensers as DescribedDispenser[]) : [];
  } catch {
    return [];
  }
}
