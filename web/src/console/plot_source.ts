/** What is kept of every axis, one column each. */
export const KEPT = ['effort', 'device', 'avatar', 'phi'] as const;
export type Kept = (typeof KEPT)[number];

/** Where the values of an axis are found, by its place in the list of axes that the plots are made for. */
export interface PlotColumns {
  column(kept: Kept, axis: number): number;
  readonly alphaColumn: number;
}

export interface Span { readonly from_s: number; readonly to_s: number }
export interface TimeTick { readonly at_s: number; readonly name: string }

/** What plots draw: samples within a window of time. The live history and a recording are such sources. */
export interface PlotSource extends PlotColumns {
  /** The window that is shown. */
  readonly window: Span;
  /** The window moves along with time: the ranges of the plots keep calm. */
  readonly live: boolean;
  /** Times of the samples in the window, ascending; valid until the next sample. */
  times(): Float64Array;
  /** As many values as times; NaN where nothing is known. */
  values(column: number): Float64Array;
  /** The value that stands beside the name: the newest one, or that at the play head. */
  current(column: number): number;
  /** Smallest and largest value of these columns in the window; Infinity and -Infinity where there is none. */
  extremes(columns: readonly number[]): readonly [number, number];
  /** Times that the axis names. @param now the word for the present */
  timeTicks(now: string): readonly TimeTick[];
}

/** Smallest and largest of these values; NaN counts as nothing. */
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
