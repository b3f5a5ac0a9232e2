// The reason of a refused order, in the person's language.
import { Refusal } from '../protocol';
import { hasText, text } from '../shared/i18n';

/** The text of a refusal; the program's English reason if this page does not know it, for example from a newer program. */
export function refusalText(refusal: Refusal, reason: string): string {
  const key = `refusal.${Refusal[refusal]}`;
  return hasText(key) ? text(key, { reason }) : reason;
}
