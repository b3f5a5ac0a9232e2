import type { Gap, SeriesPiece } from './series_piece';
import type { Run } from './source';

/** The origin of a sample of the window; without a piece its value is unknown. */
interface Place { readonly piece: SeriesPiece | undefined; readonly column: number; readonly high: boolean }

/** The samples of a window, assembled from pieces: low and high of every column that has ticks, an unknown value where ticks are missing. */
export class WindowSamples {
  readonly times: Float64Array;
  private readonly places: readonly Place[];
  private readonly made = new Map<string, Float64Array>();

  /** @param period_s a column of one period has one tick, and gives one sample */
  constructor(runs: readonly Run[], gaps: readonly Gap[], period_s: number) {
    const samples: { time_s: number; place: Place }[] = [];
    let end_s = -Infinity;
    const hole = (time_s: number): void => { samples.push({ time_s, place: { piece: undefined, column: 0, high: false } }); };
    for (const { piece, from, to, width_s } of runs) {
      const known = knownColumns(piece);
      if (piece.from_s + from * width_s > end_s + 1.5 * width_s && end_s > -Infinity) hole(end_s);
      for (let column = from; column < to; column += 1) {
        if (known[column] === 0) continue;
        const time_s = piece.from_s + (column + 0.5) * width_s;
        samples.push({ time_s, place: { piece, column, high: false } });
        if (width_s > 1.5 * period_s) samples.push({ time_s, place: { piece, column, high: true } });
      }
      end_s = piece.from_s + to * width_s;
    }
    const first_s = samples[0]?.time_s ?? Infinity;
    for (const gap of gaps) if (gap.to_s > first_s && gap.from_s < end_s) hole((gap.from_s + gap.to_s) / 2);
    // The sort is stable: low stays before high.
    samples.sort((a, b) => a.time_s - b.time_s);
    this.times = Float64Array.from(samples, ({ time_s }) => time_s);
    this.places = samples.map(({ place }) => place);
  }

  /** Values of a channel times a factor; NaN where they are unknown. */
  values(channel: string, factor: number): Float64Array {
    const key = `${channel} ${factor}`;
    let values = this.made.get(key);
    if (values) return values;
    values = Float64Array.from(this.places, ({ piece, column, high }) => {
      const found = piece?.channels.get(channel);
      // A negative factor exchanges low and high; both are drawn either way.
      return found ? (high ? found.high : found.low)[column] * factor : NaN;
    });
    this.made.set(key, values);
    return values;
  }
}

const known = new WeakMap<SeriesPiece, Uint8Array>();

/** 1 for each column of a piece that has a tick. */
function knownColumns(piece: SeriesPiece): Uint8Array {
  let found = known.get(piece);
  if (found) return found;
  found = new Uint8Array(piece.columns);
  for (const { low } of piece.channels.values()) {
    for (let column = 0; column < piece.columns; column += 1) if (!Number.isNaN(low[column])) found[column] = 1;
  }
  known.set(piece, found);
  return found;
}
