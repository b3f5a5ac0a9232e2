import type { Triple } from './wish';

/** A contact on the hand: the target (an index of the grips, -1: another body), and the force on the hand [N]. */
export interface HandContact {
  at: number;
  force_n: Triple;
}

/** A smaller force does not count as an obstacle [N]. */
const PRESSES_N = 0.5;
/** The arm begins to yield after the first time, and has yielded completely after the second one in addition [s]. */
const BEARS_S = 0.8;
const YIELDS_S = 0.7;
/** The aim leads an arm that has yielded by at most this [m]: with 300 N/m that is 0.6 N. */
const LEAST_LEASH_M = 0.002;
/** A wedged hand alternates between drawing back and opening with this period [s]. */
const TURN_S = 1;
/** The aim of fingers that are hooked behind something leads by at most this [rad]. */
const LEAST_LEASH_RAD = 0.05;

/**
 * Stops a hand from pushing against something that it must not touch. Away from the obstacle, the hand
 * moves as before.
 */
export class ObstacleResponse {
  private held_s = 0;
  private wedged_s = 0;
  private sum_n: Triple = { x: 0, y: 0, z: 0 };

  reset(): void {
    this.held_s = this.wedged_s = 0;
    this.sum_n = { x: 0, y: 0, z: 0 };
  }

  /** @param wanted the target that the hand is meant to touch; undefined: none */
  onState(touches: readonly HandContact[], wanted: number | undefined, dt_s: number): void {
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

  /** Firmness of the arm: 1 normal, 0 yielded. */
  private get firmness(): number {
    return 1 - Math.max(0, this.held_s - BEARS_S) / YIELDS_S;
  }

  /** Whether yielding was insufficient: the hand is wedged, for example between a target and the end of the device's range. */
  get wedged(): boolean { return this.wedged_s > 0; }

  /** Whether a wedged hand draws back now. In the other half of the period its arm rests and its fingers open, since pulling a fist would jam it further. */
  get drawsBack(): boolean { return this.wedged && Math.floor(this.wedged_s / TURN_S) % 2 === 0; }

  /** Largest distance between the aim of an open hand's axis and the device [rad]. */
  handLeash(usual_rad: number): number {
    return this.wedged && !this.drawsBack ? usual_rad : Math.max(LEAST_LEASH_RAD, usual_rad * this.firmness);
  }

  /** Largest distance of the aim below and above the device along an axis [m]. */
  leash(key: keyof Triple, usual_m: number): [number, number] {
    const yielded_m = Math.max(LEAST_LEASH_M, usual_m * this.firmness);
    const force_n = this.sum_n[key];
    // Friction holds a wedged hand on its way out, too.
    if (key === 'x' && this.wedged) return [this.drawsBack ? usual_m : yielded_m, yielded_m];
    // A force upwards on the hand means that it presses down.
    return [force_n > 0.2 ? yielded_m : usual_m, force_n < -0.2 ? yielded_m : usual_m];
  }
}
