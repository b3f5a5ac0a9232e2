// Parts that both sheets of a report share.
import { fact, h } from '../shared/dom';
import { asWords, duration } from '../shared/format';
import { texts as consoleTexts } from '../console/i18n';
import { exerciseWords, personWords, sessionWords } from '../console/title_words';
import { infoOf, OWN_SIGNS } from '../exercises/info';
import type { SceneT } from '../protocol';
import { clockTime } from '../replay/clock';
import { dateWords } from '../replay/facts_panel';
import { Moments, plotMark, type Names } from '../replay/moments';
import { texts as replayTexts } from '../replay/i18n';
import { ExercisePanel } from '../exercises/panel';
import { fill, language } from '../shared/i18n';
import { WindowSamples } from '../replay/window_samples';
import type { ChartBand, ChartMark } from '../charts/chart';
import { timeNumbers } from '../charts/chart_range';
import { texts } from './i18n';
import type { ReportData } from './report_data';

const MOST_TIMES_NAMED = 8;

/** A text of the file, which may be of any language and direction. */
export const isolated = (text: string): HTMLElement => h('bdi', { title: text }, text);

export interface SheetContext {
  readonly data: ReportData;
  /** The scene of the file; without one, names as far as the file states them. */
  readonly scene: SceneT;
  readonly samples: WindowSamples;
  readonly marks: readonly ChartMark[];
  /** Bands for touches, and above them for unknown data: missing or unreadable ticks. */
  readonly bands: readonly ChartBand[];
  /** Called to show a moment in the viewer. */
  readonly look: (time_s: number) => void;
}

export function sheetContext(data: ReportData, scene: SceneT, look: (time_s: number) => void): SheetContext {
  const { series, about } = data;
  const width_s = (series.to_s - series.from_s) / series.columns;
  const moments = new Moments();
  moments.add(series);
  const panel = ExercisePanel.of(data.scene ?? null);
  const names: Names = { eventNames: scene.eventNames, ownWords: (type) => panel?.event(type) ?? '' };
  return {
    data, scene, look, samples: new WindowSamples([{ piece: series, from: 0, to: series.columns, width_s }], moments.gaps, about.period_s),
    marks: moments.list.filter(({ kind }) => kind !== 'armed' && kind !== 'neutral' && kind !== 'gap').map((moment) => {
      const { time_s, label, bad } = plotMark(moment, names, replayTexts(), consoleTexts());
      return { at: time_s, label, bad };
    }).filter(({ label, bad }) => bad || label !== ''),
    bands: [
      ...data.therapy.touches.map(({ from_s, to_s }) => ({ from: from_s, to: to_s, color: '#F4EEE3' })),
      ...[...series.gaps, ...series.unreadable].map(({ from_s, to_s }) => ({ from: from_s, to: to_s, color: '#F7E3E0' })),
    ],
  };
}

/** The display name of a body. */
export function bodyWords(name: string, scene: SceneT | undefined): string {
  return infoOf(scene).bodyName(name) ?? asWords(name);
}

export const shortTime = (time_s: number): string => clockTime(time_s, 1);

/** A label of a time axis, with the decimals that its steps need. */
export const timeName = (x: number): string => clockTime(x, Number.isInteger(x) ? 0 : Number.isInteger(Number((10 * x).toFixed(6))) ? 1 : 2);

/** Labelled times of every chart of a sheet. */
export const timesOfSheet = ({ series }: Pick<ReportData, 'series'>): number[] => timeNumbers(series.from_s, series.to_s, MOST_TIMES_NAMED);

/** The meanings of the signs among these marks; empty if there are none. */
export function signWords(marks: readonly Pick<ChartMark, 'label'>[]): string {
  const { m1, m2 } = consoleTexts().legend;
  const legends = [m1, m2, ...Object.values(OWN_SIGNS).map((sign) => sign.legend())].filter((words) => marks.some(({ label }) => label !== '' && words.startsWith(label)));
  return legends.length === 0 ? '' : `${legends.join('; ')}.`;
}

export function header(data: ReportData, page: string): HTMLElement {
  const t = texts();
  const c = consoleTexts();
  const { about } = data, own = ExercisePanel.of(data.scene ?? null)?.title;
  const item = (name: string, value: string): HTMLElement => fact(name, isolated(value === '' ? t.facts.unknown : value));
  return h('header', {},
    h('div', { class: 'called' }, h('p', {}, `Wholehand · ${page}`), h('h1', {}, isolated(sessionWords(about, own)))),
    h('dl', {},
      item(t.facts.patient, personWords(about.profile, about.patient, about.simulated_device)), item(t.facts.hand, c.hands[about.hand] ?? about.hand),
      item(t.facts.device, [about.device, about.simulated_device ? t.facts.simulated : ''].filter(Boolean).join(', ')), item(t.facts.exercise, about.exercise === '' ? t.facts.noExercise : exerciseWords(about.exercise, about.level, own)),
      item(t.facts.date, dateWords(about.created_utc, language())), item(t.facts.length, duration(about.to_s - about.from_s))));
}

export function footer(data: ReportData, page: number): HTMLElement {
  const t = texts();
  return h('footer', {}, h('span', {}, fill(t.program, { version: data.about.program_version })), h('span', {}, isolated(data.about.name)),
    h('span', {}, t.notDiagnosis), h('span', {}, fill(t.pageOf, { n: page, m: 2 })));
}
