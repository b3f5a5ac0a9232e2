import type { Triple } from './wish';

/** Largest speed of a carried target, and rate at which the hand slows down near its goal [m/s, 1/s]. */
const SPEED_M_S = 0.12;
const SLOWS_PER_S = 4;
/** Tolerances for the aim, and for the hand, which a weight pulls down [m]. */
const THERE_M = 0.004;
const HAND_THERE_M = 0.015;
/** A target is held for this long before the next phase [s]. */
const SETTLED_S = 0.3;
/** A grip without force for this long is lost [s]. */
const LOST_S = 0.5;
const LOST_N = 0.3;
/** A move that takes longer is given up: it is blocked by a limit of the person's reach [s]. */
const GIVES_UP_S = 8;
/** Grip force while carrying, relative to the lower end of the squeeze zone: enough to hold, too little to squeeze anything out. */
const HOLD = [0.76, 0.86] as const;
/** Grip force while squeezing: at this share of the zone, from its lower end. */
const GENTLE = 0.3;
/** A carried target is squeezed within this distance of its place [m]. */
const OVER_M = 0.015;

/** Range of grip force while carrying, in which nothing is squeezed out [N]. */
export function holdZone(squeezeLow_n: number): { squeezeLow_n: number; squeezeHigh_n: number } {
  return { squeezeLow_n: HOLD[0] * squeezeLow_n, squeezeHigh_n: HOLD[1] * squeezeLow_n };
}

/** Range of grip force while squeezing [N]. It is low, because the flow ends only after the grip has eased. */
export function useZone(squeezeLow_n: number, squeezeHigh_n: number): { squeezeLow_n: number; squeezeHigh_n: number } {
  return { squeezeLow_n, squeezeHigh_n: squeezeLow_n + GENTLE * (squeezeHigh_n - squeezeLow_n) };
}

/** Whether a carried target is at the place where it is squeezed. */
export function isInPlace(away: Triple): boolean {
  return Math.hypot(away.x, away.y) <= OVER_M;
}

type Phase = 'hold' | 'lift' | 'bring' | 'squeeze' | 'ease' | 'back' | 'lower';

export interface CarryInput {
  /** Present positions of hand and aim [m, device coordinates]. */
  readonly hand: Triple;
  readonly aim: Triple;
  /** Vector from the target to the place where it is squeezed [m]. */
  readonly away: Triple;
  readonly squeeze_n: number;
  readonly squeezeLow_n: number;
  /** The person still requests it, and the step is not finished. */
  readonly goesOn: boolean;
}

/** Velocity of the arm, and whether the target is only held or squeezed. */
export interface CarryMove { readonly velocity: Triple; readonly hold: boolean }

/**
 * Carries a free target: holds it, lifts it, brings it to where it is squeezed, and puts it back
 * in its place when the step is finished or the person stops requesting it.
 */
export class CarryControl {
  private phase: Phase = 'hold';
  private settled_s = 0;
  private since_s = 0;
  private lost_s = 0;
  private from: Triple | undefined;
  private goal: Triple | undefined;

  /** @returns undefined once the target is back in its place, or is no longer held */
  step(seen: CarryInput, dt_s: number): CarryMove | undefined {
    this.lost_s = seen.squeeze_n < LOST_N ? this.lost_s + dt_s : 0;
    if (this.phase !== 'hold' && this.lost_s > LOST_S) return undefined;
    const zone = holdZone(seen.squeezeLow_n);
    const held = seen.squeeze_n > 0.95 * zone.squeezeLow_n && seen.squeeze_n < 1.05 * zone.squeezeHigh_n;
    this.settled_s = held ? this.settled_s + dt_s : 0;
    this.since_s += dt_s;
    const isStuck = this.since_s > GIVES_UP_S;
    if (!seen.goesOn || (isStuck && this.phase !== 'squeeze')) {
      if (this.phase === 'hold' && !seen.goesOn) return undefined;
      if (isStuck && (this.phase === 'back' || this.phase === 'lower')) return undefined;
      if (isStuck && this.phase === 'ease') this.go('back', seen);
      if (this.phase === 'lift' || this.phase === 'bring') this.go('back', seen);
      else if (this.phase === 'squeeze') this.go('ease', seen);
    }
    switch (this.phase) {
      case 'hold': if (this.settled_s > SETTLED_S) this.go('lift', seen); break;
      case 'lift': if (this.isThere(seen)) this.go('bring', seen); break;
      case 'bring': if (this.isThere(seen)) this.go('squeeze', seen); break;
      case 'ease': if (this.settled_s > SETTLED_S) this.go('back', seen); break;
      case 'back': if (this.isThere(seen)) this.go('lower', seen); break;
      case 'lower': if (this.isThere(seen)) return undefined; break;
      case 'squeeze': break;
    }
    return { velocity: this.velocity(seen), hold: this.phase !== 'squeeze' };
  }

  private go(phase: Phase, { aim, away }: CarryInput): void {
    this.phase = phase;
    this.settled_s = this.since_s = 0;
    if (phase === 'lift') {
      this.from = { ...aim };
      this.goal = { ...aim, z: aim.z + Math.max(away.z, 0.02) };
    } else if (phase === 'back') this.goal = { ...this.from!, z: Math.max(aim.z, this.from!.z) };
    else if (phase === 'lower') this.goal = this.from;
    else this.goal = undefined;
  }

  private isThere({ hand, aim, away }: CarryInput): boolean {
    if (this.phase === 'bring') return Math.hypot(away.x, away.y) < THERE_M;
    const { goal } = this;
    const off_m = (at: Triple): number => goal ? Math.hypot(goal.x - at.x, goal.y - at.y, goal.z - at.z) : 0;
    return off_m(aim) < THERE_M && off_m(hand) < HAND_THERE_M;
  }

  private velocity({ aim, away }: CarryInput): Triple {
    // At its place the target's own position counts: it may be tilted in the hand.
    const goal = this.phase === 'bring' || this.phase === 'squeeze' ? { x: aim.x + away.x, y: aim.y + away.y, z: aim.z } : this.goal;
    if (goal === undefined) return { x: 0, y: 0, z: 0 };
    const way = { x: goal.x - aim.x, y: goal.y - aim.y, z: goal.z - aim.z };
    const far_m = Math.hypot(way.x, way.y, way.z), speed = Math.min(SLOWS_PER_S, SPEED_M_S / Math.max(far_m, 1e-6));
    return { x: speed * way.x, y: speed * way.y, z: speed * way.z };
  }
}
