// What a recording says of the therapy, from what the page carries. No elements.
import type { Recorded } from '../exercises/info';
import type { ReplayMark, SeriesPiece } from '../replay/series_piece';
import { fixed } from '../shared/format';
import { fill } from '../shared/i18n';
import { texts } from './i18n';
import { GivenHelp, type Part, type ReportData, type Whose } from './report_data';

/** What the page carries of the exercise. */
export function recordedOf({ therapy: { parts, sums }, scene }: Pick<ReportData, 'therapy' | 'scene'>): Recorded<Part> {
  return { parts, sums, scene };
}

/** Whose something is, and with how much help: "with full help", "shared, 63 % the person's", "shown by the virtual patient". */
export function whoseWords({ by, share, help, persons }: Whose): string {
  const t = texts().whose;
  if (persons) return help === GivenHelp.Unsaid ? t.person : t.helps[help];
  return share > 0 ? fill(t.shared, { n: sharePercent(share) }) : t.shown[by];
}

/** Never a whole that is none. */
export function sharePercent(share: number): string {
  const percent = 100 * share;
  return fixed(share < 1 ? Math.min(percent, 99.9) : percent, 1);
}

/** Marks of a kind, and how often. */
export interface Happened { readonly kind: 'stop' | 'emergency_stop' | 'fault' | 'controls_lost'; readonly marks: readonly ReplayMark[] }

/** Every kind of thing that a therapist must see, also where it did not happen. */
export function whatHappened({ marks }: Pick<SeriesPiece, 'marks'>): Happened[] {
  return (['stop', 'emergency_stop', 'fault', 'controls_lost'] as const).map((kind) => ({ kind, marks: marks.filter((mark) => mark.kind === kind) }));
}
