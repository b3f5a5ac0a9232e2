import { dot, length, minus, plus, times } from './triple';
import type { Triple } from './wish';

/** Speeds of the hand towards the object, and while pushing [m/s]; rate at which it slows down near its goal [1/s]. */
const GOES_M_S = 0.16;
const PUSHES_M_S = 0.05;
const SLOWS_PER_S = 3;
/** Distance before the contact point at which straight fingers are clear of the object [m]. */
const CLEAR_M = 0.05;
/** Position tolerance [m]. */
const THERE_M = 0.008;

export interface PushInput {
  /** Positions of hand and aim, and of the hand with its fingertips at the contact point [m, device coordinates]. */
  readonly hand: Triple;
  readonly aim: Triple;
  readonly grip: Triple;
  /** x of a hand that is drawn back. */
  readonly back_m: number;
  /** Unit vector of the pushing direction. */
  readonly toward: Triple;
  /** Vector from the contact point to its goal [m]; undefined: it is pushed without a goal. */
  readonly away: Triple | undefined;
}

type Phase = 'align' | 'enter' | 'push';

/** Pushes an object with straight fingers: moves beside it while drawn back, then clear in front of it, and pushes it to its goal. */
export class Push {
  private phase: Phase = 'align';

  /** Velocity of the arm [m/s]. */
  step(seen: PushInput): Triple {
    const { hand, aim, grip, back_m, toward, away } = seen;
    const clear = minus(grip, times(toward, CLEAR_M));
    if (this.phase === 'align') {
      const goal = { ...clear, x: Math.min(clear.x, back_m) };
      if (length(minus(goal, hand)) > THERE_M) return to(goal, aim);
      this.phase = 'enter';
    }
    if (this.phase === 'enter') {
      if (length(minus(clear, hand)) > THERE_M) return to(clear, aim);
      this.phase = 'push';
    }
    const off = minus(grip, aim), left_m = dot(off, toward);
    if (left_m > 0) return plus(times(toward, PUSHES_M_S), times(minus(off, times(toward, left_m)), SLOWS_PER_S));
    // Friction and the arm's compliance hold the object back: the aim continues until it arrives.
    const way = away ?? times(toward, 1), far_m = length(way);
    return times(way, Math.min(SLOWS_PER_S, PUSHES_M_S / Math.max(far_m, 1e-6)));
  }
}

function to(goal: Triple, aim: Triple): Triple {
  const way = minus(goal, aim);
  return times(way, Math.min(2 * SLOWS_PER_S, GOES_M_S / Math.max(length(way), 1e-6)));
}
