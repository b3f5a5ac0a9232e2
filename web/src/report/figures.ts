// What a session came to, in numbers that can be compared with those of the session before. No elements.
import { fixed } from '../console/format';
import { fill } from '../shared/i18n';
import { inLanguage } from '../shared/exercise_panel';
import { texts } from './i18n';
import type { ReportData } from './report_data';
import { gripFigures, lastState, lastValue, meanOf, reachTimes } from './therapy';

export interface Figure {
  readonly key: string;
  readonly value: number;
  readonly shown: string;
  readonly unit: string;
  readonly words: string;
  /** What is better; where it is undefined, neither is. */
  readonly better?: 'more' | 'less';
}

/** Of the results that exercises name. */
const BETTER: Readonly<Record<string, 'more' | 'less'>> = { score: 'more', bands_done: 'more', spilt_l: 'less' };

export function figuresOf(data: Pick<ReportData, 'about' | 'series' | 'therapy' | 'states' | 'scene'>): Figure[] {
  const t = texts().tiles;
  const { about, series, therapy } = data;
  const last = lastState(data);
  const out: Figure[] = [];
  const all = lastValue(data, last, 'drinks');
  if (all !== undefined) {
    const done = series.events.filter(({ type }) => about.event_names[type] === 'drink_done').length;
    out.push({ key: 'drinks', value: done, shown: String(done), unit: fill(t.of, { n: all }), words: t.drinks, better: 'more' });
  }
  for (const { name, label, value: shown, unit } of about.result) {
    const words = inLanguage(data.scene?.panel?.values.find((told) => String(told.name) === name)?.label) || label;
    out.push({ key: `result/${name}`, value: Number(shown.replace('−', '-')), shown, unit, words, better: BETTER[name] });
  }
  const reaches = reachTimes(series.events, about.event_names, about.from_s);
  const add = (key: string, value: number, decimals: number, unit: string, words: string, better?: 'more' | 'less'): void => { out.push({ key, value, shown: fixed(value, decimals), unit, words, better }); };
  if (reaches.length > 0) add('reach', meanOf(reaches), 1, 's', t.reach, 'less');
  const grip = gripFigures(therapy.grips);
  if (grip) {
    add('grip', grip.mean_n, 1, 'N', t.grip);
    add('steadiness', 100 * grip.variation, 0, '%', t.steadiness, 'less');
  }
  const stars = lastValue(data, last, 'stars');
  if (stars !== undefined) out.push({ key: 'stars', value: stars, shown: '★'.repeat(Math.max(0, Math.min(5, Math.round(stars)))) || '–', unit: '', words: t.stars, better: 'more' });
  return out;
}

export interface Compared { readonly before: Figure; readonly became: 'better' | 'worse' | 'other' | 'same' }

/** A figure beside that of the session before; undefined where that one has none. What is shown alike is the same. */
export function comparedWith(now: Figure, figures: readonly Figure[]): Compared | undefined {
  const before = figures.find(({ key }) => key === now.key);
  if (!before) return undefined;
  if (before.shown === now.shown) return { before, became: 'same' };
  if (!now.better) return { before, became: 'other' };
  return { before, became: now.value > before.value === (now.better === 'more') ? 'better' : 'worse' };
}

/** In what the session before differs, so that the two can hardly be compared. */
export function differencesFrom({ about: now }: Pick<ReportData, 'about'>, { about: before }: Pick<ReportData, 'about'>): ('patient' | 'hand' | 'device' | 'exercise')[] {
  const keys = (['patient', 'hand', 'device', 'exercise'] as const).filter((key) => now[key] !== before[key]);
  return now.exercise === before.exercise && now.level !== before.level ? [...keys, 'exercise'] : keys;
}
