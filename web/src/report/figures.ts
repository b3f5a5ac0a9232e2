// What a session came to, in numbers that can be compared with those of the session before. No elements.
import { fixed, grouped } from '../shared/format';
import { REPORTS } from '../exercises/info';
import { differencesBetween, type Difference } from '../replay/differences';
import { fill } from '../shared/i18n';
import { labelOf } from '../exercises/panel';
import { texts } from './i18n';
import type { ReportData } from './report_data';
import { recordedOf } from './therapy';

export interface Figure {
  readonly key: string;
  readonly value: number;
  readonly shown: string;
  readonly unit: string;
  readonly words: string;
  /** What is better; where it is undefined, neither is. */
  readonly better?: 'more' | 'less';
  /** What it measures: how the exercise went, or the grip of the hand. */
  readonly of: 'exercise' | 'grip';
}

/** What has to be the same in two sessions for a figure to be compared. */
const NEEDED: Readonly<Record<Figure['of'], readonly Difference[]>> = { exercise: ['exercise'], grip: ['hand', 'device'] };

/** Of the results that exercises name. */
const BETTER: Readonly<Record<string, 'more' | 'less'>> = { score: 'more', bands_done: 'more', ...Object.assign({}, ...REPORTS.map(({ better }) => better)) };

/** What the person did; what anybody else moved is in none of them. */
export function figuresOf(data: Pick<ReportData, 'therapy' | 'scene'>): Figure[] {
  const t = texts().tiles;
  const { therapy: { sums, results, reaches, grips } } = data;
  const recorded = recordedOf(data);
  const out: Figure[] = [];
  const count = (key: string, value: number, words: string): void => { out.push({ key, value, shown: grouped(value), unit: '', words, better: 'more', of: 'exercise' }); };
  for (const { parts } of REPORTS) {
    const figure = parts(recorded);
    if (figure) count(figure.key, figure.done, figure.words);
  }
  if (sums.level_done) count('levels', sums.level_done.count, t.levels);
  for (const { name, label, value: shown, unit } of results) {
    const words = labelOf(data.scene, name) || label;
    out.push({ key: `result/${name || label}`, value: Number(shown.replace('−', '-')), shown, unit: shown === '–' ? '' : unit, words, better: BETTER[name], of: 'exercise' });
  }
  if (reaches.count > 0) {
    const mean_s = reaches.sum_s / reaches.count;
    out.push({ key: 'reach', value: mean_s, shown: fixed(mean_s, 1), unit: 's', words: t.reach, better: 'less', of: 'exercise' });
  }
  if (grips.count > 0) {
    out.push({ key: 'grip', value: grips.mean_n, shown: fixed(grips.mean_n, 1), unit: 'N', words: t.grip, of: 'grip' },
      { key: 'steadiness', value: 100 * grips.variation, shown: fixed(100 * grips.variation, 0), unit: '%', words: t.steadiness, better: 'less', of: 'grip' });
  }
  for (const { stars } of REPORTS) {
    const figure = stars(recorded);
    if (figure) out.push({ key: 'stars', value: figure.value / figure.most, shown: `★ ${grouped(figure.value)}`, unit: fill(t.of, { n: grouped(figure.most) }), words: figure.words, better: 'more', of: 'exercise' });
  }
  return out;
}

export interface Compared { readonly before: Figure; readonly became: 'better' | 'worse' | 'other' | 'same' }

/** A figure beside that of the session before; undefined where that one has none, or what it measures was another. What is shown alike is the same. */
export function comparedWith(now: Figure, figures: readonly Figure[], differences: readonly Difference[]): Compared | undefined {
  const before = figures.find(({ key }) => key === now.key);
  if (!before || NEEDED[now.of].some((needed) => differences.includes(needed))) return undefined;
  if (before.shown === now.shown) return { before, became: 'same' };
  // Nobody is better than somebody else.
  if (!now.better || differences.includes('patient')) return { before, became: 'other' };
  return { before, became: now.value > before.value === (now.better === 'more') ? 'better' : 'worse' };
}

/** A session and the one before: what differs, and which figures have nothing beside them. */
export interface Comparison { readonly differences: readonly Difference[]; readonly figures: readonly (Figure & { readonly compared?: Compared })[] }

export function compareWithBefore(data: ReportData): Comparison {
  const { before } = data;
  const differences = before ? differencesBetween(data.about, before.about) : [];
  const known = before ? figuresOf(before) : [];
  return { differences, figures: figuresOf(data).map((figure) => ({ ...figure, compared: comparedWith(figure, known, differences) })) };
}
