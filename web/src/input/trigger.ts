/** A shorter press is a tap, which stays on until the next press [s]. */
const TAP_S = 0.6;
/** A press this soon after the last one is a tremor or impatience, and is ignored [s]. */
const AGAIN_S = 0.4;
/** An analog squeeze above this counts as pressed. */
const PRESSED = 0.3;

/** The situation at a press. */
export interface TriggerInput {
  /** Taps count like holding. */
  readonly taps: boolean;
  /** The hand has begun to close: an earlier release only requests closing. */
  readonly closed: boolean;
  /** The press repeats the current request: another tap does not end it. */
  readonly same?: boolean;
  /** The squeeze is in its range: a press during this does not end it, even if it is held. */
  readonly well?: boolean;
}

/**
 * One button. It squeezes while it is held; where taps count, a tap squeezes until the next
 * one. After the action is finished it must be pressed again.
 */
export class Trigger {
  private down = false;
  private held_s = 0;
  private up_s = Infinity;
  private latched = false;
  private spent = false;
  private ends = false;
  private met = false;

  /** @param asked state of the input method: pressed or not, or the degree */
  step(asked: boolean | number, { taps, closed, same = false, well = false }: TriggerInput, dt_s: number): boolean | number {
    const down = typeof asked === 'number' ? asked > PRESSED : asked;
    if (!down) this.up_s += dt_s;
    this.met = well || (this.met && this.down);
    if (down && !this.down) {
      this.held_s = 0;
      // An earlier tap has left the hand closed. This press takes the squeeze over, and its release opens the hand.
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

  /** Continues the last press as if by a tap. */
  resume(): void {
    this.latched = true;
  }

  /** The action is finished: the present press has no further effect. */
  finish(): void {
    this.latched = false;
    this.spent = this.down;
  }

  /** The person is gone, or does something else. */
  release(): void {
    this.down = this.latched = this.spent = this.ends = false;
  }
}
