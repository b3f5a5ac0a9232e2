/**
 * One-euro filter (Casiez, Roussel, Vogel, CHI 2012): a first-order low-pass whose cut-off rises
 * with speed, so that a resting hand does not tremble and a moving hand has little delay.
 */
export interface OneEuroConfig {
  /** Cut-off at rest [Hz]. */
  minCutoff_hz: number;
  /** Rise of the cut-off with speed [Hz per unit/s]. */
  beta: number;
  /** Cut-off of the speed estimate [Hz]. */
  speedCutoff_hz: number;
}

/** Weight of the new sample: 1 / (1 + τ/T) with τ = 1 / (2π f_c). */
export function lowPassWeight(cutoff_hz: number, period_s: number): number {
  const tau_s = 1 / (2 * Math.PI * cutoff_hz);
  return 1 / (1 + tau_s / period_s);
}

export class OneEuroFilter {
  private value: number | undefined;
  private raw = 0;
  private speed = 0;
  private time_s = 0;

  constructor(private readonly config: OneEuroConfig) {}

  reset(): void {
    this.value = undefined;
    this.speed = 0;
  }

  /** The smoothed value at `time_s`; samples that do not advance time are ignored. */
  filter(sample: number, time_s: number): number {
    if (!Number.isFinite(sample)) return this.value ?? 0;
    if (this.value === undefined) {
      this.value = this.raw = sample;
      this.time_s = time_s;
      return sample;
    }
    const period_s = time_s - this.time_s;
    if (!(period_s > 0)) return this.value;
    const { minCutoff_hz, beta, speedCutoff_hz } = this.config;
    const rawSpeed = (sample - this.raw) / period_s;
    this.speed += lowPassWeight(speedCutoff_hz, period_s) * (rawSpeed - this.speed);
    const cutoff_hz = minCutoff_hz + beta * Math.abs(this.speed);
    this.value += lowPassWeight(cutoff_hz, period_s) * (sample - this.value);
    this.raw = sample;
    this.time_s = time_s;
    return this.value;
  }
}
