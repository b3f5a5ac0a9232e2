// What console, replay and report say of an exercise beside its panel.
import type { SceneT } from '../protocol';
import { barOf } from './cocktail_bar/bar';
import { textOf } from './cocktail_bar/i18n';
import { BAR_SIGNS, barInfo, barTitle } from './cocktail_bar/info';
import { barReport } from './cocktail_bar/report';
import { kitchenInfo, kitchenReport } from './kitchen/info';
import { taskOf } from './kitchen/task';

/** A value of the exercise by its name; undefined where there is none. */
export type Value = (name: string) => number | undefined;

export interface ExerciseInfo {
  /** Which part of the exercise is played; empty where it has none. */
  progress(value: Value): string;
  /** Under the picture; empty where there is nothing to say. */
  caption(value: Value): string;
  /** Empty where levels have no names. */
  levelName(level: number): string;
  /** A body of the scene as people call it; undefined where the exercise has no name for it. */
  bodyName(body: string): string | undefined;
}

const NOTHING: ExerciseInfo = { progress: () => '', caption: () => '', levelName: () => '', bodyName: () => undefined };

export function infoOf(scene: SceneT | null | undefined): ExerciseInfo {
  const bar = barOf(scene), task = taskOf(scene);
  if (task) return kitchenInfo(task);
  return bar ? barInfo(bar, String(scene?.exerciseName ?? '')) : NOTHING;
}

/** The name of an exercise's file in the person's language; undefined where no folder has one. */
export const ownTitle = (file: string): string | undefined => barTitle(file);

/** An event of an exercise in the person's language; undefined where no folder has words for it. */
export const ownEventWords = (name: string): string | undefined => textOf(`event.${name}`);

/** Stands in the plots where an event begins a phase of a grasp. */
export interface EventSign { readonly sign: string; meaning(): string; legend(): string }

/** The signs of the exercises' own events, by the events' names. */
export const OWN_SIGNS: Readonly<Record<string, EventSign>> = BAR_SIGNS;

/** A finished part of an exercise as a report shows it: what src/replay/therapy_facts.hpp finds. */
export interface ReportPart { readonly event: string; readonly index: number; readonly value: number; readonly to_s: number; readonly persons: boolean; readonly steps: readonly (readonly [index: number, amount_l: number])[] }

/** What a recording holds of its exercise. */
export interface Recorded<Part extends ReportPart = ReportPart> {
  readonly parts: readonly Part[];
  /** Of all parts that an event finishes, by its name: how many are the person's, and their stars together. */
  readonly sums: Readonly<Record<string, { readonly count: number; readonly stars: number }>>;
  readonly scene: SceneT | undefined;
}

export interface ExerciseReport {
  /** Of results, by their names. */
  readonly better: Readonly<Record<string, 'more' | 'less'>>;
  /** What is finished by an event of its own; undefined where the event is not. */
  thing(event: string): string | undefined;
  /** How many parts of the exercise the person finished. */
  parts(recorded: Recorded): { readonly key: string; readonly done: number; readonly words: string } | undefined;
  /** How many stars they had together, and how many there could be; undefined where no part was finished. */
  stars(recorded: Recorded): { readonly value: number; readonly most: number; readonly words: string } | undefined;
  /** What was done, part by part: the person's first, and whose each is. */
  table<Part extends ReportPart>(recorded: Recorded<Part>, timeWords: (time_s: number) => string, whoseWords: (part: Part) => string): { readonly title: string; readonly none: string; readonly head: readonly string[]; readonly rows: readonly (readonly string[])[] } | undefined;
}

/** Each says nothing of a recording that is not its own. */
export const REPORTS: readonly ExerciseReport[] = [barReport, kitchenReport];
