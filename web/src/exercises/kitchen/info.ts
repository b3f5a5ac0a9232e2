// Texts of a kitchen task for console, replay and report, in addition to its panel.
import { fixed } from '../../shared/format';
import type { SceneT } from '../../protocol';
import type { ExerciseInfo, ExerciseReport, ExerciseTexts } from '../exercise_info';
import { ExercisePanel } from '../panel';
import { text } from './i18n';
import { taskOf, type KitchenTask } from './task';

const DONE = 'level_done';

/** The present step, the force at the handle and the time. */
function kitchenInfo({ steps }: KitchenTask): ExerciseInfo {
  return {
    progress: (value) => text('count', { n: Math.min(value('instruction') ?? 0, steps.length), m: steps.length }),
    caption(value) {
      const step = steps[value('instruction') ?? -1];
      return [step ? text(`verb.${step.verb}`) : '', text('info.force', { a: fixed(value('handle_n') ?? 0, 1) }), text('info.time', { a: fixed(value('time_s') ?? 0, 1) })].filter(Boolean).join(' · ');
    },
    levelName: () => '',
    bodyName: () => undefined,
  };
}

const isKitchen = (scene: SceneT | undefined): boolean => taskOf(scene) !== undefined;

/** A report with a row for each finished task. */
const kitchenReport: ExerciseReport = {
  better: {},
  thing: () => undefined,
  parts: ({ sums, scene }) => (isKitchen(scene) && sums[DONE] ? { key: 'tasks', done: sums[DONE].count, words: text('report.title') } : undefined),
  stars: () => undefined,
  table({ parts, scene }, timeWords, whoseWords) {
    const task = taskOf(scene);
    if (!task) return undefined;
    const done = parts.filter(({ event }) => event === DONE), title = (scene && ExercisePanel.of(scene)?.title) ?? '';
    return {
      title: text('report.title'), none: text('report.none'), head: [text('report.task'), text('report.steps'), text('report.score'), text('report.doneAt'), text('report.whose')],
      rows: [...done.filter(({ persons }) => persons), ...done.filter(({ persons }) => !persons)]
        .map((part) => [title, `${part.steps.length} / ${task.steps.length}`, fixed(part.value, 0), timeWords(part.to_s), whoseWords(part)]),
    };
  },
};

export const info: ExerciseTexts = {
  infoOf(scene) {
    const task = taskOf(scene);
    return task && kitchenInfo(task);
  },
  report: kitchenReport,
};
