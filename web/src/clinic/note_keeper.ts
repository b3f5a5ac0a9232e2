import { newKey, Refused, type ClinicApi } from './api';
import type { Drafts } from './drafts';
import type { Note } from './records';

/** Where the number of a new note is found: the note itself, or in what it belongs to. */
type Added = Partial<Note> & { readonly notes?: readonly Note[] };

function numberOf(added: Added, text: string, at_us: number): number {
  const same = (note: Partial<Note>): boolean => note.text === text && note.at_us === at_us;
  return (same(added) ? added.id : added.notes?.find(same)?.id) ?? 0;
}

/** A note is saved so long after the last key [ms]. */
export const SAVED_AFTER_MS = 1000;

/** A note while it is written. */
interface Writing { readonly text: string; readonly at_us: number; readonly key: string; readonly note: number; readonly saved: string }

export type NoteState = 'empty' | 'typing' | 'saved' | 'waits';

/** Keeps a note with every key, and saves it a second after the last one: first as a new note, then as the same one, longer. */
export class NoteKeeper {
  state: NoteState = 'empty';
  onChange: () => void = () => {};
  private writing: Writing | undefined;
  private timer: ReturnType<typeof setTimeout> | undefined;
  private under_way: Promise<void> | undefined;

  /** @param path where notes of the patient or visit are added; `what`, `person`: under which it is kept */
  constructor(private readonly api: Pick<ClinicApi, 'send'>, private readonly drafts: Drafts, private readonly path: string, private readonly what: string, private readonly person: number, private readonly now_ms: () => number = Date.now) {
    const kept = drafts.get<Writing>(what, person);
    // What was saved to its end stands in the list.
    if (kept && kept.text === kept.saved) drafts.drop(what, person);
    else if (kept) {
      this.writing = kept;
      this.state = 'waits';
      this.later();
    }
  }

  get text(): string { return this.writing?.text ?? ''; }

  type(text: string): void {
    if (text === '' && !this.writing?.note) {
      this.drop();
      return;
    }
    const before = this.writing ?? { at_us: Math.round(this.now_ms() * 1000), key: newKey(), note: 0, saved: '' };
    this.keep({ ...before, text });
    this.become('typing');
    this.later();
  }

  /** Saves what is not saved. It is called again where the records were silent. */
  async save(): Promise<void> {
    clearTimeout(this.timer);
    await this.under_way;
    const writing = this.writing;
    if (!writing || writing.text === writing.saved || writing.text.trim() === '') return;
    this.under_way = this.send(writing).finally(() => { this.under_way = undefined; });
    await this.under_way;
  }

  /** The note is done: the next words are another one. */
  async done(): Promise<boolean> {
    await this.save();
    if (this.writing && this.writing.text !== this.writing.saved) return false;
    this.drop();
    return true;
  }

  close(): void { clearTimeout(this.timer); }

  private async send(writing: Writing): Promise<void> {
    const { text, at_us, key, note, saved } = writing;
    try {
      const id = note > 0 ? await this.longer(note, text, saved) : numberOf(await this.api.send<Added>('POST', this.path, { kind: 'text', text, at_us }, key), text, at_us);
      // Meanwhile more may have been typed.
      if (this.writing) this.keep({ ...this.writing, note: id, saved: text });
      this.become(this.writing?.text === text ? 'saved' : 'typing');
    } catch (problem) {
      // A refusal changed nothing, and is the answer to its key for ever.
      if (problem instanceof Refused && this.writing) this.keep({ ...this.writing, key: newKey() });
      this.become('waits');
    }
  }

  /** Changes the note; where the records cannot, what came after is a note of its own. */
  private async longer(note: number, text: string, saved: string): Promise<number> {
    try {
      await this.api.send('PUT', `/api/notes/${note}`, { text });
      return note;
    } catch (problem) {
      if (!(problem instanceof Refused) || !['not_found', 'bad_value', 'other'].includes(problem.code)) throw problem;
      const more = text.startsWith(saved) ? text.slice(saved.length).trim() : text;
      if (more !== '') await this.api.send('POST', this.path, { kind: 'text', text: more, at_us: Math.round(this.now_ms() * 1000) });
      return note;
    }
  }

  private later(): void {
    clearTimeout(this.timer);
    this.timer = setTimeout(() => void this.save(), SAVED_AFTER_MS);
  }

  private keep(writing: Writing): void {
    this.writing = writing;
    this.drafts.set(this.what, this.person, writing);
  }

  private drop(): void {
    clearTimeout(this.timer);
    this.writing = undefined;
    this.drafts.drop(this.what, this.person);
    this.become('empty');
  }

  private become(state: NoteState): void {
    this.state = state;
    this.onChange();
  }
}
