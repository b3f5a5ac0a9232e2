import type { ExerciseWords } from '../exercise';
import { text, textOf } from './i18n';
import { stepPicture } from './pictures';

/** The description of the bar before it is played. */
export const barWords: ExerciseWords = {
  title: () => text('welcome.title'),
  lead: () => text('welcome.lead'),
  steps: (skin) => ([1, 2, 3] as const).map((n) => ({
    picture: stepPicture((n - 1) as 0 | 1 | 2, skin), title: text(`welcome.step${n}`), more: text(`welcome.step${n}More`),
  })),
  levelName: (level) => textOf(`level.${level}`) ?? '',
  oneButton: () => ({ press: text('oneButton.press'), point: text('oneButton.point') }),
};
