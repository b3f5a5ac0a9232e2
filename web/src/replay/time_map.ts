import type { About } from './about';
import type { Gap } from './series_piece';

/** Which row of the file lies at which time: evenly, but for the ticks that are missing. */
export class TimeMap {
  private gaps: readonly Gap[] = [];
  private readonly from_s: number;
  private readonly period_s: number;

  constructor(about: Pick<About, 'from_s' | 'period_s'>, private ticks: number) {
    this.from_s = about.from_s;
    this.period_s = about.period_s;
  }

  /** @param gaps in order of time; each from the last row before it to the first one after it */
  setGaps(gaps: readonly Gap[]): void {
    this.gaps = gaps;
  }

  grow(ticks: number): void {
    this.ticks = ticks;
  }

  /** The row at a time; in a gap the last one before it. */
  rowAt(time_s: number): number {
    let row = Math.round((time_s - this.from_s) / this.period_s);
    for (const gap of this.gaps) {
      if (gap.from_s > time_s) break;
      row -= Math.min(gap.ticks, Math.max(0, Math.round((time_s - gap.from_s) / this.period_s)));
    }
    return Math.min(Math.max(0, this.ticks - 1), Math.max(0, row));
  }

  timeAt(row: number): number {
    let ticks = row;
    for (const gap of this.gaps) {
      if (this.from_s + (ticks - 0.5) * this.period_s < gap.from_s) break;
      ticks += gap.ticks;
    }
    return this.from_s + ticks * this.period_s;
  }
}
