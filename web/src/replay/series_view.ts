import { extremesOf, type StoredSeries, type PlotSource, type Span, type TimeTick } from '../console/plot_source';
import type { SceneT, WorldStateT } from '../protocol';
import { channelOf, keptColumn, type Channel, type ColumnList } from './channels';
import { clockTicks } from './clock';
import { WindowSamples } from './window_samples';

/** Largest number of labels on a time axis. */
const TICKS = 7;

/** A window of a recording as a source of plots. Its times are shifted to those of the page. */
export class SeriesView implements PlotSource {
  readonly live = false;
  window: Span = { from_s: 0, to_s: 1 };
  state: WorldStateT | null = null;
  /** The same window of the recording beside it: both use the same range. */
  fellow: SeriesView | undefined;
  private readonly channels = new Map<number, Channel | undefined>();
  private samples = new WindowSamples([], [], 1);
  private shifted = new Float64Array(0);
  private within: readonly [number, number] = [0, 0];

  /** @param axes names of the plots' axes @param scene the scene of this recording */
  constructor(private readonly list: ColumnList, private readonly axes: readonly string[], private readonly scene: Pick<SceneT, 'axes' | 'valueNames'>) {}

  /** Sets the loaded samples of the window. @param shift_s from the recording's time to that of the page and the window */
  take(window: Span, samples: WindowSamples, shift_s: number): void {
    this.window = window;
    this.samples = samples;
    this.shifted = samples.times.map((time_s) => time_s + shift_s);
    const first = this.shifted.findIndex((time_s) => time_s >= window.from_s);
    const after = this.shifted.findIndex((time_s) => time_s > window.to_s);
    this.within = [first < 0 ? this.shifted.length : first, after < 0 ? this.shifted.length : after];
  }

  times(): Float64Array {
    return this.shifted;
  }

  values(column: number): Float64Array {
    const channel = this.channel(column);
    return this.samples.values(channel?.key ?? '', channel?.factor ?? 1);
  }

  current(column: number): number {
    return this.state ? this.valueOf(column, this.state) : NaN;
  }

  extremes(columns: readonly number[]): readonly [number, number] {
    const views = this.fellow ? [this, this.fellow] : [this];
    return extremesOf(views.flatMap((view) => columns.map((column) => view.values(column).subarray(...view.within))));
  }

  timeTicks(): readonly TimeTick[] {
    return clockTicks(this.window, TICKS);
  }

  get alphaColumn(): number {
    return this.list.numberOf({ of: 'alpha' });
  }

  column(kept: StoredSeries, axis: number): number {
    return this.list.numberOf(keptColumn(kept, this.axes[axis]));
  }

  private valueOf(column: number, state: WorldStateT): number {
    const channel = this.channel(column);
    const value = channel?.read(state);
    return channel && value !== undefined ? value * channel.factor : NaN;
  }

  private channel(column: number): Channel | undefined {
    if (!this.channels.has(column)) this.channels.set(column, channelOf(this.list.at(column), this.scene));
    return this.channels.get(column);
  }
}
