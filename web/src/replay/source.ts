import type { SceneT, WorldStateT } from '../protocol';
import type { Span } from '../console/plot_source';
import type { RecordingInfo } from './about';
import type { BodiesHistory } from './bodies_history';
import type { Problem } from './problem';
import type { SeriesPiece } from './series_piece';

/** What the stores of a recording load. */
export interface StateReader { readStates(first: number, count: number, step: number): Promise<Uint8Array[]> }
export interface SeriesReader { readSeries(from_s: number, to_s: number, columns: number): Promise<SeriesPiece> }

/** The drawn part of a piece: columns `from` to `to`. */
export interface Run { readonly piece: SeriesPiece; readonly from: number; readonly to: number; readonly width_s: number }

/** The loaded states of a recording. */
export interface States {
  /** Requests states around a row that a person chose, with a step of `step` rows. */
  wantAround(row: number, step: number): void;
  /** Requests states from a row on, for playback. */
  wantFrom(row: number, step: number): void;
  /** The nearest row that has a state. */
  existing(row: number): number;
  /** The row that is `states` states after this one (before, if negative). */
  stepped(row: number, states: number): number;
  /** The loaded row nearest to this one; undefined: none is loaded yet. */
  nearest(row: number): number | undefined;
  /** Time of a loaded row. */
  time_s(row: number): number | undefined;
  /** The state of a loaded row; throws a Problem if it cannot be read. */
  state(row: number): WorldStateT | undefined;
  grow(ticks: number): void;
  retry(): void;
  close(): void;
}

/** The loaded series of a recording. */
export interface Series {
  /** Share of the whole recording that is loaded. */
  readonly progress: number;
  /** Requests a window in this many columns. */
  look(window: Span, columns: number): void;
  /** The loaded data of that window. */
  runs(): Run[];
  /** The loaded pieces of the whole recording in order of time, and the missing spans. */
  overview(): SeriesPiece[];
  missing(): Span[];
  grow(to_s: number): void;
  retry(): void;
  close(): void;
}

type ReportProblem = (problem: Problem | undefined) => void;

/** The origin of a recording: a program, or the page's own file. Every failure is a Problem. */
export interface Source {
  readonly name: string;
  /** Address of this recording's report. */
  readonly reportUrl: string;
  about(): Promise<RecordingInfo>;
  scene(): Promise<SceneT>;
  /** Bodies that a game put into the scene. */
  bodies(): Promise<BodiesHistory>;
  /** @param changed called when states came */
  states(about: RecordingInfo, changed: () => void, report: ReportProblem): States;
  /** @param came called with every piece */
  series(about: RecordingInfo, came: (piece: SeriesPiece) => void, report: ReportProblem): Series;
}
