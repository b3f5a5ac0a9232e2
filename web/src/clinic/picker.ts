import { h } from '../console/dom';
import { fill } from '../shared/i18n';
import { texts } from './i18n';
import type { ClinicContext } from './clinic_context';
import type { PatientList, PatientRow } from './records';
import { action, button, Field, StatusMessage, textInput, tried } from './ui';
import { sideWords } from './words';

/** The patient that shall be acted on. `ask`: the label of the confirming button, for example "Move to {name}, {code}"; `not`: a patient that is not offered. */
interface Question { readonly title: string; readonly ask: string; readonly not?: number }

/** Asks in a place of the screen for a patient by name or code, then for a confirmation with both; acts, clears the place and goes on. */
export function pickPatient(place: HTMLElement, { clinic }: ClinicContext, { title, ask, not }: Question, act: (patient: PatientRow) => Promise<unknown>, then: () => unknown): void {
  const t = texts().picker, message = new StatusMessage(), found = h('ul', { class: 'found' });
  const clear = (): void => place.replaceChildren();
  const confirm = (row: PatientRow): void => {
    const yes = action(fill(ask, { name: row.name, code: row.code }), 'pick-yes', message, async () => {
      await act(row);
      clear();
      await then();
    }, 'go wide');
    found.replaceChildren(h('li', {}, yes));
    yes.focus();
  };
  const look = (find: string): Promise<void> => tried(message, async () => {
    const { patients } = await clinic.api.get<PatientList>(`/api/patients?find=${encodeURIComponent(find)}`);
    const others = patients.filter(({ id }) => id !== not);
    message.show(others.length === 0 ? t.nobody : '');
    found.replaceChildren(...others.slice(0, 8).map((row) => h('li', {}, button(`${row.name} · ${row.code} · ${sideWords(row.side)}`, `pick-${row.id}`, () => confirm(row), 'wide'))));
  });
  const field = new Field(t.find, textInput('pick-find', '', { type: 'search' }));
  let timer: ReturnType<typeof setTimeout> | undefined;
  field.input.addEventListener('input', () => { clearTimeout(timer); timer = setTimeout(() => void look(field.input.value), 200); });
  place.replaceChildren(h('section', { class: 'panel picker', 'aria-label': title, 'data-testid': 'picker' }, h('div', { class: 'hd' }, h('h2', {}, title), h('span', { class: 'sp' }), button(t.cancel, 'pick-cancel', clear)), field.element, message.element, found));
  place.scrollIntoView({ block: 'nearest' });
  field.input.focus();
  void look('');
}
