import { holdZone, isInPlace, useZone } from './carry_speed';
import { depthOf, guide, INSIDE, isStacked, nearestGrip, ownGrip, type Guide } from './guide';
import type { Limits } from './limits';
import type { Perception } from './perceiver';
import { Pilot } from './pilot';
import { partOfAxis, placeOnAxis } from './axis_range';
import { approach, clamp, closedEnd, FIRMEST, HOOKED, isHandAxis, postureOf, squeezeOfFingers } from './posture';
import { nextSqueeze } from './squeeze';
import { asksToSqueeze, type Help, type Triple, type Wish } from './wish';
import { ObstacleResponse } from './obstacle_response';

/** An axis of the device, with the fields that aiming needs. */
export interface AimAxis {
  name: string;
  lower: number;
  upper: number;
}

export interface AimConfig {
  /** Largest speed of the aim [m/s]: the virtual arm follows it, and its limits are felt. */
  speed_m_s: number;
  /** Largest lead of the aim over the device [m]: it bounds the force of the arm. */
  leash_m: number;
  /** Closing rates before the first contact, and after it [1/s]. */
  close_per_s: number;
  press_per_s: number;
  open_per_s: number;
  /** Time constant of moving to the grip pose [s]. */
  ease_s: number;
  help: Help;
}

const DEFAULT_AIM: Readonly<AimConfig> = {
  speed_m_s: 0.18,
  leash_m: 0.05,
  close_per_s: 0.8,
  press_per_s: 0.12,
  open_per_s: 2,
  ease_s: 0.25,
  help: 'some',
};

/** Largest speed of the aim of a hand axis [rad/s]. */
const FASTEST_RAD_S = 4;
/** Speed at which a wedged hand draws back [m/s]. */
const WEDGED_M_S = 0.18;
/** The aim of an opening hand leads by this [rad]. */
const OPENING_LEASH_RAD = 0.4;
/** Longer times are divided into steps of this [s]. */
const LONGEST_STEP_S = 0.02;
/** Distance of a hand that is drawn back from the end of x's range [m]. */
const BACK_M = 0.008;
/** A target this far beyond the reach still counts as reachable [m]. */
const EDGE_M = 0.005;
/** The thumb closes by this share while a target is carried: more would tip one that stands free. */
const CARRYING_THUMB = 0.5;
/** An open hand counts as arrived within this distance of the grip [m]: with 300 N/m it presses with 1.5 N there. */
const ARRIVED_M = 0.005;

/** Present positions of hand and aim, and the goal. */
interface HandPath {
  hand: Triple;
  aim: Triple;
  back_m: number;
  goal?: number;
  leaving: boolean;
}

/** The guidance, and its target. `wanted`: the hand is meant to touch it. */
interface TargetGuide extends Guide {
  at?: number;
  wanted: boolean;
}

/** Guidance along a joint: the person moves what is held along its joint; across it the hand stays at the grip. */
function alongJoint(guidance: Guide, grip: Triple, away: Triple): Guide {
  const across = (key: 'y' | 'z'): number | undefined => (Math.abs(away[key]) > 0.5 * Math.hypot(away.x, away.y, away.z) ? undefined : grip[key]);
  return { pace: 1, stretch: guidance.stretch, mayClose: true, y: across('y'), z: across('z') };
}

/**
 * Turns wishes into the aim: one intended position per device axis. The aim is never
 * outside the axes' ranges, never faster than `speed_m_s`, and never leads by more than `leash_m`.
 */
export class AimModel {
  readonly config: AimConfig;
  /** Range of the person's arm and fingers. If a new limit excludes the present position, the aim moves back gently. */
  limits: Limits = {};
  private q: number[] = [];
  private squeezePart = 0;
  private stretch = 0;
  private overruledParts: Partial<Triple> = {};
  private readonly pilot = new Pilot();
  private readonly obstacle = new ObstacleResponse();
  private waits = false;
  private tooFar = false;
  private thumbShare = 1;

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

  /** Degree to which the hand is asked to close, 0 .. 1. */
  get squeeze(): number {
    return Math.min(1, this.squeezePart);
  }

  /**
   * Places, as parts of the ranges, to which the help moved the hand in the last step instead of the
   * requested ones: input by differences continues from there.
   */
  get overruled(): Readonly<Partial<Triple>> {
    return this.overruledParts;
  }

  /** A squeeze is requested, and the hand is still moving to the target. */
  get onItsWay(): boolean {
    return this.waits;
  }

  /** The help does what was asked for: the person need not do anything. */
  get acts(): boolean {
    return this.config.help === 'full' && this.pilot.acts;
  }

  /** The current target is out of reach. */
  get outOfReach(): boolean {
    return this.tooFar;
  }

