// Text that was typed and is not saved in the records yet. It survives hidden names, a reload and closing the tab. The browser
// stores it encrypted with a key that the records give to one account with its PIN: nobody else can read it there.

export type Store = Pick<Storage, 'getItem' | 'setItem' | 'removeItem' | 'key' | 'length'>;

const PREFIX = 'wholehand.clinic';
/** Length of the AES-GCM nonce before the ciphertext [bytes]. */
const NONCE = 12;

const utf8 = new TextEncoder();
const fromHex = (digits: string): Uint8Array<ArrayBuffer> => Uint8Array.from(digits.match(/../g) ?? [], (pair) => parseInt(pair, 16));
const toBase64 = (bytes: Uint8Array): string => btoa(Array.from(bytes, (byte) => String.fromCharCode(byte)).join(''));
const fromBase64 = (text: string): Uint8Array<ArrayBuffer> => Uint8Array.from(atob(text), (char) => char.charCodeAt(0));

export class Drafts {
  /** The account that owns these texts; 0: none. */
  account = 0;
  private readonly here = new Map<string, string>();
  private key: CryptoKey | undefined;
  private writing: Promise<void> = Promise.resolve();

  constructor(private readonly storage: () => Store | undefined) {}

  /** Reads the stored drafts of an account. Until its key is known, new text stays in the page. */
  async open(account: number, key: string): Promise<void> {
    if (account !== this.account) this.close();
    this.account = account;
    if (key === '' || !globalThis.crypto?.subtle) return;
    const sealing = await crypto.subtle.importKey('raw', fromHex(key), 'AES-GCM', false, ['encrypt', 'decrypt']);
    const typed = [...this.here.keys()];
    for (const name of this.stored()) {
      const text = this.here.has(name) ? undefined : await this.unsealed(sealing, name);
      if (text !== undefined) this.here.set(name, text);
    }
    this.key = sealing;
    for (const name of typed) this.write(name, this.here.get(name));
  }

  close(): void {
    this.account = 0;
    this.key = undefined;
    this.here.clear();
  }

  /** @param what the field or form @param person the patient's number; 0: none */
  get<T>(what: string, person: number): T | undefined {
    const text = this.here.get(this.name(what, person));
    return text === undefined ? undefined : JSON.parse(text) as T;
  }

  /** The drafts without a patient whose names begin with `what`. */
  all<T>(what: string): readonly (readonly [what: string, value: T])[] {
    const prefix = this.name(what, 0);
    return [...this.here].filter(([name]) => name.startsWith(prefix)).map(([name, text]) => [what + name.slice(prefix.length), JSON.parse(text) as T]);
  }

  set(what: string, person: number, value: unknown): void {
    if (this.account === 0) return;
    const name = this.name(what, person), text = JSON.stringify(value);
    if (this.here.get(name) === text) return;
    this.here.set(name, text);
    this.write(name, text);
  }

  drop(what: string, person: number): void {
    const name = this.name(what, person);
    if (this.here.delete(name)) this.write(name, undefined);
  }

  /** Resolves when everything is stored in the browser, if it stores anything. */
  settled(): Promise<void> { return this.writing; }

  private write(name: string, text: string | undefined): void {
    const { key } = this;
    this.writing = this.writing.then(async () => {
      if (text === undefined) this.storage()?.removeItem(name);
      else if (key) this.storage()?.setItem(name, await this.sealed(key, name, text));
    }).catch(() => { /* the text stays in this page */ });
  }

  private async sealed(key: CryptoKey, name: string, text: string): Promise<string> {
    const iv = crypto.getRandomValues(new Uint8Array(NONCE));
    const box = await crypto.subtle.encrypt({ name: 'AES-GCM', iv, additionalData: utf8.encode(name) }, key, utf8.encode(text));
    return toBase64(new Uint8Array([...iv, ...new Uint8Array(box)]));
  }

  private async unsealed(key: CryptoKey, name: string): Promise<string | undefined> {
    try {
      const bytes = fromBase64(this.storage()?.getItem(name) ?? '');
      const text = await crypto.subtle.decrypt({ name: 'AES-GCM', iv: bytes.subarray(0, NONCE), additionalData: utf8.encode(name) }, key, bytes.subarray(NONCE));
      return new TextDecoder().decode(text);
    } catch { return undefined; }
  }

  private stored(): string[] {
    try {
      const storage = this.storage(), prefix = `${PREFIX}.${this.account}.`;
      return Array.from({ length: storage?.length ?? 0 }, (_, i) => storage?.key(i) ?? '').filter((name) => name.startsWith(prefix));
    } catch { return []; }
  }

  private name(what: string, person: number): string { return `${PREFIX}.${this.account}.${person}.${what}`; }
}
