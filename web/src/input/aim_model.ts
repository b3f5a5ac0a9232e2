import { depthOf, guide, nearestGrip, type Guide } from './guide';
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
  /** Grip pose of every dispenser [m, device coordinates]. */
  grips: readonly Triple[];
  /** Which side of the hand a dispenser is gripped on: +1 left (a right hand), -1 right. */
  beside: number;
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
  close_per_s: 0.8,
  press_per_s: 0.12,
  open_per_s: 2,
  ease_s: 0.25,
  assist: true,
};

/** Hand axes are never asked to move faster [rad/s]. */
const FASTEST_RAD_S = 4;
/** A hand drawn back is this far from the end of x's range [m]. */
const BACK_M = 0.008;
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
  private stretch = 0;
  private overruledParts: Partial<Triple> = {};

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

  /**
   * Where the help took the hand in the last step instead of to the place that was asked for, as parts
   * of the ranges: whoever steers by differences goes on from there.
   */
  get overruled(): Readonly<Partial<Triple>> {
    return this.overruledParts;
  }

  /** Takes over where the hand is, so that nothing jumps when a person begins to steer. */
  begin(q: ArrayLike<number>): void {
    this.q = this.axes.map((axis, i) => clamp(q[i] ?? 0, axis.lower, axis.upper));
    const fingers = this.axes.findIndex((axis) => axis.name === 'finger_flexion');
    this.squeezePart = fingers < 0 ? 0 : squeezeOfFingers(this.q[fingers] ?? 0);
  }

  /** Nobody closes the hand any more: it is open at once, where it is. The program makes it a gentle move. */
  open(): void {
    this.squeezePart = 0;
    this.axes.forEach((axis, i) => {
      if (isHandAxis(axis.name)) this.q[i] = clamp(postureOf(axis.name, 0, this.stretch), axis.lower, axis.upper);
    });
  }

  /** The aim `dt_s` later. */
  step(wish: Wish, seen: Perception, dt_s: number): readonly number[] {
    const help = this.guideFor(wish, seen);
    const wanted = typeof wish.squeeze === 'number' ? wish.squeeze > 0.05 : wish.squeeze;
    const squeeze = wanted && this.config.assist && !help.mayClose && this.squeezePart === 0 ? false : wish.squeeze;
    this.squeezePart = this.nextSqueeze(squeeze, seen, dt_s);
    this.stretch = help.stretch;
    this.axes.forEach((axis, i) => {
      const next = isHandAxis(axis.name)
        ? this.handAxis(axis.name, wish, help.stretch, this.q[i] ?? 0, dt_s)
        : this.armAxis(axis, wish, help, seen, i, dt_s);
      this.q[i] = clamp(next, axis.lower, axis.upper);
    });
    this.overruledParts = this.overruledBy(help, wish);
    return this.q;
  }

  private handAxis(name: string, wish: Wish, stretch: number, now: number, dt_s: number): number {
    const part = name === 'thumb_flexion' && wish.thumb !== undefined ? wish.thumb : this.squeezePart;
    return approach(now, postureOf(name, part, stretch), FASTEST_RAD_S * dt_s);
  }

  private armAxis(axis: AimAxis, wish: Wish, help: Guide, seen: Perception, i: number, dt_s: number): number {
    const now = this.q[i] ?? 0;
    const key = axis.name as keyof Triple;
    if (key !== 'x' && key !== 'y' && key !== 'z') return now;
    const step = this.config.speed_m_s * dt_s;
    const velocity = clamp(wish.velocity[key], -this.config.speed_m_s, this.config.speed_m_s);
    const place = wish.place[key];
    const eased = help[key];
    const pace = key === 'x' ? help.pace : 1;
    let next = now + velocity * pace * dt_s;
    if (place !== undefined) next = approach(now, placeOnAxis(axis, place), pace * step);
    if (eased !== undefined && velocity * (eased - now) >= 0) {
      const part = 1 - Math.exp(-dt_s / this.config.ease_s);
      next = now + clamp((eased - now) * part, -step, step);
    }
    const device = seen.device[i] ?? now;
    return clamp(next, device - this.config.leash_m, device + this.config.leash_m);
  }

  private overruledBy(help: Guide, wish: Wish): Partial<Triple> {
    const parts: Partial<Triple> = {};
    for (const key of ['x', 'y', 'z'] as const) {
      const i = this.axes.findIndex((axis) => axis.name === key);
      const axis = this.axes[i];
      const place = wish.place[key];
      if (!axis || place === undefined || help[key] === undefined) continue;
      const part = partOfAxis(axis, this.q[i] ?? 0);
      // Drawing back from the dispenser is what the person decides, however slowly.
      if (key !== 'x' || place > part) parts[key] = part;
    }
    return parts;
  }

  /** What the help near the row says; nothing of it but the fingers' stretch when it is off. */
  private guideFor(wish: Wish, seen: Perception): Guide {
    const at = { x: this.value('x'), y: this.value('y'), z: this.value('z') };
    const grip = nearestGrip(seen.grips, at.y);
    if (!grip) return { pace: 1, stretch: 0, mayClose: true };
    const back_m = (this.axes.find((axis) => axis.name === 'x')?.lower ?? 0) + BACK_M;
    if (!this.config.assist) return { pace: 1, stretch: clamp(4 * depthOf(at.x, back_m, grip), 0, 1), mayClose: true };
    const asked = { x: this.asked('x', wish, at.x), y: this.asked('y', wish, at.y) };
    // A cursor that stays near the dispenser does not ask for another one.
    if (wish.place.y !== undefined && wish.velocity.y === 0 && (depthOf(at.x, back_m, grip) > 0.2 || asked.x > 0)) asked.y = 0;
    return guide(at, back_m, grip, seen.beside, asked, this.squeezePart > 0.02);
  }

  private asked(key: 'x' | 'y', wish: Wish, now: number): number {
    if (wish.velocity[key] !== 0) return wish.velocity[key];
    const place = wish.place[key];
    const axis = this.axes.find((candidate) => candidate.name === key);
    if (place === undefined || !axis) return 0;
    const gap = placeOnAxis(axis, place) - now;
    return Math.abs(gap) < 0.003 ? 0 : gap;
  }

  private value(name: keyof Triple): number {
    return this.q[this.axes.findIndex((axis) => axis.name === name)] ?? 0;
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

/** How far along an axis's range a position is, -1 .. 1. */
export function partOfAxis(axis: Pick<AimAxis, 'lower' | 'upper'>, q: number): number {
  return (2 * q - axis.lower - axis.upper) / (axis.upper - axis.lower);
}

/** Position at a part -1 .. 1 of an axis's range. */
export function placeOnAxis(axis: AimAxis, part: number): number {
  const middle = (axis.lower + axis.upper) / 2;
  return middle + (clamp(part, -1, 1) * (axis.upper - axis.lower)) / 2;
}
