import type { SceneT, WorldStateT } from '../protocol';
import type { Span } from '../console/plot_source';
import type { About } from './about';
import type { BodiesHistory } from './bodies_history';
import type { Problem } from './problem';
import type { SeriesPiece } from './series_piece';
import type { Run } from './series_store';

/** The states of a recording, as far as they are known. */
export interface States {
  /** A person looks for this row; `step` rows lie between two states around it. */
  wantAround(row: number, step: number): void;
  /** The rows from this one on are played. */
  wantFrom(row: number, step: number): void;
  /** The row of a state that there is, instead of any row: this one, or the nearest. */
  existing(row: number): number;
  /** So many states on, or back. */
  stepped(row: number, states: number): number;
  /** The known row that is nearest to this one; undefined: none is known yet. */
  nearest(row: number): number | undefined;
  /** Time of a known row. */
  time_s(row: number): number | undefined;
  /** The state of a known row; throws a Problem where it cannot be read. */
  state(row: number): WorldStateT | undefined;
  grow(ticks: number): void;
  retry(): void;
  close(): void;
}

/** The series of a recording, as far as they are known. */
export interface Series {
  /** Share of the whole recording that has come. */
  readonly progress: number;
  /** A window is looked at in so many columns. */
  look(window: Span, columns: number): void;
  /** What is known of that window. */
  runs(): Run[];
  /** What of the whole recording has come, in order of time, and what has not. */
  overview(): SeriesPiece[];
  missing(): Span[];
  grow(to_s: number): void;
  retry(): void;
  close(): void;
}

type Tell = (problem: Problem | undefined) => void;

/** Where a page has a recording from: a program, or its own file. Every failure is a Problem. */
export interface Source {
  readonly name: string;
  /** Of the report of this recording. */
  readonly reportUrl: string;
  about(): Promise<About>;
  scene(): Promise<SceneT>;
  /** Bodies that a game put into the scene. */
  bodies(): Promise<BodiesHistory>;
  /** @param changed is called when states came */
  states(about: About, changed: () => void, tell: Tell): States;
  /** @param came is called with every piece */
  series(about: About, came: (piece: SeriesPiece) => void, tell: Tell): Series;
}
