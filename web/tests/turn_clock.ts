// Clock and timers of a page whose every turn takes as long as the test specifies.
import { vi } from 'vitest';

interface Timer { due_ms: number; readonly every_ms: number | undefined; readonly call: () => void }

/**
 * Time advances in turns: the page is busy for a time, then each due timer fires once, like in browsers.
 * A hidden tab's timers fire at most once a second; messages and presses arrive at any time.
 */
export class TurnClock {
  now_ms = 1000;
  hidden = false;
  private readonly timers = new Map<number, Timer>();
  private last = 0;
  private fired_ms = 0;

  constructor() {
    const add = (call: () => void, wait_ms = 0, every_ms?: number): number => {
      this.timers.set(++this.last, { due_ms: this.now_ms + wait_ms, every_ms, call });
      return this.last;
    };
    const forget = (id?: number): void => { this.timers.delete(id ?? 0); };
    vi.stubGlobal('setTimeout', (call: () => void, wait_ms?: number) => add(call, wait_ms));
    vi.stubGlobal('setInterval', (call: () => void, wait_ms = 0) => add(call, wait_ms, wait_ms));
    vi.stubGlobal('clearTimeout', forget);
    vi.stubGlobal('clearInterval', forget);
    vi.stubGlobal('performance', { now: () => this.now_ms });
  }

  /** Continuations of promises run at the end. */
  async turn(busy_ms: number): Promise<void> {
    this.now_ms += busy_ms;
    if (!this.hidden || this.now_ms - this.fired_ms >= 1000) {
      this.fired_ms = this.now_ms;
      for (const [id, timer] of [...this.timers].filter(([, { due_ms }]) => due_ms <= this.now_ms)) {
        if (!this.timers.has(id)) continue;
        if (timer.every_ms === undefined) this.timers.delete(id);
        else timer.due_ms = this.now_ms + timer.every_ms;
        timer.call();
      }
    }
    await this.settle();
  }

  /** Runs turns until `so` holds or for the given time; returns the elapsed time [ms]. */
  async until(so: () => boolean, busy_ms: number, most_ms: number): Promise<number> {
    const from_ms = this.now_ms;
    while (!so() && this.now_ms - from_ms <= most_ms) await this.turn(busy_ms);
    return this.now_ms - from_ms;
  }

  async settle(): Promise<void> { for (let i = 0; i < 20; i += 1) await Promise.resolve(); }
}
