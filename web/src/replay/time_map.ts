import type { RecordingInfo } from './about';
import type { Gap } from './series_piece';

/** A row that is known to be the first one at or after a time. */
interface Anchor { readonly row: number; readonly from_s: number }

/** Tolerance for rounded times in files and messages, in ticks. */
const CLOSE = 1e-3;

/**
 * Maps times to rows of the file: evenly from the nearest known row, except for missing ticks. A late loop skips ticks
 * that are not listed as missing: then the map is exact at every row that the series reported, approximate in between,
 * and corrected by the states.
 */
export class TimeMap {
  private gaps: readonly Gap[] = [];
  private anchors: readonly Anchor[];
  private readonly period_s: number;

  constructor(about: Pick<RecordingInfo, 'from_s' | 'period_s'>, private ticks: number) {
    this.period_s = about.period_s;
    this.anchors = [{ row: 0, from_s: about.from_s - about.period_s / 2 }];
  }

  /** @param gaps in order of time; each ends at the first row after it */
  setGaps(gaps: readonly Gap[]): void {
    this.gaps = gaps;
  }

  /** Adds the first row at or after a time that lies between two ticks. */
  addAnchor(row: number, from_s: number): void {
    if (!Number.isInteger(row) || row <= 0 || row >= this.ticks || this.anchors.some((anchor) => anchor.row === row)) return;
    this.anchors = [...this.anchors, { row, from_s }].sort((a, b) => a.from_s - b.from_s);
  }

  grow(ticks: number): void {
    this.ticks = ticks;
  }

  /** The row at a time; in a gap the last row before it. */
  rowAt(time_s: number): number {
    const anchor = this.anchors.filter(({ from_s }) => from_s <= time_s).at(-1) ?? this.anchors[0];
    const next = this.anchors[this.anchors.indexOf(anchor) + 1]?.row ?? this.ticks;
    const passed = Math.floor((time_s - anchor.from_s) / this.period_s + CLOSE);
    const row = anchor.row + passed - this.missing(anchor.from_s, time_s);
    return Math.max(0, Math.min(Math.max(anchor.row - 1, row), next - 1, this.ticks - 1));
  }

  timeAt(row: number): number {
    const anchor = this.anchors.filter((other) => other.row <= row).at(-1) ?? this.anchors[0];
    let time_s = anchor.from_s + (row - anchor.row + 0.5) * this.period_s;
    for (const gap of this.gaps) {
      const begin_s = Math.max(this.beginOf(gap), anchor.from_s);
      if (gap.to_s > anchor.from_s && time_s >= begin_s - this.period_s / 2) time_s += this.missing(anchor.from_s, gap.to_s, [gap]) * this.period_s;
    }
    return time_s;
  }

  /** Time of the first missing tick. */
  private beginOf({ to_s, ticks }: Gap): number {
    return to_s - ticks * this.period_s;
  }

  /** Number of missing ticks between two times. */
  private missing(from_s: number, to_s: number, gaps = this.gaps): number {
    return gaps.reduce((sum, gap) => {
      const begin_s = this.beginOf(gap);
      const first = Math.max(0, Math.ceil((from_s - begin_s) / this.period_s - CLOSE));
      const last = Math.min(gap.ticks - 1, Math.floor((to_s - begin_s) / this.period_s + 0.5));
      return sum + Math.max(0, last - first + 1);
    }, 0);
  }
}
