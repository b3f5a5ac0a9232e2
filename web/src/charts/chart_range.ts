export interface ChartLine {
  readonly name: string;
  /** A colour, or "var(--name)" of the style at the chart. */
  readonly color: string;
  readonly dash?: readonly number[];
  readonly width?: number;
  /** Its own x, not falling; that of the chart where there is none. */
  readonly x?: ArrayLike<number>;
  readonly values: ArrayLike<number>;
  /** Dots of this diameter, and no line. */
  readonly dots?: number;
  /** Holds each value until the next. */
  readonly stepped?: boolean;
  readonly filled?: boolean;
}

/** All values with some room, and what is to be held at least; one end at zero where all values lie on its side. */
export function rangeOf(lines: readonly ChartLine[], holds: readonly [number, number] = [Infinity, -Infinity]): [number, number] {
  let [low, high] = holds;
  for (const { values } of lines) {
    for (let i = 0; i < values.length; i += 1) {
      if (values[i] < low) low = values[i];
      if (values[i] > high) high = values[i];
    }
  }
  if (!(low <= high)) return [0, 1];
  const room = 0.06 * (high - low) || 0.5;
  return [low < 0 || low > 0 ? low - room : 0, high + room];
}

/** Steps that a clock has [s]. */
const TIME_STEPS_S = [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 15, 30, 60, 120, 300, 600, 900, 1800, 3600, 7200, 10_800, 21_600];

/** Round times within two ends [s], at most so many of them. */
export function timeNumbers(from_s: number, to_s: number, most: number): number[] {
  const step_s = TIME_STEPS_S.find((step) => (to_s - from_s) / step <= most - 1) ?? (to_s - from_s) / (most - 1);
  const first = Math.ceil(from_s / step_s - 1e-9);
  // Each from its number, so that no rounding adds up.
  return Array.from({ length: Math.max(0, Math.floor(to_s / step_s + 1e-9) - first + 1) }, (_, k) => Number(((first + k) * step_s).toFixed(6)));
}

/** 1, 2 and 5 times powers of ten within two positive ends; over many decades the powers alone. */
export function logarithmicNumbers(low: number, high: number): number[] {
  const digits = high / low < 2e3 ? [1, 2, 5] : [1];
  const out: number[] = [];
  for (let power = Math.floor(Math.log10(low)); power <= Math.log10(high); power += 1) {
    // Written out, as 5 × 10^-3 is not 0.005 to the last bit.
    out.push(...digits.map((digit) => Number(`${digit}e${power}`)).filter((x) => x >= low && x <= high));
  }
  return out;
}
