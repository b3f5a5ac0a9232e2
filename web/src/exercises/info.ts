// Texts of an exercise for console, replay and report, in addition to its panel.
import type { SceneT } from '../protocol';
import { barOf } from './cocktail_bar/bar';
import { textOf } from './cocktail_bar/i18n';
import { BAR_SIGNS, barInfo, barTitle } from './cocktail_bar/info';
import { barReport } from './cocktail_bar/report';
import type { ExerciseInfo, EventSign, ExerciseReport } from './exercise_info';
import { kitchenInfo, kitchenReport } from './kitchen/info';
import { taskOf } from './kitchen/task';

const NOTHING: ExerciseInfo = { progress: () => '', caption: () => '', levelName: () => '', bodyName: () => undefined };

export function infoOf(scene: SceneT | null | undefined): ExerciseInfo {
  const bar = barOf(scene), task = taskOf(scene);
  if (task) return kitchenInfo(task);
  return bar ? barInfo(bar, String(scene?.exerciseName ?? '')) : NOTHING;
}

/** The title of an exercise file in the page's language; undefined where no folder has one. */
export const ownTitle = (file: string): string | undefined => barTitle(file);

/** The text of an exercise's event in the page's language; undefined where no folder has one. */
export const ownEventWords = (name: string): string | undefined => textOf(`event.${name}`);

/** The signs of the exercises' own events, by the events' names. */
export const OWN_SIGNS: Readonly<Record<string, EventSign>> = BAR_SIGNS;

/** Each report returns nothing for a recording of another exercise. */
export const REPORTS: readonly ExerciseReport[] = [barReport, kitchenReport];
