import type { Span } from '../console/plot_source';

/** The window that plots show: inside the recording, and never shorter than a few ticks. */
export class Zoom {
  window: Span;

  constructor(private whole: Span, private readonly least_s: number) {
    this.window = whole;
  }

  get shows(): 'all' | 'part' {
    return this.window.from_s <= this.whole.from_s && this.window.to_s >= this.whole.to_s ? 'all' : 'part';
  }

  /** Sets the span of a recording that has grown; a window that showed all of it shows the new whole. */
  setWhole(whole: Span): void {
    const all = this.shows === 'all';
    this.whole = whole;
    this.set(all ? whole : this.window);
  }

  set({ from_s, to_s }: Span): void {
    const { whole, least_s } = this;
    const most_s = Math.max(least_s, whole.to_s - whole.from_s);
    const span_s = Math.min(most_s, Math.max(least_s, to_s - from_s));
    const middle_s = (from_s + to_s) / 2;
    const begin_s = Math.max(whole.from_s, Math.min(middle_s - span_s / 2, whole.from_s + most_s - span_s));
    this.window = { from_s: begin_s, to_s: begin_s + span_s };
  }

  /** Shows `factor` times as much; a time keeps its position. */
  scale(time_s: number, factor: number): void {
    const { from_s, to_s } = this.window;
    this.set({ from_s: time_s + (from_s - time_s) * factor, to_s: time_s + (to_s - time_s) * factor });
  }

  all(): void {
    this.set(this.whole);
  }

  /** Moves the window if a time is outside; the window then begins shortly before it. */
  follow(time_s: number): boolean {
    const { from_s, to_s } = this.window;
    if (time_s >= from_s && time_s <= to_s) return false;
    const span_s = to_s - from_s;
    this.set({ from_s: time_s - 0.05 * span_s, to_s: time_s + 0.95 * span_s });
    return true;
  }
}
