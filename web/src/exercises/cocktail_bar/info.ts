import { fixed } from '../../shared/format';
import type { EventSign, ExerciseInfo, ExerciseTexts } from '../exercise_info';
import { BAR_FILE, barOf, type Bar } from './bar';
import { nameOf, text, textOf } from './i18n';
import { barReport } from './report';

/** Signs in the plots for the events that begin and end the pouring. */
const BAR_SIGNS: Readonly<Record<string, EventSign>> = {
  pour_began: { sign: '③', meaning: () => text('phase.pour'), legend: () => text('legend.pour') },
  pour_ended: { sign: '④', meaning: () => text('phase.release'), legend: () => text('legend.release') },
};

/** The file with bottles that may be carried. */
const FREE_FILE = `${BAR_FILE}-free`;

/** The title of the bar's files in the page's language; undefined for another file. */
const barTitle = (file: string): string | undefined => (file === BAR_FILE ? text('name') : file === FREE_FILE ? text('nameFree') : undefined);

/** Texts of the bar for the console, the replay and reports. */
function barInfo(bar: Bar, file: string): ExerciseInfo {
  const ml = (litres: number | undefined): string => fixed(1000 * (litres ?? 0), 0);
  return {
    progress: (value) => {
      const m = value('drinks') ?? 0;
      return m > 0 ? text('console.drinkOf', { n: Math.min((value('drink') ?? 0) + 1, m), m }) : '';
    },
    caption: (value) => {
      const liquid = bar.dispensers[value('target_dispenser') ?? -1]?.liquid, asked_l = value('asked_l');
      return liquid === undefined || asked_l === undefined ? '' : text('console.poured', { liquid: nameOf('liquid', liquid), a: ml(value('poured_l')), b: ml(asked_l) });
    },
    // Other files of this kind have their own names of levels.
    levelName: (level) => (file === BAR_FILE ? textOf(`level.${level}`) : undefined) ?? bar.levels.find((reported) => reported.level === level)?.name ?? '',
    bodyName: (body) => {
      const liquid = bar.dispensers.find((dispenser) => dispenser.body === body)?.liquid;
      return liquid === undefined ? undefined : nameOf('liquid', liquid);
    },
  };
}

export const info: ExerciseTexts = {
  infoOf(scene) {
    const bar = barOf(scene);
    return bar && barInfo(bar, String(scene.exerciseName ?? ''));
  },
  titleOf: barTitle,
  eventWords: (name) => textOf(`event.${name}`),
  signs: BAR_SIGNS,
  report: barReport,
};
