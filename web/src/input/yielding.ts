import type { Triple } from './wish';

/** What presses on the hand: at which target (an index of the grips, -1: something else), and how [N, on the hand]. */
export interface Touch {
  at: number;
  force_n: Triple;
}

/** A smaller force does not hinder the hand [N]. */
const PRESSES_N = 0.5;
/** The arm begins to yield after the first time, and has yielded after the second one more [s]. */
const BEARS_S = 0.8;
const YIELDS_S = 0.7;
/** An arm that has yielded leads by this at most [m]: with 300 N/m that is 0.6 N. */
const LEAST_LEASH_M = 0.002;
/** A wedged hand draws back and opens in turns of so long [s]. */
const TURN_S = 1;
/** Fingers that are hooked behind something lead by this at most [rad]. */
const LEAST_LEASH_RAD = 0.05;

/**
 * Stops a hand from pushing against something that it is not meant to touch. Away from what holds it, the hand
 * moves as before.
 */
export class Yielding {
  private held_s = 0;
  private wedged_s = 0;
  private sum_n: Triple = { x: 0, y: 0, z: 0 };

  reset(): void {
    this.held_s = this.wedged_s = 0;
    this.sum_n = { x: 0, y: 0, z: 0 };
  }

  /** @param wanted the target that is meant to be touched; undefined: none */
  look(touches: readonly Touch[], wanted: number | undefined, dt_s: number): void {
    const sum = { x: 0, y: 0, z: 0 };
    for (const { at, force_n } of touches) {
      if (at >= 0 && at === wanted) continue;
      for (const key of ['x', 'y', 'z'] as const) sum[key] += force_n[key];
    }
    const held = Math.hypot(sum.x, sum.y, sum.z) > PRESSES_N;
    this.held_s = held ? Math.min(this.held_s + dt_s, BEARS_S + YIELDS_S) : Math.max(0, this.held_s - 0.25 * dt_s);
    this.wedged_s = this.held_s >= BEARS_S + YIELDS_S ? this.wedged_s + dt_s : 0;
    if (held) this.sum_n = sum;
  }

  /** How firm the arm is: 1 as usual, 0 it has yielded. */
  private get part(): number {
    return 1 - Math.max(0, this.held_s - BEARS_S) / YIELDS_S;
  }

  /** Whether yielding was not enough: the hand is wedged, for example between a target and the end of the device's range. */
  get wedged(): boolean { return this.wedged_s > 0; }

  /** Whether a wedged hand draws back now. In turns with this its arm rests and its fingers open: a fist that is pulled at only jams. */
  get drawsBack(): boolean { return this.wedged && Math.floor(this.wedged_s / TURN_S) % 2 === 0; }

  /** How far the aim of an open hand's axis may be from where the device is [rad]. */
  handLeash(usual_rad: number): number {
    return this.wedged && !this.drawsBack ? usual_rad : Math.max(LEAST_LEASH_RAD, usual_rad * this.part);
  }

  /** How far the aim may be below and above where the device is along an axis [m]. */
  leash(key: keyof Triple, usual_m: number): [number, number] {
    const yielded_m = Math.max(LEAST_LEASH_M, usual_m * this.part);
    const force_n = this.sum_n[key];
    // On its way out friction holds a wedged hand, too.
    if (key === 'x' && this.wedged) return [this.drawsBack ? usual_m : yielded_m, yielded_m];
    // A force upwards on the hand means that it presses down.
    return [force_n > 0.2 ? yielded_m : usual_m, force_n < -0.2 ? yielded_m : usual_m];
  }
}
