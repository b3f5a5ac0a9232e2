import { h, setText } from '../console/dom';
import { texts } from './i18n';
import { NoteKeeper, type NoteTarget } from './note_keeper';
import type { ClinicContext } from './clinic_context';
import type { Note } from './records';
import { button } from './ui';
import { clockOf, dayOf } from './words';

/** Waiting entries are sent again this often [ms]. */
const AGAIN_MS = 5000;

/** A field for a note that is stored while it is typed. */
export class NoteBox {
  readonly element: HTMLElement;
  private readonly t = texts().notes;
  private readonly keeper: NoteKeeper;
  private readonly state = h('span', { class: 'aside', role: 'status', 'data-testid': 'note-state' });
  private readonly area: HTMLTextAreaElement;
  private readonly timer: ReturnType<typeof setInterval>;

  /** @param added called when a note is finished, so that the list is read again */
  constructor({ clinic }: ClinicContext, about: NoteTarget, what: string, person: number, added: () => void) {
    const { t } = this;
    this.keeper = new NoteKeeper(clinic.outbox, clinic.drafts, about, what, person);
    this.area = h('textarea', { class: 'in', rows: 2, 'aria-label': t.write, placeholder: t.write, maxlength: 8000, 'data-testid': 'note' });
    this.area.value = this.keeper.text;
    this.area.addEventListener('input', () => this.keeper.type(this.area.value));
    this.area.addEventListener('blur', () => void this.keeper.save());
    const done = button(t.done, 'note-done', async () => {
      if (!await this.keeper.done()) return;
      this.area.value = '';
      added();
    });
    this.keeper.onChange = () => this.show();
    this.timer = setInterval(() => { if (this.keeper.state === 'waits') void this.keeper.save(); }, AGAIN_MS);
    this.element = h('div', { class: 'note-box' }, this.area, done, this.state);
    this.show();
  }

  save(): Promise<void> { return this.keeper.save(); }
  /** The number of the note in the field, which is not in the list yet; 0: none. */
  get writing(): number { return this.keeper.id; }

  close(): void {
    clearInterval(this.timer);
    this.keeper.close();
  }

  private show(): void { setText(this.state, this.t.states[this.keeper.state]); }
}

/** Notes with day, time and author. */
export function noteList(notes: readonly Note[], nameOf: (account: string | number) => string): HTMLElement {
  const t = texts().notes;
  if (notes.length === 0) return h('p', { class: 'none' }, t.none);
  return h('ul', { class: 'note-list' }, ...[...notes].sort((a, b) => b.at_us - a.at_us).map(({ kind, text, at_us, account }) => h('li', {},
    h('span', {}, [t.kinds[kind] ?? (kind === 'text' ? '' : kind), text].filter(Boolean).join(': ')), h('small', {}, [dayOf(at_us), clockOf(at_us), nameOf(account)].filter(Boolean).join(', ')))));
}

/** The name of an account by its number; a name is returned unchanged. */
export const accountName = ({ clinic }: ClinicContext) => (account: string | number): string => (typeof account === 'string' ? account : clinic.state?.tiles.find(({ id }) => id === account)?.name ?? '');
