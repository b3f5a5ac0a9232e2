import { fixed } from '../../shared/format';
import type { ExerciseReport, ReportEvent } from '../info';
import { barOf, type Bar } from './bar';
import { nameOf, text } from './i18n';

export interface FinishedStep { readonly liquid: string; readonly poured_l: number; readonly asked_l: number }
/** A drink that was finished. */
export interface FinishedDrink { readonly name: string; readonly done_s: number; readonly score: number; readonly steps: readonly FinishedStep[] }

/** The drinks that were finished, with what was poured for each of their steps. Without a bar they have numbers. */
export function drinksOf(events: readonly ReportEvent[], names: readonly string[], bar: Bar | undefined): FinishedDrink[] {
  const drinks: FinishedDrink[] = [];
  let poured: { step: number; litres: number }[] = [];
  for (const { time_s, type, index, value } of events) {
    if (names[type] === 'restarted') poured = [];
    if (names[type] === 'step_done') poured.push({ step: index, litres: value });
    if (names[type] !== 'drink_done') continue;
    const drink = bar?.drinks[index];
    drinks.push({
      name: drink?.name || String(index + 1), done_s: time_s, score: value,
      steps: poured.map(({ step, litres }) => ({ liquid: drink?.steps[step]?.liquid ?? '', poured_l: litres, asked_l: drink?.steps[step]?.amount_l ?? NaN })),
    });
    poured = [];
  }
  return drinks;
}

const sum = (values: readonly number[]): number => values.reduce((all, value) => all + value, 0);

/** The bar in a report. */
export const barReport: ExerciseReport = {
  freeAfter: ['drink_done'],
  better: { spilt_l: 'less' },
  parts: ({ events, eventNames, value }) => {
    const all = value('drinks');
    if (all === undefined) return undefined;
    return { key: 'drinks', done: events.filter(({ type }) => eventNames[type] === 'drink_done').length, all, words: text('report.drinks') };
  },
  stars: ({ value }) => {
    const stars = value('stars');
    return stars === undefined ? undefined : { value: stars, words: text('report.stars') };
  },
  table: ({ events, eventNames, scene }, timeWords) => {
    if (!eventNames.includes('drink_done')) return undefined;
    const rows = drinksOf(events, eventNames, barOf(scene)).map(({ name, steps, score, done_s }) => {
      const poured_l = sum(steps.map((step) => step.poured_l)), asked_l = sum(steps.map((step) => step.asked_l));
      const off_l = sum(steps.map((step) => Math.abs(step.poured_l - step.asked_l)));
      return [nameOf('drink', name), `${fixed(1000 * poured_l, 0)} / ${fixed(1000 * asked_l, 0)}`, fixed(1000 * off_l, 1), fixed(score, 0), timeWords(done_s)];
    });
    return {
      title: text('report.title'), none: text('report.none'), rows,
      head: [text('report.drink'), text('report.poured'), text('report.off'), text('report.score'), text('report.doneAt')],
    };
  },
};
