// Repeats an emergency stop until the program has confirmed it.
import type { Answer } from './pending_answers';

/** A stop without an answer for this long counts as not confirmed, and is sent again [ms]. */
const CONFIRMED_WITHIN_MS = 300;

/** Sends a stop again and again until the program says that it has it, over a new line, too. */
export class PendingStop {
  /** Whether a person has to be warned that the program may not have got the stop. */
  unconfirmed = false;
  private id = 0;
  private sent_ms = 0;
  private timer: ReturnType<typeof setInterval> | undefined;
  private settle: ((answer: Answer) => void)[] = [];

  /**
   * @param send with the order's id: what is sent again has the same
   * @param changed called when `unconfirmed` changed
   */
  constructor(private readonly send: (id: number) => Promise<Answer>, private readonly changed: () => void) {}

  /** Asks for a stop: a press. The answer comes when the program has confirmed it, however late. */
  ask(id: number): Promise<Answer> {
    this.id = id;
    this.timer ??= setInterval(() => this.sendAgain(), CONFIRMED_WITHIN_MS);
    this.sendOnce();
    return new Promise((settle) => { this.settle.push(settle); });
  }

  /** A line was opened: what could not be sent before is sent now. */
  lineLives(): void { if (this.timer !== undefined) this.sendOnce(); }

  /** With every message of the program: a hidden tab's timers are slow, its messages are not. */
  heard(): void {
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

  // A page that was busy meanwhile says so, too: it may have an answer to read, and may have none.
  private sendAgain(): void {
    this.say(true);
    this.sendOnce();
  }

  private confirm(answer: Answer): void {
    this.close();
    this.say(false);
    for (const settle of this.settle.splice(0)) settle(answer);
  }

  private say(unconfirmed: boolean): void {
    if (unconfirmed === this.unconfirmed) return;
    this.unconfirmed = unconfirmed;
    this.changed();
  }
}
