// What a frame costs, and how old what it shows is.
import { quantile, Ring } from '../shared/ring';

export interface WholehandStats {
  readonly script_ms_p95: number;      // our code on the main thread, a frame
  readonly fps: number;                // of the last second
  readonly state_age_ms_p99: number;   // of a state when it is first drawn, beyond the fastest message's way
  readonly quality: string;
  readonly frames: number;
  /** What the graphics card keeps. */
  readonly card?: { readonly geometries: number; readonly textures: number };
}

/**
 * The program's clock against the page's. They have no common zero: the fastest message of the last while
 * counts as age zero, so an age says how much longer than that one a state took to be drawn.
 */
export class ClockOffset {
  private readonly recent: Ring;
  private best_ms = Infinity;

  constructor(window = 600) { this.recent = new Ring(window, 1); }

  /** A message sent at `sent_ms` of the program's clock came at `came_ms` of ours. */
  heard(sent_ms: number, came_ms: number): void {
    const offset_ms = came_ms - sent_ms;
    const full = this.recent.length === this.recent.capacity;
    const leaves_ms = full ? this.recent.at(0, 0) : Infinity;
    this.recent.push([offset_ms]);
    if (offset_ms <= this.best_ms) this.best_ms = offset_ms;
    else if (leaves_ms === this.best_ms) this.best_ms = this.smallest();
  }

  age_ms(sent_ms: number, now_ms: number): number { return now_ms - sent_ms - this.best_ms; }

  private smallest(): number {
    let best = Infinity;
    for (let i = 0; i < this.recent.length; i++) best = Math.min(best, this.recent.at(i, 0));
    return best;
  }
}

export class FrameStats {
  private readonly frames = new Ring(600, 3);   // at, script, age [ms]
  private total = 0;

  add(now_ms: number, script_ms: number, age_ms: number): void {
    this.frames.push([now_ms, script_ms, age_ms]);
    this.total += 1;
  }

  /** Middle of the times between the last frames [ms]; NaN before there are enough to say. */
  framePeriod_ms(count: number): number {
    const n = this.frames.length;
    if (n <= count) return NaN;
    return quantile(Array.from({ length: count }, (_, i) => this.frames.at(n - 1 - i, 0) - this.frames.at(n - 2 - i, 0)), 0.5);
  }

  /** Forgets, so that what comes is judged alone. */
  reset(): void { this.frames.clear(); }

  report(quality: string, card?: { geometries: number; textures: number }): WholehandStats {
    const n = this.frames.length;
    const column = (channel: number) => Array.from({ length: n }, (_, i) => this.frames.at(i, channel));
    const ages = column(2).filter(Number.isFinite);
    const last_ms = n > 0 ? this.frames.at(n - 1, 0) : 0;
    let first = n - 1;
    while (first > 0 && last_ms - this.frames.at(first - 1, 0) <= 1000) first -= 1;
    const span_ms = n > 1 ? last_ms - this.frames.at(Math.max(0, first), 0) : 0;
    // Slower than one a second: the time since the frame before.
    const slow_ms = n > 1 ? last_ms - this.frames.at(n - 2, 0) : NaN;
    const fps = span_ms > 0 ? (1000 * (n - 1 - first)) / span_ms : 1000 / slow_ms;
    return { script_ms_p95: quantile(column(1), 0.95), fps, state_age_ms_p99: quantile(ages, 0.99), quality, frames: this.total, card };
  }
}
