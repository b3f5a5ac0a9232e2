// Texts of an exercise for console, replay and report, in addition to its panel; the folders that have an info.ts.
import type { SceneT } from '../protocol';
import type { EventSign, ExerciseInfo, ExerciseReport, ExerciseTexts } from './exercise_info';

const TEXTS = Object.values(import.meta.glob<ExerciseTexts>('./*/info.ts', { eager: true, import: 'info' }));
const NOTHING: ExerciseInfo = { progress: () => '', caption: () => '', levelName: () => '', bodyName: () => undefined };

/** The first text that an exercise gives. */
function firstOf<Text>(of: (texts: ExerciseTexts) => Text | undefined): Text | undefined {
  for (const texts of TEXTS) {
    const found = of(texts);
    if (found !== undefined) return found;
  }
  return undefined;
}

export const infoOf = (scene: SceneT | null | undefined): ExerciseInfo => (scene ? firstOf((texts) => texts.infoOf(scene)) : undefined) ?? NOTHING;

/** The title of an exercise file in the page's language; undefined where no folder has one. */
export const ownTitle = (file: string): string | undefined => firstOf((texts) => texts.titleOf?.(file));

/** The text of an exercise's event in the page's language; undefined where no folder has one. */
export const ownEventWords = (name: string): string | undefined => firstOf((texts) => texts.eventWords?.(name));

/** The signs of the exercises' own events, by the events' names. */
export const OWN_SIGNS: Readonly<Record<string, EventSign>> = Object.assign({}, ...TEXTS.map(({ signs }) => signs));

/** Each report returns nothing for a recording of another exercise. */
export const REPORTS: readonly ExerciseReport[] = TEXTS.map(({ report }) => report);
