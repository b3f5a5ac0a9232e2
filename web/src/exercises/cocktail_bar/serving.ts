// The animation of a finished glass: it slides to the middle, the guest drinks and thanks, and the empty glass slides
// away. It only changes the picture: the program's glass stays in place.

export type Pose = 'waits' | 'drinks' | 'thanks';

export interface Serving {
  readonly pose: Pose;
  readonly toMiddle: number;   // 0 at the program's place, 1 in front of the guest
  readonly away: number;       // progress of the way out of the picture, 0 .. 1
  readonly seen: number;       // visible share of the glass, 0 .. 1
  readonly empty: boolean;
}

/** Times after a drink is done [s]. */
const SLIDE_S = 0.9;
const DRINK_S = 3;
const AWAY_S = 0.9;
/** With reduced motion nothing slides: the glass fades within this time, and the guest holds it meanwhile [s]. */
const FADE_S = 0.5;

const AT_ITS_PLACE: Serving = { pose: 'waits', toMiddle: 0, away: 0, seen: 1, empty: false };
/** Minimum-jerk interpolation, smooth at both ends. */
const eased = (share: number): number => { const t = Math.min(1, Math.max(0, share)); return t * t * t * (10 - 15 * t + 6 * t * t); };

/**
 * @param done_s time since the drink was done, while it is @param next_s time since the next one began, after it
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

/** Clock of the serving: whether a drink is done, and since when. */
export class ServingClock {
  private done_s: number | undefined;
  private next_s: number | undefined;

  /** @param needed the hand is at a bottle: the glass is shown at its real place, even at low frame rates */
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
