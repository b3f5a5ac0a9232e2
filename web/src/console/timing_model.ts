/** A point of the curve "how many ticks took longer than this". */
export interface TailPoint {
  time_us: number;
  count: number;
}

export interface TickTimes {
  ticks: number;
  p50_us: number;
  p99_us: number;
  p999_us: number;
  max_us: number;
}

/**
 * The tail of the tick times from its quantiles: by definition half of the ticks took longer than
 * p50, one in a hundred longer than p99, one in a thousand longer than p99.9, and one the maximum.
 */
export function tail(times: TickTimes): TailPoint[] {
  if (!(times.ticks > 0)) return [];
  const points = [
    { time_us: 0, count: times.ticks },
    { time_us: times.p50_us, count: times.ticks / 2 },
    { time_us: times.p99_us, count: times.ticks / 100 },
    { time_us: times.p999_us, count: times.ticks / 1000 },
    { time_us: times.max_us, count: 1 },
  ];
  // A short run has fewer than a thousand ticks: points that count less than one tick are left out.
  return points.filter((point, i) => i === points.length - 1 || point.count > 1);
}

/** Right end of the time axis: the deadline with some room, or the slowest tick if that is later. */
export function timeEnd(deadline_us: number, max_us: number): number {
  return Math.max(1.1 * deadline_us, 1.05 * max_us);
}

/** Height of a count on a logarithmic axis that ends at `most`, 0 .. 1; one tick is just visible. */
export function logHeight(count: number, most: number): number {
  const floor = 0.7;
  if (!(count > floor)) return 0;
  return Math.min(1, Math.log(count / floor) / Math.log(Math.max(most, 10) / floor));
}

/** 1, 100, 10 000 … up to `most`, with their names. */
export function logTicks(most: number): { count: number; name: string }[] {
  const names = ['1', '10²', '10⁴', '10⁶', '10⁸', '10¹⁰'];
  return names.map((name, i) => ({ count: 100 ** i, name })).filter(({ count }) => count <= most);
}