  /** Starts at the present position, so that nothing jumps when a person begins to steer. */
  begin(q: ArrayLike<number>): void {
    this.q = this.axes.map((axis, i) => clamp(q[i] ?? 0, axis.lower, axis.upper));
    const fingers = this.axes.findIndex((axis) => axis.name === 'finger_flexion');
    this.squeezePart = fingers < 0 ? 0 : squeezeOfFingers(this.q[fingers] ?? 0);
    this.pilot.begin();
    this.obstacle.reset();
  }

  /** The hand demonstrates the task; nobody has taken over yet. */
  get showing(): boolean {
    return this.pilot.shows;
  }

  /** Demonstrates the next action once. */
  show(): void {
    this.pilot.show();
  }

  /** Ends the action of a tap, because nobody presses any more. A carried target is put back. */
  release(): void {
    this.pilot.release();
  }

  /** Opens the hand at once at its place, because nobody closes it any more. The program moves it gently. */
  open(): void {
    this.pilot.drop();
    this.squeezePart = 0;
    this.axes.forEach((axis, i) => {
      if (isHandAxis(axis.name)) this.q[i] = clamp(postureOf(axis.name, 0, this.stretch), axis.lower, axis.upper);
    });
  }

  /**
   * The aim after `dt_s` of any length, independent of the page's frame rate. The perceived state
   * is constant during this time.
   */
  advance(asked: Wish, seen: Perception, dt_s: number): readonly number[] {
    const steps = Math.max(1, Math.ceil(dt_s / LONGEST_STEP_S));
    for (let k = 0; k < steps; k += 1) this.step(asked, seen, dt_s / steps);
    return this.q;
  }

  /** The aim after `dt_s`, which is at most a few hundredths of a second. */
  step(asked: Wish, seen: Perception, dt_s: number): readonly number[] {
    const hand = this.triple((i) => seen.device[i] ?? 0);
    const aim = this.triple((i) => this.q[i] ?? 0);
    const back_m = this.back_m();
    const sight = { ...seen, hand, aim, back_m, closed: this.squeezePart > 0.02, reachable: (grip: Triple) => this.reachable(grip) };
    const { wish, goal, leaving, outOfReach = false, carries = false, holds, pushes = false } = this.pilot.steer(asked, sight, this.config.help, dt_s);
    this.tooFar = outOfReach;
    const help: TargetGuide = pushes ? { pace: 1, stretch: 1, mayClose: true, at: goal, wanted: true } : carries ? { pace: 1, stretch: 0, mayClose: true, at: goal, wanted: true } : this.guideFor(wish, seen, { hand, aim, back_m, goal, leaving });
    const wanted = asksToSqueeze(wish.squeeze);
    this.waits = wanted && this.config.help !== 'none' && !help.mayClose && this.squeezePart === 0;
    const away = help.at === undefined || seen.onJoint ? undefined : seen.awayFromUse?.[help.at];
    const carried = away !== undefined && (holds ?? !isInPlace(away));
    const force = !away ? seen : { ...seen, ...(carried ? holdZone(seen.squeezeLow_n) : useZone(seen.squeezeLow_n, seen.squeezeHigh_n)) };
    this.thumbShare = approach(this.thumbShare, away ? CARRYING_THUMB : 1, dt_s);
    this.squeezePart = nextSqueeze(this.squeezePart, this.waits ? false : wish.squeeze, force, this.config, this.config.help !== 'none', away ? FIRMEST : 1, dt_s);
    this.stretch = (seen.onJoint && !seen.pushes ? HOOKED : 1) * help.stretch;
    // A hand on its way to the target must not touch even that.
    this.obstacle.onState(seen.touches, (wanted && !this.waits) || help.wanted ? help.at : undefined, dt_s);
    this.axes.forEach((axis, i) => {
      const next = isHandAxis(axis.name)
        ? this.handAxis(axis.name, wish, this.stretch, i, seen, dt_s)
        : this.armAxis(axis, wish, help, seen, i, dt_s);
      this.q[i] = clamp(this.within(axis.name, next, i, dt_s), axis.lower, closedEnd(axis.name, axis.upper));
    });
    this.overruledParts = this.overruledBy(help, asked, wish);
    return this.q;
  }

  private within(name: string, next: number, i: number, dt_s: number): number {
    const limited = clamp(next, ...(this.limits[name] ?? [-Infinity, Infinity] as const));
    if (limited === next) return next;
    return approach(this.q[i] ?? 0, limited, (isHandAxis(name) ? FASTEST_RAD_S : this.config.speed_m_s) * dt_s);
  }

  private handAxis(name: string, wish: Wish, stretch: number, i: number, seen: Perception, dt_s: number): number {
    const part = name === 'thumb_flexion' && wish.thumb !== undefined ? wish.thumb : this.squeezePart * (name === 'thumb_flexion' ? this.thumbShare : 1);
    const now = this.q[i] ?? 0;
    const posture = postureOf(name, part, stretch);
    const next = approach(now, posture, FASTEST_RAD_S * dt_s);
    if (this.squeezePart > 0) return next;
    // A finger whose back is blocked by a target would be loaded like a spring, and snap when it is released.
    const device = seen.device[i] ?? now;
    return clamp(next, device - this.obstacle.handLeash(OPENING_LEASH_RAD), device + this.obstacle.handLeash(FASTEST_RAD_S));
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
    if (key === 'y' && help.channel) next = approach(now, clamp(next, ...help.channel), step);
    if (key === 'x' && this.obstacle.drawsBack) next = now - WEDGED_M_S * dt_s;
    const device = seen.device[i] ?? now;
    const [below_m, above_m] = this.obstacle.leash(key, this.config.leash_m);
    return clamp(next, device - below_m, device + above_m);
  }

