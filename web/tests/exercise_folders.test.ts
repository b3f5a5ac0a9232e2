// Names of an exercise occur only in its folder: game, input, scene, console, replay and report use only the interface.
import { execFileSync } from 'node:child_process';
import { readFileSync } from 'node:fs';
import { resolve } from 'node:path';
import { expect, it } from 'vitest';

const WEB = resolve(__dirname, '..');

/** Words of src/exercises/cocktail_bar in code, comments and texts of the three languages. */
const WORDS = /recipe|rezept|recette|bottle|flasche|bouteille|cocktail|\bglass(es)?\b|\bverre\b|drink|getränk|boisson|dispenser|liquid|lemon|cherry|juice|\bguest|\bpour(s|ed|ing|_)?\b|spil[lt]/i;
const NAMES = /\bbar_|_bar\b|\bbar\??: (Paced|Scene)/;
/** The place "bar" in sentences; "the address bar" is different. */
const PLACE = /\b(the|die|der|zur|le|du|au|un) bar\b/i;

/** Files that may contain them, with the reason. */
const MAY: readonly (readonly [file: RegExp, only: RegExp, why: string])[] = [
  [/^src\/exercises\/index\.ts$/, /from '\.\/cocktail_bar\//, 'the game loads it first: imports alone'],
  [/^src\/clinic\/i18n\//, /\bpoured_total_l: /, 'results of all exercises, of visits whose exercise is not loaded'],
  [/^src\/clinic\/i18n\//, /'deleted a guest visit': /, 'entries of the log, as the records write them'],
  [/^src\/clinic\/(api|records|gentle_visit|patients_screen)\.ts$/, /\bguest(s|_visits)?\b/, 'a visit without a patient, as the records call it'],
  [/^src\/exercises\/kitchen\/appliances\.ts$/, /lemon|juice|glass/i, 'a citrus press has them, too'],
  [/^src\/exercises\/tell_apart\//, /bottle|flasche|bouteille/i, 'it compares two'],
  [/^src\/charts\/i18n\//, /exercise\.|chart\.|figure\./, 'words of the charts that the program draws of the bar'],
];

/** "pour" is a word in French texts. */
const isFrench = (file: string): boolean => file.endsWith('/fr.ts');

it('no file outside the bar\'s folder contains names of the bar', () => {
  const files = execFileSync('git', ['ls-files', 'src', '*.html'], { cwd: WEB, encoding: 'utf8' }).split('\n')
    .filter((file) => /\.(ts|css|html)$/.test(file) && !file.startsWith('tests/') && !file.startsWith('src/exercises/cocktail_bar/'));
  expect(files.length).toBeGreaterThan(100);
  const named = files.flatMap((file) => readFileSync(resolve(WEB, file), 'utf8').split('\n').flatMap((line, i) => {
    const judged = isFrench(file) ? line.replace(/\bpour\b/gi, '') : line;
    const may = MAY.some(([of, only]) => of.test(file) && only.test(line));
    return (WORDS.test(judged) || NAMES.test(judged) || PLACE.test(judged)) && !may ? [`${file}:${i + 1}: ${line.trim().slice(0, 120)}`] : [];
  }));
  expect(named).toEqual([]);
});
