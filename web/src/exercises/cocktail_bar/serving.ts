// What happens to the glass once a drink is done: it slides to the middle, the guest drinks and thanks, and
// the empty glass slides away. A matter of looks alone: the program's glass stays where it is.

export type Pose = 'waits' | 'drinks' | 'thanks';

export interface Serving {
  readonly pose: Pose;
  readonly toMiddle: number;   // 0 at the program's place, 1 before the guest
  readonly away: number;       // 0 .. 1 of the way out of the picture
  readonly seen: number;       // 0 .. 1: how much of the glass is seen
  readonly empty: boolean;
}

/** Of a done drink [s]. */
const SLIDE_S = 0.9;
const DRINK_S = 3;
const AWAY_S = 0.9;
/** With reduced motion nothing slides: the glass goes and comes within this, and the guest has it meanwhile [s]. */
const FADE_S = 0.5;

const AT_ITS_PLACE: Serving = { pose: 'waits', toMiddle: 0, away: 0, seen: 1, empty: false };
/** Without a jolt at either end: minimum jerk. */
const eased = (share: number): number => { const t = Math.min(1, Math.max(0, share)); return t * t * t * (10 - 15 * t + 6 * t * t); };

/**
 * @param done_s since the drink was done, while it is; @param next_s since the next one began, after it
 * @param still  the person asked for reduced motion
 */
export function servingAt(done_s: number | undefined, next_s: number | undefined, still: boolean): Serving {
  if (done_s === undefined) {
    if (next_s === undefined) return AT_ITS_PLACE;
    const back = eased(next_s / (still ? FADE_S : SLIDE_S));
    return still ? { ...AT_ITS_PLACE, seen: back } : { ...AT_ITS_PLACE, away: 1 - back };
  }
  if (still) {
    const pose = done_s < FADE_S ? 'waits' : done_s < FADE_S + DRINK_S ? 'drinks' : 'thanks';
    return { ...AT_ITS_PLACE, pose, seen: 1 - eased(done_s / FADE_S) };
  }
  if (done_s < SLIDE_S) return { ...AT_ITS_PLACE, toMiddle: eased(done_s / SLIDE_S) };
  if (done_s < SLIDE_S + DRINK_S) return { pose: 'drinks', toMiddle: 1, away: 0, seen: 0, empty: false };
  const away = eased((done_s - SLIDE_S - DRINK_S) / AWAY_S);
  return { pose: 'thanks', toMiddle: 1, away, seen: away < 1 ? 1 : 0, empty: true };
}

/** The guest's clock: which drink is done, and since when. */
export class ServingClock {
  private done_s: number | undefined;
  private next_s: number | undefined;

  /** @param needed the hand is at a bottle: the glass is shown where it is, however slowly pictures are drawn */
  look(done: boolean, needed: boolean, dt_s: number, still: boolean): Serving {
    if (done) {
      this.done_s = this.done_s === undefined ? 0 : this.done_s + dt_s;
      this.next_s = undefined;
    } else {
      if (needed) this.next_s = undefined;
      else if (this.done_s !== undefined) this.next_s = 0;
      else if (this.next_s !== undefined) this.next_s = this.next_s > SLIDE_S ? undefined : this.next_s + dt_s;
      this.done_s = undefined;
    }
    return servingAt(this.done_s, this.next_s, still);
  }
}
