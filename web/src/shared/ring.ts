/** A ring buffer with the last `capacity` rows of `channels` numbers; the oldest row is overwritten. It does not allocate after construction. */
export class Ring {
  length = 0;
  private next = 0;
  private readonly data: Float64Array;

  constructor(readonly capacity: number, readonly channels: number) {
    this.data = new Float64Array(capacity * channels);
  }

  push(row: ArrayLike<number>): void {
    const at = this.next * this.channels;
    for (let c = 0; c < this.channels; c++) this.data[at + c] = row[c];
    this.next = (this.next + 1) % this.capacity;
    if (this.length < this.capacity) this.length += 1;
  }

  clear(): void { this.length = this.next = 0; }

  /** Row 0 is the oldest. */
  at(row: number, channel: number): number {
    const first = this.length < this.capacity ? 0 : this.next;
    return this.data[((first + row) % this.capacity) * this.channels + channel];
  }

  /** Copies one channel, oldest first, into `out` (at least `length` long); returns how many. */
  copy(channel: number, out: Float64Array): number {
    const first = this.length < this.capacity ? 0 : this.next;
    for (let i = 0, row = first; i < this.length; i++) {
      out[i] = this.data[row * this.channels + channel];
      row = row + 1 === this.capacity ? 0 : row + 1;
    }
    return this.length;
  }
}

/** The smallest sample that is not exceeded by the given share of the samples (nearest rank); NaN without samples. */
export function quantile(samples: ArrayLike<number>, share: number): number {
  const sorted = Float64Array.from(samples).sort();
  return sorted.length === 0 ? NaN : sorted[Math.min(sorted.length - 1, Math.max(0, Math.ceil(share * sorted.length) - 1))];
}
