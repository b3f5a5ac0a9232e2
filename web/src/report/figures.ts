// Figures of a session that can be compared with those of the session before. No elements.
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
  /** The better direction; undefined if there is none. */
  readonly better?: 'more' | 'less';
  /** The measured subject: the exercise, or the grip of the hand. */
  readonly of: 'exercise' | 'grip';
}

/** Properties that must be equal in two sessions for a figure to be compared. */
const NEEDED: Readonly<Record<Figure['of'], readonly Difference[]>> = { exercise: ['exercise'], grip: ['hand', 'device'] };

/** The better direction of results, by their names. */
const BETTER: Readonly<Record<string, 'more' | 'less'>> = { score: 'more', bands_done: 'more', ...Object.assign({}, ...REPORTS.map(({ better }) => better)) };

/** Figures of the person's own actions; movements by others are excluded. */
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

export interface FigureComparison { readonly before: Figure; readonly became: 'better' | 'worse' | 'other' | 'same' }

/** A figure beside that of the session before; undefined if that one has none, or measured something else. Figures with equal text are equal. */
export function comparedWith(now: Figure, figures: readonly Figure[], differences: readonly Difference[]): FigureComparison | undefined {
  const before = figures.find(({ key }) => key === now.key);
  if (!before || NEEDED[now.of].some((needed) => differences.includes(needed))) return undefined;
  if (before.shown === now.shown) return { before, became: 'same' };
  // Different patients are not compared.
  if (!now.better || differences.includes('patient')) return { before, became: 'other' };
  return { before, became: now.value > before.value === (now.better === 'more') ? 'better' : 'worse' };
}

/** A comparison with the session before: the differences, and the figures with their comparable counterparts. */
export interface Comparison { readonly differences: readonly Difference[]; readonly figures: readonly (Figure & { readonly compared?: FigureComparison })[] }

export function compareWithBefore(data: ReportData): Comparison {
  const { before } = data;
  const differences = before ? differencesBetween(data.about, before.about) : [];
  const known = before ? figuresOf(before) : [];
  return { differences, figures: figuresOf(data).map((figure) => ({ ...figure, compared: comparedWith(figure, known, differences) })) };
}
