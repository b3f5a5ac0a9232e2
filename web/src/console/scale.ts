/** The smallest step of 1, 2 or 5 times a power of ten that is at least `span / most`. */
export function niceStep(span: number, most: number): number {
  const raw = Math.max(span, 1e-9) / most;
  const power = 10 ** Math.floor(Math.log10(raw));
  const part = raw / power;
  return power * (part <= 1.0000001 ? 1 : part <= 2.0000001 ? 2 : part <= 5.0000001 ? 5 : 10);
}

/** Multiples of `step` inside a range. */
export function ticksIn(lower: number, upper: number, step: number): number[] {
  const ticks: number[] = [];
  for (let k = Math.ceil(lower / step - 1e-9); k * step <= upper + step * 1e-9; k += 1) ticks.push(k === 0 ? 0 : k * step);
  return ticks;
}

/** A range grows at once, and shrinks only after the data stayed inside a smaller one for this long [s]. */
const SHRINK_AFTER_S = 2;

/**
 * The range of a plot's values: whole steps around the data with some room, never smaller than
 * `leastSpan`, without frequent changes.
 */
export class CalmRange {
  lower = 0;
  upper = 0;
  private smallSince_s = 0;

  constructor(
    private readonly leastSpan: number,
    private readonly withZero: boolean,
  ) {}

  /** Adapts to the data's extremes at `now_s`; true when the range changed. */
  follow(least: number, most: number, now_s: number): boolean {
    const [lower, upper] = this.wanted(least, most);
    const grows = lower < this.lower || upper > this.upper || this.upper === this.lower;
    const same = lower === this.lower && upper === this.upper;
    if (same) {
      this.smallSince_s = now_s;
      return false;
    }
    if (!grows && now_s - this.smallSince_s < SHRINK_AFTER_S) return false;
    // Growth on one side must not shrink the other side at once.
    const outgrown = grows && this.upper !== this.lower;
    this.lower = outgrown ? Math.min(lower, this.lower) : lower;
    this.upper = outgrown ? Math.max(upper, this.upper) : upper;
    this.smallSince_s = now_s;
    return true;
  }

  /** Adapts to these extremes at once, for a window that stands still. */
  fit(least: number, most: number): void {
    [this.lower, this.upper] = this.wanted(least, most);
  }

  private wanted(least: number, most: number): [number, number] {
    let low = Number.isFinite(least) ? least : 0;
    let high = Number.isFinite(most) ? most : 0;
    if (this.withZero) {
      low = Math.min(low, 0);
      high = Math.max(high, 0);
    }
    const missing = Math.max(0, this.leastSpan - (high - low)) / 2;
    low -= missing;
    high += missing;
    const room = 0.06 * (high - low);
    const step = niceStep(high - low, 8);
    return [Math.floor((low - room) / step) * step, Math.ceil((high + room) / step) * step];
  }
}
