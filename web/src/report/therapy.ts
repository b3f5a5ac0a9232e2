// Statements on the therapy in a recording, from the data of the page. No elements.
import type { RecordedParts } from '../exercises/exercise_info';
import type { ReplayMark, SeriesPiece } from '../replay/series_piece';
import { fixed } from '../shared/format';
import { fill } from '../shared/i18n';
import { texts } from './i18n';
import { GivenHelp, type Part, type ReportData, type Attribution } from './report_data';

/** The exercise's parts in the data of the page. */
export function recordedOf({ therapy: { parts, sums }, scene }: Pick<ReportData, 'therapy' | 'scene'>): RecordedParts<Part> {
  return { parts, sums, scene };
}

/** The attribution of a part in words: "with full help", "shared, 63 % the person's", "shown by the virtual patient". */
export function whoseWords({ by, share, help, persons }: Attribution): string {
  const t = texts().whose;
  if (persons) return help === GivenHelp.Unspecified ? t.person : t.helps[help];
  return share > 0 ? fill(t.shared, { n: sharePercent(share) }) : t.shown[by];
}

/** A share in percent; a share below 1 is never shown as 100 %. */
export function sharePercent(share: number): string {
  const percent = 100 * share;
  return fixed(share < 1 ? Math.min(percent, 99.9) : percent, 1);
}

/** The marks of one kind. */
export interface MarksOfKind { readonly kind: 'stop' | 'emergency_stop' | 'fault' | 'controls_lost'; readonly marks: readonly ReplayMark[] }

/** The marks of every kind that a therapist must see, including empty kinds. */
export function marksByKind({ marks }: Pick<SeriesPiece, 'marks'>): MarksOfKind[] {
  return (['stop', 'emergency_stop', 'fault', 'controls_lost'] as const).map((kind) => ({ kind, marks: marks.filter((mark) => mark.kind === kind) }));
}
