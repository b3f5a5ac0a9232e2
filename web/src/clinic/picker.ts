import { h } from '../console/dom';
import { fill } from '../shared/i18n';
import { texts } from './i18n';
import type { ClinicContext } from './clinic_context';
import type { PatientList, PatientRow } from './records';
import { action, button, Field, StatusMessage, textInput } from './ui';
import { sideWords } from './words';

/** Chooses a patient by name or code, then asks for confirmation with both names. */
export class PatientPicker {
  readonly element: HTMLElement;
  private readonly found = h('ul', { class: 'found' });
  private readonly message = new StatusMessage();
  private timer: ReturnType<typeof setTimeout> | undefined;

  /** @param ask the label of the confirming button, for example "Move to {name}, {code}" */
  constructor(private readonly context: ClinicContext, title: string, private readonly ask: string, private readonly not: number, private readonly chosen: (patient: PatientRow) => Promise<void>, private readonly cancel: () => void) {
    const t = texts().picker;
    const field = new Field(t.find, textInput('pick-find', '', { type: 'search' }));
    field.input.addEventListener('input', () => { clearTimeout(this.timer); this.timer = setTimeout(() => void this.look(field.input.value), 200); });
    this.element = h('section', { class: 'panel picker', 'aria-label': title, 'data-testid': 'picker' }, h('div', { class: 'hd' }, h('h2', {}, title), h('span', { class: 'sp' }), button(t.cancel, 'pick-cancel', () => this.cancel())), field.element, this.message.element, this.found);
    void this.look('');
    queueMicrotask(() => field.input.focus());
  }

  private async look(find: string): Promise<void> {
    try {
      const { patients } = await this.context.clinic.api.get<PatientList>(`/api/patients?find=${encodeURIComponent(find)}`);
      const others = patients.filter(({ id }) => id !== this.not);
      this.message.show(others.length === 0 ? texts().picker.nobody : '');
      this.found.replaceChildren(...others.slice(0, 8).map((row) => h('li', {}, button(`${row.name} · ${row.code} · ${sideWords(row.side)}`, `pick-${row.id}`, () => this.confirm(row), 'wide'))));
    } catch (problem) {
      this.message.showProblem(problem);
    }
  }

  private confirm(row: PatientRow): void {
    const yes = action(fill(this.ask, { name: row.name, code: row.code }), 'pick-yes', this.message, () => this.chosen(row), 'go wide');
    this.found.replaceChildren(h('li', {}, yes));
    yes.focus();
  }
}
