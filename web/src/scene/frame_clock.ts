// Measures frame periods, and the script time of the page in each frame.

/** Number of frames that are kept. */
const WINDOW = 90;
/** A longer gap means that the page was hidden [ms]. */
const PAUSE_MS = 1000;

function quantile(values: readonly number[], share: number): number {
  if (values.length === 0) return 0;
  const sorted = [...values].sort((a, b) => a - b);
  return sorted[Math.min(sorted.length - 1, Math.floor(share * sorted.length))];
}

export class FrameClock {
  private readonly between: number[] = [];
  private readonly script: number[] = [];
  private last_ms: number | undefined;

  /** @param now_ms begin of this frame @param script_ms its script time */
  add(now_ms: number, script_ms: number): void {
    const gap = this.last_ms === undefined ? 0 : now_ms - this.last_ms;
    this.last_ms = now_ms;
    if (gap > 0 && gap < PAUSE_MS) this.between.push(gap);
    this.script.push(script_ms);
    if (this.between.length > WINDOW) this.between.shift();
    if (this.script.length > WINDOW) this.script.shift();
  }

  /** Median time between the last 15 frames [ms]. */
  get frame_ms(): number { return quantile(this.between.slice(-15), 0.5); }
  /** 95th percentile of the script's time over the window [ms]. */
  get script_ms(): number { return quantile(this.script, 0.95); }
}
