/** A press shorter than this stays on until the next one [s]. */
const TAP_S = 0.6;
/** Of a squeeze that is reported as a part: from here on it counts as pressed. */
const PRESSED = 0.3;

/**
 * One button. Held, it squeezes for as long as it is held; where taps count, a tap squeezes until the next
 * one. What has done its work is let go of, and asks for nothing until it is pressed anew.
 */
export class Trigger {
  private down = false;
  private held_s = 0;
  private latched = false;
  private spent = false;
  private ends = false;

  /**
   * @param asked what the way of playing says: pressed or not, or how far
   * @param taps whether a tap is as good as holding
   * @param closed whether the hand has begun to close: what is let go of before has only asked for it
   */
  step(asked: boolean | number, taps: boolean, closed: boolean, dt_s: number): boolean | number {
    const down = typeof asked === 'number' ? asked > PRESSED : asked;
    if (down && !this.down) {
      this.held_s = 0;
      // Who presses squeezes, and who lets go lets go: it ends what a tap before it began.
      this.ends = this.latched;
      this.latched = false;
    } else if (down) {
      this.held_s += dt_s;
    } else if (this.down) {
      this.latched = taps && typeof asked === 'boolean' && !this.spent && !this.ends && (this.held_s < TAP_S || !closed);
      this.spent = this.ends = false;
    }
    this.down = down;
    if (this.spent) return false;
    return this.latched || asked;
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
