import type { Mark } from '../console/marks';
import type { PlotsModel } from '../console/plot_panel';
import type { Span } from '../console/plot_source';
import { texts as consoleTexts } from '../console/i18n';
import type { GameBodyShown } from '../net/game_bodies';
import { AxisT, SceneT, type WorldStateT } from '../protocol';
import { ExercisePanel } from '../exercises/panel';
import type { RecordingInfo } from './about';
import { BodiesHistory } from './bodies_history';
import { ColumnList } from './channels';
import { texts } from './i18n';
import { Moments, plotMark, type Names } from './moments';
import { asProblem, type Problem } from './problem';
import type { SeriesPiece } from './series_piece';
import { SeriesView } from './series_view';
import type { Series, Source, States } from './source';
import { stepFor } from './state_store';
import { TimeMap } from './time_map';
import { WindowSamples } from './window_samples';

/** Number of columns of a plot: about its width in pixels. */
const COLUMNS = 500;
/** Pictures per second during playback [Hz]. */
const PICTURES_HZ = 60;
/** Largest step of rows between two states: the program reads every chunk of the file that a block overlaps. */
const COARSEST = 64;
/** Maximum number of iterations to find the row of a time. */
const CORRECTIONS = 5;

/** One shown recording: its loaded data, and the state at the current time. */
export class ReplaySide implements PlotsModel {
  about: RecordingInfo;
  /** The scene of the file; without one, names and axes as the file states them. */
  scene: SceneT;
  readonly hasScene: boolean;
  state: WorldStateT | null = null;
  /** Bodies of a game at the shown row. */
  bodies: readonly GameBodyShown[] = [];
  history: SeriesView;
  readonly marks: { list: readonly Mark[] } = { list: [] };
  readonly moments = new Moments();
  readonly map: TimeMap;
  readonly states: States;
  readonly series: Series;
  /** The shown row, and the requested one. */
  shown: number | undefined;
  wanted = 0;
  /** Offset from the recording's time to the page's [s]. */
  shift_s = 0;
  /** The program does not answer, or a part cannot be read. */
  problem: Problem | undefined;
  /** New data came that is not drawn yet. */
  fresh = true;
  private panel: ExercisePanel | null;
  private bodiesAt = new BodiesHistory();

  private constructor(readonly source: Source, about: RecordingInfo, scene: SceneT | undefined) {
    this.about = about;
    this.hasScene = scene !== undefined;
    this.scene = scene ?? sceneOf(about);
    this.panel = ExercisePanel.of(this.scene);
    this.map = new TimeMap(about, about.ticks);
    this.history = new SeriesView(new ColumnList(), [], this.scene);
    const report = (problem: Problem | undefined): void => this.report(problem);
    this.states = source.states(about, () => { this.fresh = true; }, report);
    this.series = source.series(about, (piece) => this.take(piece), report);
    void this.loadBodies();
  }

  /** Opens a recording; throws a Problem if nothing of it can be shown. */
  static async open(source: Source): Promise<ReplaySide> {
    const about = await source.about();
    let scene: SceneT | undefined;
    try {
      scene = about.picture ? await source.scene() : undefined;
    } catch (thrown) {
      const problem = asProblem(thrown);
      if (problem.kind === 'gone') throw problem;
      return new ReplaySide(source, { ...about, picture: false, no_picture_because: problem.text }, undefined);
    }
    return new ReplaySide(source, about, scene);
  }

  /** First to last tick, in the page's time. */
  get span(): Span {
    const { from_s, to_s, period_s } = this.about;
    return { from_s: from_s + this.shift_s, to_s: Math.max(from_s, to_s - period_s) + this.shift_s };
  }

  get names(): Names {
    return { eventNames: this.scene.eventNames, ownWords: (type) => this.panel?.event(type) ?? '' };
  }

  value(name: string): number | undefined {
    const index = this.scene.valueNames.indexOf(name);
    return index < 0 ? undefined : this.state?.values[index];
  }

  parameter(name: string): number | undefined {
    const index = this.scene.parameters.findIndex((parameter) => parameter.name === name);
    return index < 0 ? undefined : this.state?.parameters[index];
  }

  /** Sets the axes that the plots are made for. */
  setColumns(list: ColumnList, axes: readonly string[]): void {
    this.history = new SeriesView(list, axes, this.scene);
    this.history.state = this.state;
  }

