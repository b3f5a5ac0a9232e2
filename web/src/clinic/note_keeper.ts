import type { Drafts } from './drafts';
import type { Outbox } from './outbox';

/** A note is saved so long after the last key [ms]. */
export const SAVED_AFTER_MS = 1000;
/** Below this, the records take a note's number from the page. */
const NUMBERS = 2 ** 48;

/** To what a note belongs. */
export type About = { readonly visit: number } | { readonly patient: number };
/** A note while it is written. */
interface Writing { readonly id: number; readonly at_us: number; readonly text: string }

export type NoteState = 'empty' | 'typing' | 'saved' | 'waits';

/** Keeps a note with every key, and sends it a second after the last one, always whole and under the same number. */
export class NoteKeeper {
  state: NoteState = 'empty';
  onChange: () => void = () => {};
  private writing: Writing | undefined;
  private timer: ReturnType<typeof setTimeout> | undefined;

  /** @param what under which it is found again, of this person (0: of nobody) */
  constructor(private readonly outbox: Outbox, private readonly drafts: Drafts, private readonly about: About, private readonly what: string, private readonly person: number, private readonly now_ms: () => number = Date.now) {
    const kept = drafts.get<Writing>(what, person);
    // What was saved to its end stands in the list.
    if (kept && !outbox.has(this.place(kept))) drafts.drop(what, person);
    else if (kept) {
      this.writing = kept;
      this.state = 'waits';
      this.later();
    }
  }

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

  /** Sends what is not saved. It is called again where the records were silent. */
  async save(): Promise<void> {
    clearTimeout(this.timer);
    await this.outbox.flush();
    if (this.writing && this.text.trim() !== '') this.become(this.outbox.has(this.place(this.writing)) ? 'waits' : 'saved');
  }

  /** The note is done: the next words are another one. */
  async done(): Promise<boolean> {
    await this.save();
    if (this.state === 'waits') return false;
    this.writing = undefined;
    this.drafts.drop(this.what, this.person);
    this.become('empty');
    return true;
  }

  close(): void { clearTimeout(this.timer); }

  private place({ id }: Writing): string { return `note-${id}`; }

  private later(): void {
    clearTimeout(this.timer);
    this.timer = setTimeout(() => void this.save(), SAVED_AFTER_MS);
  }

  private become(state: NoteState): void {
    this.state = state;
    this.onChange();
  }
}
