// What was typed and is not saved yet. It outlives hiding, a reload and the tab, and is shown to the same account only.

export interface Store { getItem(key: string): string | null; setItem(key: string, text: string): void; removeItem(key: string): void }

const PREFIX = 'wholehand.clinic';

export class Drafts {
  /** For browsers that keep nothing: as long as the page lives. */
  private readonly here = new Map<string, string>();
  /** The account that is signed in; 0: nobody. */
  account = 0;

  constructor(private readonly storage: () => Store | undefined) {}

  /** @param what the field or form; `person`: a patient's number, or 0 */
  get<T>(what: string, person: number): T | undefined {
    if (this.account === 0) return undefined;
    const key = this.key(what, person);
    const text = this.kept(key) ?? this.here.get(key);
    if (text === undefined) return undefined;
    try { return JSON.parse(text) as T; } catch { return undefined; }
  }

  set(what: string, person: number, value: unknown): void {
    if (this.account === 0) return;
    const key = this.key(what, person), text = JSON.stringify(value);
    this.here.set(key, text);
    try { this.storage()?.setItem(key, text); } catch { /* this page keeps it */ }
  }

  drop(what: string, person: number): void {
    const key = this.key(what, person);
    this.here.delete(key);
    try { this.storage()?.removeItem(key); } catch { /* nothing was kept */ }
  }

  private kept(key: string): string | undefined {
    try { return this.storage()?.getItem(key) ?? undefined; } catch { return undefined; }
  }

  private key(what: string, person: number): string { return `${PREFIX}.${this.account}.${person}.${what}`; }
}
