// Says why an order was refused, in the person's language.
import { Refusal } from '../protocol';
import { hasText, text } from '../shared/i18n';

/** The sentence of a refusal; the program's English reason where this page knows none, as from a newer program. */
export function refusalText(refusal: Refusal, reason: string): string {
  const key = `refusal.${Refusal[refusal]}`;
  return hasText(key) ? text(key, { reason }) : reason;
}
