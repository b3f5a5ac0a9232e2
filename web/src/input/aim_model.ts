import { approach, clamp, isHandAxis, postureOf, squeezeOfFingers } from './posture';
import type { Triple, Wish } from './wish';

/** An axis of the device as far as aiming needs it. */
export interface AimAxis {
  name: string;
  lower: number;
  upper: number;
}

/** What the program says of the hand, as far as aiming looks at it. */
export interface Perception {
  /** Device coordinates, in the order of the axes. */
  device: ArrayLike<number>;
  /** Grip pose of the dispenser beside the palm [m, device coordinates]; undefined: none near. */
  grip?: Triple;
  /** Summed normal force on the grasped dispenser and the zone in which it pours well [N]. */
  squeeze_n: number;
  squeezeLow_n: number;
  squeezeHigh_n: number;
}

export interface AimConfig {
  /** Fastest move of the aim [m/s]: the virtual arm follows, and its limits are felt. */
  speed_m_s: number;
  /** Farthest that the aim may run ahead of the device [m]: bounds the force of the arm. */
  leash_m: number;
  /** Closing before anything is touched, and after [1/s]. */
  close_per_s: number;
  press_per_s: number;
  open_per_s: number;
  /** Time constant of easing to the grip pose [s]. */
  ease_s: number;
  /** Steady the squeeze and ease to the grip. */
  assist: boolean;
}

export const DEFAULT_AIM: Readonly<AimConfig> = {
  speed_m_s: 0.18,
  leash_m: 0.05,
  close_per_s: 0.75,
  press_per_s: 0.12,
  open_per_s: 2,
  ease_s: 0.25,
  assist: true,
};

/** Above this a dispenser is felt: closing turns into pressing [N]. */
const TOUCH_N = 0.3;

/**
 * Where the person wants the hand to be. Wishes come in, positions per device axis go out: never
 * outside the axes' ranges, never faster than `speed_m_s`, never farther ahead than `leash_m`.
 */
export class AimModel {
  readonly config: AimConfig;
  private q: number[] = [];
  private squeezePart = 0;

  constructor(
    private readonly axes: readonly AimAxis[],
    config: Partial<AimConfig> = {},
  ) {
    this.config = { ...DEFAULT_AIM, ...config };
    this.q = axes.map((axis) => clamp(0, axis.lower, axis.upper));
  }

  /** The aim, one position per device axis. */
  get aim(): readonly number[] {
    return this.q;
  }

  /** How far the hand is asked to close, 0 .. 1. */
  get squeeze(): number {
    return this.squeezePart;
  }

  /** Takes over where the hand is, so that nothing jumps when a person begins to steer. */
  begin(q: ArrayLike<number>): void {
    this.q = this.axes.map((axis, i) => clamp(q[i] ?? 0, axis.lower, axis.upper));
    const fingers = this.axes.findIndex((axis) => axis.name === 'finger_flexion');
    this.squeezePart = fingers < 0 ? 0 : squeezeOfFingers(this.q[fingers] ?? 0);
  }

  /** The aim `dt_s` later. */
  step(wish: Wish, seen: Perception, dt_s: number): readonly number[] {
    this.squeezePart = this.nextSqueeze(wish.squeeze, seen, dt_s);
    this.axes.forEach((axis, i) => {
      const wanted = isHandAxis(axis.name)
        ? this.handAxis(axis.name, wish, this.q[i] ?? 0, dt_s)
        : this.armAxis(axis, wish, seen, i, dt_s);
      this.q[i] = clamp(wanted, axis.lower, axis.upper);
    });
    return this.q;
  }

  private handAxis(name: string, wish: Wish, now: number, dt_s: number): number {
    const part =
      name === 'thumb_flexion' && wish.thumb !== undefined ? wish.thumb : this.squeezePart;
    // A hand that was half closed elsewhere opens at the same pace as everything else.
    const fastest_rad_s = 4;
    return approach(now, postureOf(name, part), fastest_rad_s * dt_s);
  }

  private armAxis(axis: AimAxis, wish: Wish, seen: Perception, i: number, dt_s: number): number {
    const now = this.q[i] ?? 0;
    const key = axis.name as keyof Triple;
    if (key !== 'x' && key !== 'y' && key !== 'z') return now;
    const step = this.config.speed_m_s * dt_s;
    const velocity = clamp(wish.velocity[key], -this.config.speed_m_s, this.config.speed_m_s);
    let wanted = now + velocity * dt_s;
    const place = wish.place[key];
    const asked = place === undefined ? undefined : placeOnAxis(axis, place);
    if (asked !== undefined) wanted = approach(now, asked, step);
    wanted = this.eased(key, wanted, velocity, asked, seen, dt_s);
    const device = seen.device[i] ?? now;
    return clamp(wanted, device - this.config.leash_m, device + this.config.leash_m);
  }

  /** Eases x and y to the grip pose, unless the person asks to go elsewhere. */
  private eased(
    key: keyof Triple, wanted: number, velocity: number, asked: number | undefined,
    seen: Perception, dt_s: number,
  ): number {
    if (!this.config.assist || !seen.grip || key === 'z') return wanted;
    const gap = seen.grip[key] - wanted;
    if (velocity * gap < 0) return wanted;
    if (asked !== undefined && Math.abs(asked - seen.grip[key]) > LETS_GO_M) return wanted;
    const part = 1 - Math.exp(-dt_s / this.config.ease_s);
    return wanted + clamp(gap * part, -this.config.speed_m_s * dt_s, this.config.speed_m_s * dt_s);
  }

  private nextSqueeze(asked: boolean | number, seen: Perception, dt_s: number): number {
    const { close_per_s, press_per_s, open_per_s, assist } = this.config;
    const now = this.squeezePart;
    if (typeof asked === 'number') return approach(now, clamp(asked, 0, 1), open_per_s * dt_s);
    if (!asked) return approach(now, 0, open_per_s * dt_s);
    if (seen.squeeze_n < TOUCH_N) return approach(now, 1, close_per_s * dt_s);
    const middle_n = (seen.squeezeLow_n + seen.squeezeHigh_n) / 2;
    // In the middle of the zone a person who finds it hard to stop is stopped; a firm grip softens.
    if (assist && seen.squeeze_n > seen.squeezeHigh_n) return approach(now, 0, press_per_s * dt_s);
    if (assist && middle_n > 0 && seen.squeeze_n >= middle_n) return now;
    return approach(now, 1, press_per_s * dt_s);
  }
}

/** A cursor farther than this from the grip is not held by it [m]. */
const LETS_GO_M = 0.045;

/** Position at a part -1 .. 1 of an axis's range. */
export function placeOnAxis(axis: AimAxis, part: number): number {
  const middle = (axis.lower + axis.upper) / 2;
  return middle + (clamp(part, -1, 1) * (axis.upper - axis.lower)) / 2;
}
