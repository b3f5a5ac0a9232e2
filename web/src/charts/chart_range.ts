export interface ChartLine {
  readonly name: string;
  /** A colour, or "var(--name)" in the style of the chart. */
  readonly color: string;
  readonly dash?: readonly number[];
  readonly width?: number;
  /** The line's own x, not falling; the chart's by default. */
  readonly x?: ArrayLike<number>;
  readonly values: ArrayLike<number>;
  /** Diameter of dots; a line with dots has no stroke. */
  readonly dots?: number;
  /** Each value holds until the next one. */
  readonly stepped?: boolean;
  readonly filled?: boolean;
}

/** A range with all values, some room, and the values that it must contain; one end is zero if all values are on one side of it. */
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

/** Steps of a clock [s]. */
const TIME_STEPS_S = [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 15, 30, 60, 120, 300, 600, 900, 1800, 3600, 7200, 10_800, 21_600];

/** Round times between two ends [s], at most `most` of them. */
export function timeNumbers(from_s: number, to_s: number, most: number): number[] {
  const step_s = TIME_STEPS_S.find((step) => (to_s - from_s) / step <= most - 1) ?? (to_s - from_s) / (most - 1);
  const first = Math.ceil(from_s / step_s - 1e-9);
  // Each label is computed from its index, so that rounding does not accumulate.
  return Array.from({ length: Math.max(0, Math.floor(to_s / step_s + 1e-9) - first + 1) }, (_, k) => Number(((first + k) * step_s).toFixed(6)));
}

/** 1, 2 and 5 times powers of ten between two positive ends; over many decades only the powers. */
export function logarithmicNumbers(low: number, high: number): number[] {
  const digits = high / low < 2e3 ? [1, 2, 5] : [1];
  const out: number[] = [];
  for (let power = Math.floor(Math.log10(low)); power <= Math.log10(high); power += 1) {
    // Parsed from text, since 5 × 10^-3 is not exactly 0.005.
    out.push(...digits.map((digit) => Number(`${digit}e${power}`)).filter((x) => x >= low && x <= high));
  }
  return out;
}
