import { ownTitle } from '../exercises/info';
import { asWords } from '../shared/format';
import { fill } from '../shared/i18n';
import { texts } from './i18n';

/** The program calls a recording after its exercise: "free-grasping, level 1 of 4". */
const OF_EXERCISE = /^([\w-]{1,80}), level (\d{1,4})(?: of (\d{1,4}))?$/;

const knownTitle = (file: string): string | undefined => ownTitle(file) ?? texts().exercises[file];

/** An exercise by the name of its file, with its level where it has one. @param own its panel's title, where that is at hand */
export function exerciseWords(file: string, level = 0, own = ''): string {
  return [knownTitle(file) ?? (own || asWords(file)), level > 0 ? fill(texts().level, { n: level }) : ''].filter(Boolean).join(', ');
}

/** The title of a recording in the language of now; one of its own as it is, and its file's name where it has none. */
export function titleWords(title: string, file_name: string, own = ''): string {
  const [, exercise, level] = OF_EXERCISE.exec(title) ?? [];
  return exercise === undefined ? title || file_name : exerciseWords(exercise, Number(level), own);
}

/** Who plays, by the code of the open profile; without one, of a simulated device the virtual patient. Empty: nothing is known. */
export function personWords(profile: string, patient: string, simulated: boolean): string {
  if (profile !== '') return profile;
  const t = texts();
  return simulated && patient !== '' ? fill(t.virtualPatient, { name: t.patients[patient] ?? asWords(patient) }) : '';
}

/** A recording as it is listed: the person's code, where it has one, before its title. */
export function sessionWords({ profile = '', title = '', name }: { readonly profile?: string; readonly title?: string; readonly name: string }, own = ''): string {
  const called = titleWords(title, name, own);
  return profile === '' ? called : `${profile}: ${called}`;
}
