/** A press shorter than this stays on until the next one [s]. */
const TAP_S = 0.6;
/** A press so soon after the last one is a tremor, or impatience: it asks for nothing new [s]. */
const AGAIN_S = 0.4;
/** Of a squeeze that is reported as a part: from here on it counts as pressed. */
const PRESSED = 0.3;

/** What a press meets. */
export interface Pressed {
  /** A tap is as good as holding. */
  readonly taps: boolean;
  /** The hand has begun to close: what is let go of before has only asked for it. */
  readonly closed: boolean;
  /** It asks for what is being done: a tap more ends nothing. */
  readonly same?: boolean;
  /** It is squeezed well: no press that meets this ends it, not even one that is held. */
  readonly well?: boolean;
}

/**
 * One button. Held, it squeezes for as long as it is held; where taps count, a tap squeezes until the next
 * one. What has done its work is let go of, and asks for nothing until it is pressed anew.
 */
export class Trigger {
  private down = false;
  private held_s = 0;
  private up_s = Infinity;
  private latched = false;
  private spent = false;
  private ends = false;
  private met = false;

  /** @param asked what the way of playing says: pressed or not, or how far */
  step(asked: boolean | number, { taps, closed, same = false, well = false }: Pressed, dt_s: number): boolean | number {
    const down = typeof asked === 'number' ? asked > PRESSED : asked;
    if (!down) this.up_s += dt_s;
    this.met = well || (this.met && this.down);
    if (down && !this.down) {
      this.held_s = 0;
      // Who presses squeezes, and who lets go lets go: it ends what a tap before it began.
      this.ends = this.latched && !same && !well && this.up_s > AGAIN_S;
      this.latched &&= !this.ends;
    } else if (down) {
      this.held_s += dt_s;
    } else if (this.down) {
      const tap = this.held_s < TAP_S || !closed;
      this.latched = this.latched ? tap || this.met : tap && taps && typeof asked === 'boolean' && !this.spent && !this.ends;
      this.spent = this.ends = false;
      this.up_s = 0;
    }
    this.down = down;
    if (this.spent) return false;
    return this.latched || asked;
  }

  /** The press that was on goes on, as if a tap had come. */
  resume(): void {
    this.latched = true;
  }

  /** The work is done: the press that is on, or held, means nothing more. */
  finish(): void {
    this.latched = false;
    this.spent = this.down;
  }

  /** The person is gone, or does something else. */
  release(): void {
    this.down = this.latched = this.spent = this.ends = false;
  }
}
