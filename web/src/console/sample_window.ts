/**
 * The last samples of several columns. Every value is written twice, one capacity apart, so that
 * the window of the latest samples is always one unbroken piece and nothing is copied to draw it.
 */
export class SampleWindow {
  private readonly data: Float64Array[];
  private next = 0;
  private filled = 0;

  constructor(columns: number, private readonly capacity: number) {
    this.data = Array.from({ length: columns }, () => new Float64Array(2 * capacity));
  }

  get length(): number {
    return this.filled;
  }

  clear(): void {
    this.next = this.filled = 0;
  }

  /** Adds a row; columns that it does not name are 0. */
  push(row: ArrayLike<number>): void {
    this.data.forEach((column, c) => {
      column[this.next] = column[this.next + this.capacity] = row[c] ?? 0;
    });
    this.next = (this.next + 1) % this.capacity;
    this.filled = Math.min(this.filled + 1, this.capacity);
  }

  /** The latest `count` values of a column, oldest first; valid until the next push. */
  column(c: number, count = this.filled): Float64Array {
    const end = this.next + (this.next < count ? this.capacity : 0);
    return this.data[c].subarray(end - count, end);
  }

  latest(c: number): number {
    return this.filled === 0 ? Number.NaN : this.data[c][(this.next + this.capacity - 1) % this.capacity];
  }

  /** How many of the latest samples have a first column of at least `from` (it never falls). */
  countSince(from: number): number {
    const times = this.column(0);
    let low = 0;
    let high = times.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (times[middle] < from) low = middle + 1;
      else high = middle;
    }
    return times.length - low;
  }
}
