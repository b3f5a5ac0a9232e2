// HTTP client of the records process. That process is not the station's: it may stop while a session continues.

/** A request without an answer for this long has failed [ms]. */
const WITHIN_MS = 6000;
/**
 * The station checks the hand when it opens a visit, which takes up to 20 s; a stick is slow, too; and a key is derived from a
 * phrase, code or PIN by a function that is slow on purpose. A given-up first start would never show its recovery code.
 */
const LONG_WITHIN_MS = 21_000, LONG = /\/(visits|guest_visits|item|backup|init|unlock|phrase|recovery_code|sign_in|show|pin|accounts)$/;

/** The records refused a request; nothing was changed. */
export class RefusalError extends Error {
  constructor(readonly status: number, readonly code: string, readonly why: string, readonly field = '', readonly more: Readonly<Record<string, unknown>> = {}) {
    super(why);
  }
}

/** The records did not answer. The request may have been carried out; a repetition with the same key is safe. */
export class NoAnswerError extends Error {
  constructor() { super('no answer'); }
}

export type Method = 'POST' | 'PUT' | 'DELETE';
export type Fetch = (url: string, init: RequestInit) => Promise<Response>;

/** The idempotency key of a request. */
export const newKey = (): string => (crypto.randomUUID?.() ?? Array.from(crypto.getRandomValues(new Uint8Array(16)), (byte) => byte.toString(16).padStart(2, '0')).join(''));

interface Intent { readonly key: string; under_way?: Promise<unknown> }

export class ClinicApi {
  token = '';
  /** Called after every request: true if an answer came (a refusal counts), else false. */
  onAnswer: (answered: boolean) => void = () => {};
  /** Called with every refusal. */
  onRefused: (refused: RefusalError) => void = () => {};
  private readonly intents = new Map<string, Intent>();

  /** @param base "http://host:port", or the empty string while the port is not known */
  constructor(private readonly base: () => string, private readonly ask: Fetch = (url, init) => fetch(url, init)) {}

  get<T>(path: string): Promise<T> { return this.request<T>('GET', path); }

  /**
   * Sends a change. Equal requests share one idempotency key while the first is under way and until it is answered:
   * a double press changes nothing twice, and a lost answer is requested again.
   */
  send<T>(method: Method, path: string, body: unknown = {}, key?: string): Promise<T> {
    const words = `${method} ${path} ${JSON.stringify(body)}`;
    const intent = this.intents.get(words) ?? { key: key ?? newKey() };
    this.intents.set(words, intent);
    if (intent.under_way) return intent.under_way as Promise<T>;
    const asked = this.request<T>(method, path, body, intent.key).then(
      (answer) => { this.intents.delete(words); return answer; },
      (problem) => {
        if (problem instanceof RefusalError) this.intents.delete(words);
        else intent.under_way = undefined;
        throw problem;
      });
    intent.under_way = asked;
    return asked;
  }

  /** The text of an answer that is not JSON, for example a CSV table. */
  async text(path: string): Promise<string> {
    const answer = await this.fetch('GET', path);
    if (!answer.ok) throw await this.refusal(answer);
    return answer.text();
  }

  private async request<T>(method: string, path: string, body?: unknown, key?: string): Promise<T> {
    const answer = await this.fetch(method, path, body, key);
    if (!answer.ok) throw await this.refusal(answer);
    if (answer.status === 204) return {} as T;
    return await answer.json().catch(() => { throw this.silent(); }) as T;
  }

  private async fetch(method: string, path: string, body?: unknown, key?: string): Promise<Response> {
    const base = this.base();
    if (base === '') throw this.silent();
    const ended = new AbortController();
    const timer = setTimeout(() => ended.abort(), LONG.test(path) ? LONG_WITHIN_MS : WITHIN_MS);
    try {
      const headers: Record<string, string> = {};
      if (this.token !== '') headers.Authorization = `Bearer ${this.token}`;
      if (key !== undefined) Object.assign(headers, { 'Content-Type': 'application/json', 'Idempotency-Key': key });
      const answer = await this.ask(base + path, { method, headers, body: body === undefined ? undefined : JSON.stringify(body), cache: 'no-store', signal: ended.signal });
      this.onAnswer(true);
      return answer;
    } catch {
      throw this.silent();
    } finally {
      clearTimeout(timer);
    }
  }

  private silent(): NoAnswerError {
    this.onAnswer(false);
    return new NoAnswerError();
  }

  private async refusal(answer: Response): Promise<RefusalError> {
    const fields = await answer.json().catch(() => ({})) as Record<string, unknown>;
    const refused = new RefusalError(answer.status, String(fields.refused ?? 'other'), String(fields.why ?? answer.statusText), String(fields.field ?? ''), fields);
    this.onRefused(refused);
    return refused;
  }
}
