// What the answers of an exercise that compares show: the threshold with its interval, or what is missing, and the curve.
import { chart } from '../charts/chart';
import { h } from '../shared/dom';
import { fixed } from '../shared/format';
import { fill } from '../shared/i18n';
import { texts } from './i18n';
import type { Compared, ReportData } from './report_data';

/** Labelled ratios, second to first. */
const RATIOS = [1 / 3, 1 / 2, 1 / 1.25, 1.25, 2, 3];

const percent = (ratio: number): string => fixed(100 * (ratio - 1), 0);

/** The threshold, or what is missing for one. */
export function thresholdWords(of: Compared): string {
  const t = texts().compared;
  if (!of.enough) return fill(t.notEnough, { why: of.missing.map((key) => fill(t.why[key] ?? key, { n: of.missingAnswers, most: percent(of.mostRatio) })).join('; ') });
  const interval = of.openBelow ? fill(t.below, { n: percent(of.high) }) : of.openAbove ? fill(t.above, { n: percent(of.low) }) : fill(t.between, { a: percent(of.low), b: percent(of.high) });
  return `${fill(t.threshold, { n: percent(of.ratio), interval })}${of.atDeviceLimit ? ` ${t.atLimit}` : ''}`;
}

/** The section of the report; nothing for an exercise that does not compare. */
export function comparedSection({ therapy: { compared } }: Pick<ReportData, 'therapy'>): HTMLElement | null {
  if (!compared) return null;
  const t = texts().compared;
  const by = ['squeeze', 'player', 'therapist', 'earlier'].filter((who) => (compared.saidBy[who] ?? 0) > 0).map((who) => fill(t.by[who]!, { n: compared.saidBy[who]! })).join(', ');
  const said = [fill(t.answers, { n: compared.answers, by: by === '' ? '' : ` (${by})` }), compared.answers > 0 ? fill(t.other, { n: fixed(100 * compared.otherRight, 0) }) : '', compared.persons ? '' : t.notPersons].filter(Boolean).join(' ');
  const drawn = compared.answers > 0 && compared.mostX > 0;
  return h('section', { 'data-testid': 'compared' }, h('h2', {}, t.title), h('p', {}, h('b', {}, thresholdWords(compared))), h('p', { class: 'note' }, said), !drawn ? null : chart({
    title: t.chart, unit: '%', height_px: 90, range_x: [-1.05 * compared.mostX, 1.05 * compared.mostX], range_y: [-4, 104], numbers_y: [0, 50, 100],
    numbers_x: RATIOS.map(Math.log).filter((x) => Math.abs(x) <= 1.01 * compared.mostX), nameOfX: (x) => `×${fixed(Math.exp(x), 2).replace(/[.,]?0+$/, '')}`,
    lines: [
      { name: t.fitted, color: '#0B6B58', x: compared.curve.map(([x]) => x), values: compared.curve.map(([, share]) => 100 * share) },
      { name: t.points, color: '#8A5A00', dots: 5, x: compared.points.map(([x]) => x), values: compared.points.map(([, answers, second]) => 100 * second / Math.max(1, answers)) },
    ],
  }));
}
