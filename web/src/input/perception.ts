import { HandPart, type SceneT, type WorldStateT } from '../protocol';
import type { Perception } from './aim_model';
import type { Triple } from './wish';

/**
 * Axis of a grasped upright bottle from the base of a right palm in a handshake [m]; the grasp the
 * physics holds. A left hand takes the mirror image in y.
 */
export const GRIP_FROM_PALM: Readonly<Triple> = { x: 0.049, y: 0.041, z: 0.004 };

interface Grip {
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
  private readonly values: { now: number; low: number; high: number };
  private readonly side: number;
  private readonly palmLink: number;

  constructor(scene: SceneT) {
    const bodies = scene.bodies.map((body) => String(body.name));
    this.grips = describedDispensers(scene.exerciseJson)
      .map(({ body, grip_m: grip = [] }) => ({
        body: bodies.indexOf(String(body)),
        at: { x: grip[0] ?? 0, y: grip[1] ?? 0, z: grip[2] ?? 0 },
      }))
      .filter((grip) => grip.body >= 0);
    const axis = (name: string): number => scene.axes.findIndex((a) => a.name === name);
    this.axes = { x: axis('x'), y: axis('y'), z: axis('z') };
    const value = (name: string): number => scene.valueNames.indexOf(name);
    this.values = { now: value('squeeze_n'), low: value('squeeze_low_n'), high: value('squeeze_high_n') };
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
