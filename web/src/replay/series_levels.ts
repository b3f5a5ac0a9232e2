import type { Span } from '../console/plot_source';

/** Number of columns in a piece, unless its span would exceed LONGEST_S. */
const COLUMNS = 512;
/** Longest span of one request [s]. */
export const LONGEST_S = 60;
/** A piece has at least this many columns. */
const FEWEST = 8;

/** A span of a recording at one column width, loaded by one request. */
export interface Slot extends Span { readonly key: string; readonly level: number; readonly columns: number }

/**
 * Divides a recording into pieces of columns that are 1, 2, 4, ... periods wide. Edges lie between two ticks, so that
 * each tick falls into the same column whatever the rounding.
 */
export class SeriesLevels {
  constructor(private readonly from_s: number, private to_s: number, private readonly period_s: number) {}

  grow(to_s: number): void {
    this.to_s = to_s;
  }

  /** The level whose columns are at most as wide as `span_s / columns`. */
  levelFor(span_s: number, columns: number): number {
    const widest = Math.floor(Math.log2(LONGEST_S / FEWEST / this.period_s));
    return Math.max(0, Math.min(widest, Math.floor(Math.log2(span_s / columns / this.period_s) + 1e-9)));
  }

  /** The level for the whole recording. */
  overview(columns: number): number {
    return this.levelFor(Math.max(this.period_s, this.to_s - this.from_s), columns);
  }

  width_s(level: number): number {
    return this.period_s * 2 ** level;
  }

  /** The slots of a level that a span overlaps, in order. */
  slots(level: number, { from_s, to_s }: Span): Slot[] {
    const width_s = this.width_s(level);
    const columns = Math.min(COLUMNS, Math.floor(LONGEST_S / width_s));
    const origin_s = this.from_s - this.period_s / 2;
    const last = Math.ceil((Math.min(to_s, this.to_s) - origin_s) / (columns * width_s) - 1e-9);
    const slots: Slot[] = [];
    for (let i = Math.max(0, Math.floor((from_s - origin_s) / (columns * width_s) + 1e-9)); i < last; i += 1) {
      const begin_s = origin_s + i * columns * width_s;
      // The last slot ends with the recording.
      const filled = Math.min(columns, Math.ceil((this.to_s - begin_s) / width_s - 1e-9));
      if (filled >= 1) slots.push({ key: `${level}:${i}`, level, columns: filled, from_s: begin_s, to_s: begin_s + filled * width_s });
    }
    return slots;
  }
}