  /** Requests the series of a window in the page's time. */
  look(window: Span): void {
    const { shift_s, about } = this;
    const own = { from_s: window.from_s - shift_s, to_s: window.to_s - shift_s };
    this.series.look(own, COLUMNS);
    this.history.take(window, new WindowSamples(this.series.runs(), this.moments.gaps, about.period_s), shift_s);
    this.marks.list = this.moments.within(own).map((moment) => {
      const mark = plotMark(moment, this.names, texts(), consoleTexts());
      return { ...mark, time_s: mark.time_s + shift_s };
    });
  }

  /** The row at a time of the page; undefined: this recording has no data there. */
  rowAt(time_s: number): number | undefined {
    const own_s = time_s - this.shift_s;
    const { from_s, to_s, period_s, ticks } = this.about;
    return ticks === 0 || own_s < from_s - period_s / 2 || own_s > to_s - period_s / 2 ? undefined : this.map.rowAt(own_s);
  }

  /** Requests the states for a time, and shows the nearest loaded one. True when another state is shown. */
  seek(time_s: number, window: Span, playing: boolean, speed: number): boolean {
    const mapped = this.rowAt(time_s);
    if (mapped === undefined) return false;
    const row = this.states.existing(this.corrected(mapped, time_s - this.shift_s));
    this.wanted = row;
    const { period_s } = this.about;
    if (playing) this.states.wantFrom(row, stepFor(speed / PICTURES_HZ / period_s));
    else this.states.wantAround(row, Math.min(COARSEST, Math.max(4, stepFor((window.to_s - window.from_s) / COLUMNS / period_s))));
    const nearest = this.states.nearest(row);
    if (nearest === undefined || nearest === this.shown) return false;
    return this.show(nearest);
  }

  /** Time of a row on the page's clock, from its state if that is loaded. */
  timeOf(row: number): number {
    return (this.states.time_s(row) ?? this.map.timeAt(row)) + this.shift_s;
  }

  /** Corrects a row of the time map by the times of loaded states. */
  private corrected(row: number, own_s: number): number {
    let best = row;
    let off_s = Infinity;
    for (let i = 0; i < CORRECTIONS; i += 1) {
      const time_s = this.states.time_s(row);
      if (time_s === undefined || Math.abs(own_s - time_s) >= off_s) break;
      [best, off_s] = [row, Math.abs(own_s - time_s)];
      row = Math.min(this.about.ticks - 1, Math.max(0, row + Math.round((own_s - time_s) / this.about.period_s)));
    }
    return off_s === Infinity ? row : best;
  }

  /** Takes the new length of a file that is still being written. */
  grow(about: RecordingInfo): void {
    this.about = { ...about, picture: this.about.picture, no_picture_because: this.about.no_picture_because };
    this.map.grow(about.ticks);
    this.states.grow(about.ticks);
    this.series.grow(about.to_s);
    void this.loadBodies();
    this.fresh = true;
  }

  retry(): void {
    this.states.retry();
    this.series.retry();
  }

  close(): void {
    this.states.close();
    this.series.close();
  }

  private show(row: number): boolean {
    try {
      this.state = this.states.state(row) ?? this.state;
    } catch (thrown) {
      this.report(asProblem(thrown));
      return false;
    }
    this.shown = row;
    this.bodies = this.bodiesAt.at(row);
    this.history.state = this.state;
    return true;
  }

  /** Loads the game's bodies; the picture is usable without them. */
  private async loadBodies(): Promise<void> {
    if (!this.hasScene || this.scene.budget === null) return;
    try {
      this.bodiesAt = await this.source.bodies();
    } catch (thrown) {
      this.report(asProblem(thrown));
      return;
    }
    this.shown = undefined;   // the row is shown again with the bodies
    this.fresh = true;
  }

  private take(piece: SeriesPiece): void {
    this.map.addAnchor(piece.first_tick, piece.from_s);
    this.moments.add(piece);
    this.map.setGaps(this.moments.gaps);
    this.fresh = true;
  }

  private report(problem: Problem | undefined): void {
    // A part that cannot be read stays reported even if other parts load.
    if (problem === undefined && this.problem?.kind !== 'gone') return;
    this.problem = problem;
    this.fresh = true;
  }
}

/** A scene with the fields that plots need, from the description of the file. */
export function sceneOf({ axes, value_names, event_names, period_s }: RecordingInfo): SceneT {
  const scene = new SceneT();
  scene.axes = axes.map(({ name, unit, effort_limit, lever_arm_m }) => new AxisT(name, unit, 0, 0, effort_limit, lever_arm_m, 0));
  scene.valueNames = [...value_names];
  scene.eventNames = [...event_names];
  scene.periodS = period_s;
  return scene;
}
