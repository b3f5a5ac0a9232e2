import { ownTitle } from '../exercises/info';
import { asWords } from '../shared/format';
import { fill } from '../shared/i18n';
import { texts } from './i18n';

/** The program's titles of recordings: "free-grasping, level 1 of 4". */
const OF_EXERCISE = /^([\w-]{1,80}), level (\d{1,4})(?: of (\d{1,4}))?$/;

/** The name of a recording's file: "20261129-141813-p-014-drawer-level-2". One that was broken off has no other title. */
const OF_FILE = /^\d{8}-\d{6}-([\w-]{1,200})-level-(\d{1,4})(?:-\d+)?(?:\.h5)?$/;

const knownTitle = (file: string): string | undefined => ownTitle(file) ?? texts().exercises[file];

/** The words for an exercise file, with its level where it has one. @param own the title of its panel, if known */
export function exerciseWords(file: string, level = 0, own = ''): string {
  return [knownTitle(file) ?? (own || asWords(file)), level > 0 ? fill(texts().level, { n: level }) : ''].filter(Boolean).join(', ');
}

/** A recording's title in the current language; a custom title is returned unchanged, and the file name if there is none. */
export function titleWords(title: string, file_name: string, own = ''): string {
  const [, exercise, level] = OF_EXERCISE.exec(title) ?? [];
  return exercise === undefined ? fileWords(title || file_name) : exerciseWords(exercise, Number(level), own);
}

/** The person's code and the exercise in a file's name; a name of another form is returned unchanged. */
function fileWords(name: string): string {
  const [, what = '', level] = OF_FILE.exec(name) ?? [];
  const parts = what.split('-'), at = parts.findIndex((_, i) => knownTitle(parts.slice(i).join('-')) !== undefined);
  if (at < 0) return name;
  return [parts.slice(0, at).join('-'), exerciseWords(parts.slice(at).join('-'), Number(level))].filter(Boolean).join(': ');
}

/** The person who plays: the code of the open profile, else the virtual patient of a simulated device. Empty: unknown. */
export function personWords(profile: string, patient: string, simulated: boolean): string {
  if (profile !== '') return profile;
  const t = texts();
  return simulated && patient !== '' ? fill(t.virtualPatient, { name: t.patients[patient] ?? asWords(patient) }) : '';
}

/** A recording in a list: the person's code, if there is one, before its title. */
export function sessionWords({ profile = '', title = '', name }: { readonly profile?: string; readonly title?: string; readonly name: string }, own = ''): string {
  const called = titleWords(title, name, own);
  return profile === '' ? called : `${profile}: ${called}`;
}
