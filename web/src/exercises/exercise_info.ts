// What an exercise says in console, replay and report, in addition to its panel: interfaces.
import type { SceneT } from '../protocol';

/** A value of the exercise by its name; undefined where there is none. */
export type Value = (name: string) => number | undefined;

export interface ExerciseInfo {
  /** The current part of the exercise; empty where it has none. */
  progress(value: Value): string;
  /** The caption of the picture; may be empty. */
  caption(value: Value): string;
  /** The name of a level; empty where levels have none. */
  levelName(level: number): string;
  /** The name of a body of the scene; undefined where the exercise has none. */
  bodyName(body: string): string | undefined;
}

/** A sign in the plots for an event that begins a phase of a grasp. */
export interface EventSign { readonly sign: string; meaning(): string; legend(): string }

/** A finished part of an exercise in a report, as found by src/replay/therapy_facts.hpp. */
export interface ReportPart { readonly event: string; readonly index: number; readonly value: number; readonly to_s: number; readonly persons: boolean; readonly steps: readonly (readonly [index: number, amount_l: number])[] }

/** The exercise's parts in a recording. */
export interface RecordedParts<Part extends ReportPart = ReportPart> {
  readonly parts: readonly Part[];
  /** For each finishing event: the number of the person's parts, and the sum of their stars. */
  readonly sums: Readonly<Record<string, { readonly count: number; readonly stars: number }>>;
  readonly scene: SceneT | undefined;
}

export interface ExerciseReport {
  /** The better direction of results, by their names. */
  readonly better: Readonly<Record<string, 'more' | 'less'>>;
  /** The name of what an event finishes; undefined where the event finishes nothing. */
  thing(event: string): string | undefined;
  /** The number of parts that the person finished. */
  parts(recorded: RecordedParts): { readonly key: string; readonly done: number; readonly words: string } | undefined;
  /** The person's stars in total and at most; undefined where no part was finished. */
  stars(recorded: RecordedParts): { readonly value: number; readonly most: number; readonly words: string } | undefined;
  /** A table of all parts: the person's first, with the share of each. */
  table<Part extends ReportPart>(recorded: RecordedParts<Part>, timeWords: (time_s: number) => string, whoseWords: (part: Part) => string): { readonly title: string; readonly none: string; readonly head: readonly string[]; readonly rows: readonly (readonly string[])[] } | undefined;
}

/** What a folder of an exercise says. Each function returns nothing for another exercise. */
export interface ExerciseTexts {
  infoOf(scene: SceneT): ExerciseInfo | undefined;
  /** The title of an exercise file in the page's language. */
  titleOf?(file: string): string | undefined;
  /** The text of an event in the page's language. */
  eventWords?(name: string): string | undefined;
  /** Signs of its own events, by the events' names. */
  readonly signs?: Readonly<Record<string, EventSign>>;
  readonly report: ExerciseReport;
}
