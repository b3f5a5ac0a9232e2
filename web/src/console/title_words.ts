import { fill } from '../shared/i18n';
import { texts } from './i18n';

/** The program calls a recording after its exercise: "cocktail-bar, level 1 of 4". */
const OF_EXERCISE = /^([\w-]{1,80}), level (\d{1,4})(?: of (\d{1,4}))?$/;

/** The title of a recording in the language of now; one of its own as it is, and its file's name where it has none. */
export function titleWords(title: string, file_name: string): string {
  const t = texts();
  const [, exercise, level] = OF_EXERCISE.exec(title) ?? [];
  const known = exercise === undefined ? undefined : t.exercises[exercise];
  return known ? `${known}, ${fill(t.level, { n: level })}` : title || file_name;
}
