import type { AxisT, WorldStateT } from '../protocol';
import { extremesOf, STORED_SERIES, type StoredSeries, type PlotSource, type Span, type TimeTick } from './plot_source';
import { SampleWindow } from './sample_window';

/** Length of the window that the plots show [s]. */
export const WINDOW_S = 10;
// Twice 60 messages a second, so that a program that sends faster still fills the window.
const CAPACITY = 2 * 60 * WINDOW_S;
/** Distance between two sessions on the plots' clock [s]: long enough that no speed is computed across it. */
const BETWEEN_SESSIONS_S = 0.6;
/** A longer time without a sample means a lost connection or a suspended page [s]. */
const GAP_S = 0.5;
/** Labels of the time axis, before now [s]. */
const TICKS_S = [10, 8, 6, 4, 2, 0];

/** Factors to display units: forces at the tip for torques, degrees, millimetres. */
export interface DisplayUnits {
  effort: number;
  coordinate: number;
  effortUnit: string;
  coordinateUnit: string;
}

export function displayUnits(axis: Pick<AxisT, 'unit' | 'leverArmM'>): DisplayUnits {
  // An axis without a unit is shown in the program's own.
  if (String(axis.unit ?? '') === '') return { effort: 1, coordinate: 1, effortUnit: '', coordinateUnit: '' };
  const turns = String(axis.unit) === 'rad';
  const tip = turns && axis.leverArmM > 0;
  return {
    effort: tip ? 1 / axis.leverArmM : 1,
    coordinate: turns ? 180 / Math.PI : 1000,
    effortUnit: turns && !tip ? 'Nm' : 'N',
    coordinateUnit: turns ? '°' : 'mm',
  };
}

/** The last ten seconds of efforts and coordinates. Time continues over a new session and stands still without one. */
export class History implements PlotSource {
  readonly live = true;
  readonly samples: SampleWindow;
  private readonly units: DisplayUnits[];
  private readonly row: Float64Array;
  private tick: bigint | undefined;
  private session = 0;
  private program_s = 0;
  private own_s = 0;

  constructor(axes: readonly AxisT[]) {
    this.units = axes.map(displayUnits);
    const columns = 2 + STORED_SERIES.length * axes.length;
    this.samples = new SampleWindow(columns, CAPACITY);
    this.row = new Float64Array(columns);
  }

  /** Time of the latest sample, on the plots' own clock [s]. */
  get now_s(): number {
    return this.own_s;
  }

  get window(): Span {
    return { from_s: this.own_s - WINDOW_S, to_s: this.own_s };
  }

  get alphaColumn(): number {
    return 1;
  }

  column(kept: StoredSeries, axis: number): number {
    return 2 + STORED_SERIES.indexOf(kept) * this.units.length + axis;
  }

  times(): Float64Array {
    return this.samples.column(0, this.count());
  }

  values(column: number): Float64Array {
    return this.samples.column(column, this.count());
  }

  current(column: number): number {
    return this.samples.latest(column);
  }

  extremes(columns: readonly number[]): readonly [number, number] {
    return extremesOf(columns.map((column) => this.values(column)));
  }

  timeTicks(now: string): readonly TimeTick[] {
    return TICKS_S.map((before_s) => ({ at_s: this.own_s - before_s, name: before_s === 0 ? now : `−${before_s} s` }));
  }

  /** Where a tick of the present session lies on the plots' clock [s]. */
  timeOfTick(tick: bigint, period_s: number): number {
    return this.tick === undefined ? this.own_s : this.own_s - Number(this.tick - tick) * period_s;
  }

  /** Adds a state; false when it has no new sample. */
  add(state: WorldStateT): boolean {
    if (this.tick === state.tick && this.session === state.session) return false;
    const step_s = state.timeS - this.program_s;
    // Messages that a busy page missed leave a gap of their duration.
    const follows = this.session === state.session && step_s > 0;
    if (this.tick !== undefined && !(follows && step_s <= GAP_S)) this.addGap();
    this.own_s += follows ? step_s : BETWEEN_SESSIONS_S;
    this.tick = state.tick;
    this.session = state.session;
    this.program_s = state.timeS;
    this.row[0] = this.own_s;
    this.row[1] = state.alpha;
    this.units.forEach((unit, i) => {
      this.row[this.column('effort', i)] = (state.sent[i] ?? NaN) * unit.effort;
      this.row[this.column('device', i)] = (state.qM[i] ?? NaN) * unit.coordinate;
      this.row[this.column('avatar', i)] = (state.qS[i] ?? NaN) * unit.coordinate;
      this.row[this.column('phi', i)] = state.phi[i] ?? NaN;
    });
    this.samples.push(this.row);
    return true;
  }

  /** Adds a gap: nothing is known until the next sample, and no line is drawn over it. */
  private addGap(): void {
    this.row.fill(NaN);
    this.row[0] = this.own_s;
    this.samples.push(this.row);
  }

  /** Largest magnitude in the window of one series of an axis, in display units. */
  peak(kept: StoredSeries, axis: number): number {
    const [least, most] = this.extremes([this.column(kept, axis)]);
    return Math.max(0, -least, most);
  }

  /** Highest speed in the window of these translations together, over steps of about 50 ms [m/s]. */
  peakSpeed(axes: readonly number[]): number {
    const count = this.count();
    const times = this.samples.column(0, count);
    const columns = axes.map((axis) => this.samples.column(this.column('device', axis), count));
    const stride = 3;
    let most = 0;
    for (let k = stride; k < count; k += 1) {
      const dt_s = times[k] - times[k - stride];
      if (!(dt_s > 0) || dt_s > 0.5) continue;
      const moved_mm = Math.hypot(...columns.map((column) => column[k] - column[k - stride]));
      if (Number.isFinite(moved_mm)) most = Math.max(most, moved_mm / 1000 / dt_s);
    }
    return most;
  }

  /** How many samples the window holds. */
  count(): number {
    return this.samples.countSince(this.own_s - WINDOW_S);
  }
}
