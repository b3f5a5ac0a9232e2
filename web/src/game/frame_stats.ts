// Frame times, and the age of the shown states.
import { quantile, Ring } from '../shared/ring';

export interface WholehandStats {
  readonly script_ms_p95: number;      // script time of this page on the main thread per frame
  readonly fps: number;                // over the last second
  readonly state_age_ms_p99: number;   // age of a state when it is first drawn, beyond the fastest message's delay
  readonly quality: string;
  readonly frames: number;
  /** Objects in the graphics card's memory. */
  readonly card?: { readonly geometries: number; readonly textures: number };
}

/**
 * Offset between the program's clock and the page's. They have no common zero: the fastest recent message counts as
 * age zero, so an age is the additional delay of a state until it is drawn.
 */
export class ClockOffset {
  private readonly recent: Ring;
  private best_ms = Infinity;

  constructor(window = 600) { this.recent = new Ring(window, 1); }

  /** Adds a message that was sent at `sent_ms` of the program's clock and came at `came_ms` of the page's. */
  addSample(sent_ms: number, came_ms: number): void {
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
  private readonly frames = new Ring(600, 3);   // time, script, age [ms]
  private total = 0;

  add(now_ms: number, script_ms: number, age_ms: number): void {
    this.frames.push([now_ms, script_ms, age_ms]);
    this.total += 1;
  }

  /** Median of the last frame periods [ms]; NaN before there are enough. */
  framePeriod_ms(count: number): number {
    const n = this.frames.length;
    if (n <= count) return NaN;
    return quantile(Array.from({ length: count }, (_, i) => this.frames.at(n - 1 - i, 0) - this.frames.at(n - 2 - i, 0)), 0.5);
  }

  /** Clears the statistics, so that later frames are measured alone. */
  reset(): void { this.frames.clear(); }

  report(quality: string, card?: { geometries: number; textures: number }): WholehandStats {
    const n = this.frames.length;
    const column = (channel: number) => Array.from({ length: n }, (_, i) => this.frames.at(i, channel));
    const ages = column(2).filter(Number.isFinite);
    const last_ms = n > 0 ? this.frames.at(n - 1, 0) : 0;
    let first = n - 1;
    while (first > 0 && last_ms - this.frames.at(first - 1, 0) <= 1000) first -= 1;
    const span_ms = n > 1 ? last_ms - this.frames.at(Math.max(0, first), 0) : 0;
    // At less than one frame a second: the time since the frame before.
    const slow_ms = n > 1 ? last_ms - this.frames.at(n - 2, 0) : NaN;
    const fps = span_ms > 0 ? (1000 * (n - 1 - first)) / span_ms : 1000 / slow_ms;
    return { script_ms_p95: quantile(column(1), 0.95), fps, state_age_ms_p99: quantile(ages, 0.99), quality, frames: this.total, card };
  }
}
