// Repeats an emergency stop until the program has confirmed it.
import type { Answer } from './pending_answers';

/** A stop without an answer for this long counts as not confirmed, and is sent again [ms]. */
const CONFIRMED_WITHIN_MS = 300;

/** Sends a stop repeatedly until the program confirms it, also over a new connection. */
export class PendingStop {
  /** Whether a person must be warned that the program may not have received the stop. */
  unconfirmed = false;
  private id = 0;
  private sent_ms = 0;
  private timer: ReturnType<typeof setInterval> | undefined;
  private settle: ((answer: Answer) => void)[] = [];

  /**
   * @param send sends the order with this id; every repetition has the same id
   * @param changed called when `unconfirmed` changed
   */
  constructor(private readonly send: (id: number) => Promise<Answer>, private readonly changed: () => void) {}

  /** Requests a stop after a press. The answer comes when the program has confirmed it, however late. */
  ask(id: number): Promise<Answer> {
    this.id = id;
    this.timer ??= setInterval(() => this.sendAgain(), CONFIRMED_WITHIN_MS);
    this.sendOnce();
    return new Promise((settle) => { this.settle.push(settle); });
  }

  /** A connection was opened: a stop that could not be sent before is sent now. */
  onConnected(): void { if (this.timer !== undefined) this.sendOnce(); }

  /** Called with every message of the program: the timers of a hidden tab are slow, its messages are not. */
  onMessage(): void {
    if (this.timer !== undefined && performance.now() - this.sent_ms >= CONFIRMED_WITHIN_MS) this.sendOnce();
  }

  close(): void {
    clearInterval(this.timer);
    this.timer = undefined;
  }

  private sendOnce(): void {
    this.sent_ms = performance.now();
    void this.send(this.id).then((answer) => { if (answer.accepted) this.confirm(answer); });
  }

  // A page that was busy also warns: it may have an unread answer, or none.
  private sendAgain(): void {
    this.setUnconfirmed(true);
    this.sendOnce();
  }

  private confirm(answer: Answer): void {
    this.close();
    this.setUnconfirmed(false);
    for (const settle of this.settle.splice(0)) settle(answer);
  }

  private setUnconfirmed(unconfirmed: boolean): void {
    if (unconfirmed === this.unconfirmed) return;
    this.unconfirmed = unconfirmed;
    this.changed();
  }
}
