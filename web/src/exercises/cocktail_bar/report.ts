import { fixed } from '../../shared/format';
import type { ExerciseReport, ReportPart } from '../exercise_info';
import { barOf, type Bar } from './bar';
import { nameOf, text } from './i18n';

const DONE = 'drink_done', MOST_STARS = 3;

export interface FinishedStep { readonly liquid: string; readonly poured_l: number; readonly asked_l: number }
/** A finished drink. */
export interface FinishedDrink { readonly name: string; readonly steps: readonly FinishedStep[] }

/** A finished drink with the poured amount of each step. Without a bar its name is a number. */
export function drinkOf({ index, steps }: Pick<ReportPart, 'index' | 'steps'>, bar: Bar | undefined): FinishedDrink {
  const drink = bar?.drinks[index];
  return {
    name: drink?.name || String(index + 1),
    steps: steps.map(([step, poured_l]) => ({ liquid: drink?.steps[step]?.liquid ?? '', poured_l, asked_l: drink?.steps[step]?.amount_l ?? NaN })),
  };
}

const sum = (values: readonly number[]): number => values.reduce((all, value) => all + value, 0);

/** The bar's part of a report. */
export const barReport: ExerciseReport = {
  better: { spilt_l: 'less' },
  thing: (event) => (event === DONE ? text('report.title') : undefined),
  parts: ({ sums }) => (sums[DONE] ? { key: 'drinks', done: sums[DONE].count, words: text('report.drinks') } : undefined),
  stars: ({ sums }) => (sums[DONE]?.count ? { value: sums[DONE].stars, most: MOST_STARS * sums[DONE].count, words: text('report.stars') } : undefined),
  table: ({ parts, sums, scene }, timeWords, whoseWords) => {
    if (!sums[DONE]) return undefined;
    const drinks = parts.filter(({ event }) => event === DONE);
    const rows = [...drinks.filter(({ persons }) => persons), ...drinks.filter(({ persons }) => !persons)].map((part) => {
      const { name, steps } = drinkOf(part, barOf(scene));
      const poured_l = sum(steps.map((step) => step.poured_l)), asked_l = sum(steps.map((step) => step.asked_l));
      const off_l = sum(steps.map((step) => Math.abs(step.poured_l - step.asked_l)));
      return [nameOf('drink', name), `${fixed(1000 * poured_l, 0)} / ${fixed(1000 * asked_l, 0)}`, fixed(1000 * off_l, 1), fixed(part.value, 0), timeWords(part.to_s), whoseWords(part)];
    });
    return {
      title: text('report.title'), none: text('report.none'), rows,
      head: [text('report.drink'), text('report.poured'), text('report.off'), text('report.score'), text('report.doneAt'), text('report.whose')],
    };
  },
};
