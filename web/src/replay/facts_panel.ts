import { fact, h } from '../console/dom';
import { exerciseWords, personWords } from '../console/title_words';
import { duration, grouped } from '../shared/format';
import { texts as consoleTexts } from '../console/i18n';
import { fill, language } from '../shared/i18n';
import type { RecordingInfo } from './about';
import { labelOf } from '../exercises/panel';
import type { SceneT } from '../protocol';
import { texts } from './i18n';

/** The date of a recording in the language's format with 24 hours; text that is no date is returned unchanged. */
export function dateWords(created_utc: string, locale: string): string {
  const made = new Date(created_utc);
  return Number.isNaN(made.getTime()) ? created_utc : made.toLocaleString(locale === 'en' ? 'en-GB' : locale, { dateStyle: 'medium', timeStyle: 'short' });
}

/** Texts of a file may be of any language and direction. */
const isolated = (text: string): HTMLElement => h('bdi', { title: text }, text);

/** Facts of the recording and its results. */
export function factsPanel(about: RecordingInfo, missing: number, scene: SceneT | null): HTMLElement {
  const { facts: t } = texts();
  const c = consoleTexts();
  const exercise = about.exercise === '' ? t.noExercise : exerciseWords(about.exercise, about.level);
  const rows: [string, string][] = [
    [t.when, dateWords(about.created_utc, language())], [t.exercise, exercise], [t.hand, c.hands[about.hand] ?? about.hand],
    [t.patient, personWords(about.profile, about.patient, about.simulated_device)], [t.device, about.simulated_device ? [about.device, t.simulated].filter(Boolean).join(', ') : about.device],
    [t.length, `${duration(about.to_s - about.from_s)}, ${fill(t.ticks, { n: grouped(about.ticks) })}`],
    [t.missing, missing > 0 ? fill(t.ticks, { n: grouped(missing) }) : ''], [t.end, t.ends[about.ended_by] ?? ''], [t.program, about.program_version],
  ];
  const line = (name: string, value: string): HTMLElement => fact(isolated(name), isolated(value));
  const result = about.result.map(({ name, label, value, unit }) => line(labelOf(scene, name) || label, `${value} ${unit}`.trim()));
  return h('section', { class: 'panel replay-facts', 'aria-label': t.title },
    h('div', { class: 'hd' }, h('h2', {}, t.title)),
    h('dl', { class: 'facts' }, ...rows.filter(([, value]) => value !== '').map(([name, value]) => line(name, value))),
    result.length === 0 ? null : h('h2', {}, t.result), result.length === 0 ? null : h('dl', { class: 'facts' }, ...result));
}
