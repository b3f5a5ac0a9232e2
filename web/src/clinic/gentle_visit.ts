import { h } from '../console/dom';
import { fill } from '../shared/i18n';
import { texts } from './i18n';
import type { ClinicContext } from './clinic_context';
import type { OneSide, Visit } from './records';
import { action, StatusMessage } from './ui';
import { sideWords } from './words';

/** Begins a visit without a patient, under the gentle preset. The therapist chooses the side and looks whether the hand fits. */
export function gentleVisit(context: ClinicContext): HTMLElement {
  const t = texts().patients, message = new StatusMessage();
  const begin = (side: OneSide): HTMLButtonElement => action(fill(t.beginWith, { side: sideWords(side) }), `without-${side}`, message, async () => {
    const visit = await context.clinic.api.send<Visit>('POST', '/api/guest_visits', { side });
    context.clinic.take(visit, null);
    context.go({ at: 'visit', visit: visit.id });
  }, 'go');
  return h('div', {}, message.element, h('div', { class: 'pair' }, begin('left'), begin('right')));
}

/** The offer in place of data that a damaged database does not give. */
export function gentleOffer(context: ClinicContext): HTMLElement {
  return h('div', { 'data-testid': 'gentle-offer' }, h('p', {}, texts().patients.gentleOffer), gentleVisit(context));
}
