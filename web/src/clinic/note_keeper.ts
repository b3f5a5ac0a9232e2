import type { Drafts } from './drafts';
import type { Outbox } from './outbox';

/** A note is saved this long after the last key [ms]. */
export const SAVED_AFTER_MS = 1000;
/** A note that was begun longer ago is finished when its screen is built again [ms]. */
const GOES_ON_MS = 30 * 60_000;
/** Numbers of notes that the page assigns are below this; the records accept them. */
const NUMBERS = 2 ** 48;

/** The visit or patient that a note belongs to. */
export type NoteTarget = { readonly visit: number } | { readonly patient: number };
/** A note that is being written. */
interface NoteDraft { readonly id: number; readonly at_us: number; readonly text: string }

export type NoteState = 'empty' | 'typing' | 'saved' | 'waits';

/** Stores a note locally with every key, and sends it one second after the last key, always whole and under the same number. */
export class NoteKeeper {
  state: NoteState = 'empty';
  onChange: () => void = () => {};
  private writing: NoteDraft | undefined;
  private timer: ReturnType<typeof setTimeout> | undefined;

  /** @param what the name under which the draft is stored @param person the patient's number; 0: none */
  constructor(private readonly outbox: Outbox, private readonly drafts: Drafts, private readonly about: NoteTarget, private readonly what: string, private readonly person: number, private readonly now_ms: () => number = Date.now) {
    const kept = drafts.get<NoteDraft>(what, person);
    const waits = kept !== undefined && outbox.has(this.place(kept));
    // A saved note goes on in the field after names were hidden or the page was loaded again; later it is finished.
    if (kept && !waits && now_ms() - kept.at_us / 1000 > GOES_ON_MS) drafts.drop(what, person);
    else if (kept) {
      this.writing = kept;
      this.state = waits ? 'waits' : 'saved';
      if (waits) this.later();
    }
  }

  /** The number of the note that is being written; 0: none. */
  get id(): number { return this.writing?.id ?? 0; }
  get text(): string { return this.writing?.text ?? ''; }

  type(text: string): void {
    const { writing, outbox, about } = this;
    const { id, at_us } = writing ?? { id: 1 + Math.floor(Math.random() * (NUMBERS - 1)), at_us: Math.round(this.now_ms() * 1000) };
    const now = this.writing = { id, at_us, text };
    this.drafts.set(this.what, this.person, now);
    if (text.trim() === '') outbox.drop(this.place(now));
    else outbox.keep(this.place(now), { method: 'PUT', path: `/api/notes/${id}`, body: { ...about, kind: 'text', text, at_us } });
    this.become(text === '' ? 'empty' : 'typing');
    this.later();
  }

  /** Sends unsaved text. It is called again after the records did not answer. */
  async save(): Promise<void> {
    clearTimeout(this.timer);
    await this.outbox.flush();
    if (this.writing && this.text.trim() !== '') this.become(this.outbox.has(this.place(this.writing)) ? 'waits' : 'saved');
  }

  /** Finishes the note: further text begins another one. */
  async done(): Promise<boolean> {
    await this.save();
    if (this.state === 'waits') return false;
    this.writing = undefined;
    this.drafts.drop(this.what, this.person);
    this.become('empty');
    return true;
  }

  close(): void { clearTimeout(this.timer); }

  private place({ id }: NoteDraft): string { return `note-${id}`; }

  private later(): void {
    clearTimeout(this.timer);
    this.timer = setTimeout(() => void this.save(), SAVED_AFTER_MS);
  }

  private become(state: NoteState): void {
    this.state = state;
    this.onChange();
  }
}
