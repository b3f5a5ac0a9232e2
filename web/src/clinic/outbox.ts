import { newKey, Refused, Silent, type ClinicApi } from './api';
import type { Drafts } from './drafts';

/** Something that is to be saved. With a key it happens once; a note has a number of its own in its place. */
export interface Waiting { readonly method: 'POST' | 'PUT'; readonly path: string; readonly body: Readonly<Record<string, unknown>>; readonly key?: string }

/** Refusals after which the same words may be taken later. */
const LATER = ['hidden', 'locked', 'not_signed_in', 'busy', 'database', 'station_silent', 'too_many_tries'];
const PLACE = 'outbox.';

/** Marks, pain and notes: kept until the records have them. Each account has its own. */
export class Outbox {
  /** Called when what waits has changed. */
  onChange: () => void = () => {};
  /** Called with what the records will never take, and why. */
  onRefused: (waiting: Waiting, refused: Refused) => void = () => {};
  private under_way: Promise<void> | undefined;

  constructor(private readonly api: Pick<ClinicApi, 'send'>, private readonly drafts: Drafts) {}

  get waiting(): number { return this.drafts.all(PLACE).length; }
  has(name: string): boolean { return this.drafts.get(PLACE + name, 0) !== undefined; }

  /** Keeps it, in place of what waits under the same name. */
  keep(name: string, waiting: Waiting): void {
    this.drafts.set(PLACE + name, 0, waiting);
    this.onChange();
  }

  drop(name: string): void {
    this.drafts.drop(PLACE + name, 0);
    this.onChange();
  }

  /** Keeps it first, then sends it. */
  async add(path: string, body: Waiting['body'], name = newKey()): Promise<void> {
    this.keep(name, { method: 'POST', path, body, key: newKey() });
    await this.flush();
  }

  /** Sends what waits, each once. Nothing is lost where it fails, and nothing comes twice where an answer was lost. */
  flush(): Promise<void> {
    this.under_way ??= this.send().finally(() => { this.under_way = undefined; });
    return this.under_way;
  }

  private async send(): Promise<void> {
    const { drafts } = this, { account } = drafts;
    const tried = new Set<string>();
    const words = (place: string, waiting: Waiting): string => place + JSON.stringify(waiting);
    while (drafts.account === account && account !== 0) {
      const next = drafts.all<Waiting>(PLACE).find(([place, waiting]) => !tried.has(words(place, waiting)));
      if (!next) return;
      const [place, waiting] = next;
      tried.add(words(place, waiting));
      try {
        await this.api.send(waiting.method, waiting.path, waiting.body, waiting.key);
      } catch (problem) {
        if (problem instanceof Silent) return;
        if (!(problem instanceof Refused)) throw problem;
        if (LATER.includes(problem.code)) {
          // A refusal changed nothing, and is the answer to its key for ever: the next time is another intent.
          const again = waiting.key === undefined ? waiting : { ...waiting, key: newKey() };
          if (drafts.account === account) drafts.set(place, 0, again);
          tried.add(words(place, again));
          continue;
        }
        this.onRefused(waiting, problem);
      }
      // Meanwhile it may have been replaced.
      if (drafts.account === account && JSON.stringify(drafts.get(place, 0)) === JSON.stringify(waiting)) this.drop(place.slice(PLACE.length));
    }
  }
}
