/** The stored series of every axis, one column each. */
export const STORED_SERIES = ['effort', 'device', 'avatar', 'phi'] as const;
export type StoredSeries = (typeof STORED_SERIES)[number];

/** Columns of the values of an axis, by its index in the list of axes that the plots are made for. */
export interface PlotColumns {
  column(kept: StoredSeries, axis: number): number;
  readonly alphaColumn: number;
}

export interface Span { readonly from_s: number; readonly to_s: number }
export interface TimeTick { readonly at_s: number; readonly name: string }

/** The samples within a window of time that plots draw. The live history and a recording are such sources. */
export interface PlotSource extends PlotColumns {
  /** The window that is shown. */
  readonly window: Span;
  /** The window moves along with time: the ranges of the plots change slowly. */
  readonly live: boolean;
  /** Times of the samples in the window, ascending; valid until the next sample. */
  times(): Float64Array;
  /** As many values as times; NaN marks unknown values. */
  values(column: number): Float64Array;
  /** The value that is shown beside the name: the newest one, or that at the play head. */
  current(column: number): number;
  /** Smallest and largest value of these columns in the window; Infinity and -Infinity where there is none. */
  extremes(columns: readonly number[]): readonly [number, number];
  /** Labelled times of the axis. @param now the word for the present */
  timeTicks(now: string): readonly TimeTick[];
}

/** Smallest and largest of these values; NaN is ignored. */
export function extremesOf(columns: readonly ArrayLike<number>[]): [number, number] {
  let least = Infinity;
  let most = -Infinity;
  for (const values of columns) {
    for (let i = 0; i < values.length; i += 1) {
      if (values[i] < least) least = values[i];
      if (values[i] > most) most = values[i];
    }
  }
  return [least, most];
}
