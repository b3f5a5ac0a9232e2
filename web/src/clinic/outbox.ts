import { newKey, RefusalError, NoAnswerError, type ClinicApi } from './api';
import type { Drafts } from './drafts';

/** A change that waits to be saved. With a key it is applied once; a note has a number of its own instead. */
export interface OutboxEntry { readonly method: 'POST' | 'PUT'; readonly path: string; readonly body: Readonly<Record<string, unknown>>; readonly key?: string }

/** Refusals after which the same request may be accepted later. */
const LATER = ['hidden', 'locked', 'not_signed_in', 'busy', 'database', 'station_silent', 'too_many_tries'];
const PLACE = 'outbox.';

/** Marks, pain values and notes that are kept until the records have them. Each account has its own outbox. */
export class Outbox {
  /** Called when the waiting entries have changed. */
  onChange: () => void = () => {};
  /** Called with an entry that the records will never accept, and their reason. */
  onRefused: (waiting: OutboxEntry, refused: RefusalError) => void = () => {};
  private under_way: Promise<void> | undefined;

  constructor(private readonly api: Pick<ClinicApi, 'send'>, private readonly drafts: Drafts) {}

  get waiting(): number { return this.drafts.all(PLACE).length; }
  has(name: string): boolean { return this.drafts.get(PLACE + name, 0) !== undefined; }

  /** Stores an entry; it replaces a waiting entry with the same name. */
  keep(name: string, waiting: OutboxEntry): void {
    this.drafts.set(PLACE + name, 0, waiting);
    this.onChange();
  }

  drop(name: string): void {
    this.drafts.drop(PLACE + name, 0);
    this.onChange();
  }

  /** Stores an entry first, then sends it. */
  async add(path: string, body: OutboxEntry['body'], name = newKey()): Promise<void> {
    this.keep(name, { method: 'POST', path, body, key: newKey() });
    await this.flush();
  }

  /** Sends every waiting entry once. A failure loses nothing, and a lost answer duplicates nothing. */
  flush(): Promise<void> {
    this.under_way ??= this.send().finally(() => { this.under_way = undefined; });
    return this.under_way;
  }

  private async send(): Promise<void> {
    const { drafts } = this, { account } = drafts;
    const tried = new Set<string>();
    const words = (place: string, waiting: OutboxEntry): string => place + JSON.stringify(waiting);
    while (drafts.account === account && account !== 0) {
      const next = drafts.all<OutboxEntry>(PLACE).find(([place, waiting]) => !tried.has(words(place, waiting)));
      if (!next) return;
      const [place, waiting] = next;
      tried.add(words(place, waiting));
      try {
        await this.api.send(waiting.method, waiting.path, waiting.body, waiting.key);
      } catch (problem) {
        if (problem instanceof NoAnswerError) return;
        if (!(problem instanceof RefusalError)) throw problem;
        if (LATER.includes(problem.code)) {
          // A refused key stays refused: the next attempt needs another one.
          const again = waiting.key === undefined ? waiting : { ...waiting, key: newKey() };
          if (drafts.account === account) drafts.set(place, 0, again);
          tried.add(words(place, again));
          continue;
        }
        this.onRefused(waiting, problem);
      }
      // The entry may have been replaced while it was sent.
      if (drafts.account === account && JSON.stringify(drafts.get(place, 0)) === JSON.stringify(waiting)) this.drop(place.slice(PLACE.length));
    }
  }
}