  private overruledBy(help: Guide, asked: Wish, wish: Wish): Partial<Triple> {
    const parts: Partial<Triple> = {};
    for (const key of ['x', 'y', 'z'] as const) {
      const i = this.axes.findIndex((axis) => axis.name === key);
      const axis = this.axes[i];
      const place = asked.place[key];
      if (!axis || place === undefined || (help[key] === undefined && wish.place[key] !== undefined)) continue;
      const part = partOfAxis(axis, this.q[i] ?? 0);
      // Slow withdrawal from the target is the person's decision, so it is not overruled.
      if (key !== 'x' || place > part) parts[key] = part;
    }
    return parts;
  }

  /** The guidance near the row; without help it only sets the fingers' stretch. */
  private guideFor(wish: Wish, seen: Perception, { hand, aim, back_m, goal, leaving }: HandPath): TargetGuide {
    // Straight fingers push from where the person moves them.
    if (seen.pushes && !leaving) return { pace: 1, stretch: 1, mayClose: true, at: seen.target, wanted: true };
    const own = ownGrip(seen.grips, hand, seen.beside);
    const front = nearestGrip(seen.grips, aim);
    if (own === undefined || front === undefined) return { pace: 1, stretch: 0, mayClose: true, wanted: false };
    // Inside the row the hand's position determines the lane; in front of it, the target in front of the aim does.
    const inside = depthOf(hand.x, back_m, seen.grips[own]!) > INSIDE;
    const at = goal ?? (inside ? own : front);
    const grip = seen.grips[at]!;
    if (this.config.help === 'none' && !leaving && goal === undefined) {
      return { pace: 1, stretch: clamp(4 * depthOf(aim.x, back_m, grip), 0, 1), mayClose: true, at, wanted: false };
    }
    const asked = { x: this.asked('x', wish, aim.x), y: this.asked('y', wish, aim.y) };
    // A cursor that stays near the target does not request another one.
    if (wish.place.y !== undefined && wish.velocity.y === 0 && (depthOf(aim.x, back_m, grip) > 0.2 || asked.x > 0)) asked.y = 0;
    const stacked = !seen.onJoint && isStacked(seen.grips, at);
    const guidance = guide({ aim, hand, back_m, grip, beside: seen.beside, onJoint: seen.onJoint, stacked: stacked && goal !== undefined }, asked, this.squeezePart > 0.02);
    // The person chooses between a target and the one above it.
    if (stacked && goal === undefined && this.squeezePart === 0) guidance.z = undefined;
    // An open hand is meant to touch the target once it is at the grip, not while an obstacle blocks it.
    const arrived = Math.hypot(hand.x - grip.x, hand.y - grip.y) <= ARRIVED_M;
    const wanted = asked.x >= 0 && guidance.x !== undefined && (arrived || this.squeezePart > 0);
    const led = seen.onJoint && this.squeezePart > 0.02 ? seen.awayFromUse?.[at] : undefined;
    if (led) return { ...alongJoint(guidance, grip, led), at, wanted };
    return { ...guidance, mayClose: goal === undefined ? guidance.mayClose : guidance.mayClose && guidance.channel !== undefined, at, wanted };
  }

  private asked(key: 'x' | 'y', wish: Wish, now: number): number {
    if (wish.velocity[key] !== 0) return wish.velocity[key];
    const place = wish.place[key];
    const axis = this.axes.find((candidate) => candidate.name === key);
    if (place === undefined || !axis) return 0;
    const gap = placeOnAxis(axis, place) - now;
    return Math.abs(gap) < 0.003 ? 0 : gap;
  }

  private triple(value: (index: number) => number): Triple {
    const at = (name: keyof Triple): number => {
      const i = this.axes.findIndex((axis) => axis.name === name);
      return i < 0 ? 0 : value(i);
    };
    return { x: at('x'), y: at('y'), z: at('z') };
  }

  private reachable(grip: Triple): boolean {
    const y = this.axes.find((axis) => axis.name === 'y');
    const [lower, upper] = this.limits['y'] ?? [-Infinity, Infinity];
    // The row extends to the edge of the arm's reach.
    return !y || (grip.y >= Math.max(y.lower, lower - EDGE_M) && grip.y <= Math.min(y.upper, upper + EDGE_M));
  }

  private back_m(): number {
    return (this.axes.find((axis) => axis.name === 'x')?.lower ?? 0) + BACK_M;
  }
}
