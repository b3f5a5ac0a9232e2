import { Refused, Silent, type ClinicApi } from './api';
import type { Drafts } from './drafts';

/** Something that is to be saved, with the key that makes it happen once. */
export interface Waiting { readonly path: string; readonly body: Readonly<Record<string, unknown>>; readonly key: string }

/** Refusals after which the same words may be taken later. */
const LATER = ['hidden', 'locked', 'not_signed_in', 'busy', 'database', 'station_silent'];

const newKey = (): string => `${Date.now()}-${Math.random().toString(36).slice(2)}${Math.random().toString(36).slice(2)}`;

/** Marks, pain and notes: sent in their order, kept until the records have them. Each account has its own. */
export class Outbox {
  /** Called when the number that waits has changed. */
  onChange: () => void = () => {};
  /** Called with what the records will never take, and why. */
  onRefused: (waiting: Waiting, refused: Refused) => void = () => {};
  private under_way = false;

  constructor(private readonly api: Pick<ClinicApi, 'send'>, private readonly drafts: Drafts) {}

  get waiting(): readonly Waiting[] { return this.drafts.get<Waiting[]>('outbox', 0) ?? []; }

  /** Keeps it first, then sends it. */
  async add(path: string, body: Waiting['body'], key = newKey()): Promise<void> {
    this.keep([...this.waiting, { path, body, key }]);
    await this.flush();
  }

  /** Sends what waits. Nothing is lost where it fails, and nothing comes twice where an answer was lost. */
  async flush(): Promise<void> {
    if (this.under_way || this.drafts.account === 0) return;
    this.under_way = true;
    const account = this.drafts.account;
    try {
      for (let next = this.waiting[0]; next && this.drafts.account === account; next = this.waiting[0]) {
        if (!await this.sent(next)) break;
        if (this.drafts.account === account) this.keep(this.waiting.filter(({ key }) => key !== next.key));
      }
    } finally {
      this.under_way = false;
    }
  }

  private async sent(next: Waiting): Promise<boolean> {
    try {
      await this.api.send('POST', next.path, next.body, next.key);
      return true;
    } catch (problem) {
      if (problem instanceof Silent) return false;
      if (!(problem instanceof Refused) || LATER.includes(problem.code)) return false;
      this.onRefused(next, problem);
      return true;
    }
  }

  private keep(waiting: readonly Waiting[]): void {
    if (waiting.length > 0) this.drafts.set('outbox', 0, waiting);
    else this.drafts.drop('outbox', 0);
    this.onChange();
  }
}
