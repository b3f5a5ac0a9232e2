import { ClinicApi, RefusalError, NoAnswerError, type Fetch } from './api';
import { Drafts, type Store } from './drafts';
import { Outbox } from './outbox';
import { isOpen, type PatientRow, type Presets, type RecordsState, type Tile, type Values, type Visit } from './records';

/** Names are hidden after this long without input [ms]. */
export const NAMES_FOR_MS = 5 * 60_000;
/** While somebody works, the page reports activity to the records this often [ms]: they count requests, not presses. */
const AWAKE_EVERY_MS = 60_000;

/** The gate that the page shows first; `in`: an account is signed in and names may be shown. */
export type Stage = 'looking' | 'without' | 'absent' | 'new' | 'locked' | 'who' | 'hidden' | 'in';

const TOKEN = 'wholehand.clinic.token', ACCOUNT = 'wholehand.clinic.account', KEY = 'wholehand.clinic.key', GENTLE = 'wholehand.gentle';

/** The records' answer to a sign-in. */
export interface SignInResult { readonly token: string; readonly account: number; readonly browser_key: string }

/** The page's knowledge of the records and of the account that works with them. It holds no names while they are hidden. */
export class Clinic {
  readonly api: ClinicApi;
  readonly drafts: Drafts;
  readonly outbox: Outbox;
  state: RecordsState | null = null;
  presets: Presets | null = null;
  /** The open visit and its patient; the patient is null while names are hidden. */
  visit: Visit | null = null;
  visitPatient: PatientRow | null = null;
  /** The visit that was finished last and the next appointment; its card stays until another screen is chosen. */
  finished: { readonly visit: Visit; readonly next: string } | undefined;
  hidden = false;
  /** The last answers about patients, by path. They are shown at once, and while the records do not answer. */
  readonly seen = new Map<string, { readonly at: Date; readonly value: unknown }>();
  /** Time since which the records do not answer; undefined: they answer. */
  silentSince: Date | undefined;
  /** The records answer again after a silence: a visit without a patient may have been wanted meanwhile. */
  cameBack = false;
  /** The records listen on another port than before: a page may only connect to the port that it was loaded with, so it must be loaded again. */
  moved = false;
  /** Called when any of these fields has changed. */
  onChange: () => void = () => {};
  private port = 0;
  private without = false;
  private touched_ms: number;
  /** Resolves when the drafts that this tab had before a reload are restored. */
  private readonly restored: Promise<void>;
  private awake_ms = -Infinity;

  /** @param now_ms a monotonic clock */
  constructor(host: string, private readonly session: () => Store | undefined, private readonly local: () => Store | undefined, private readonly now_ms: () => number, fetched?: Fetch) {
    this.api = new ClinicApi(() => (this.port > 0 ? `http://${host}:${this.port}` : ''), fetched);
    this.drafts = new Drafts(local);
    this.outbox = new Outbox(this.api, this.drafts);
    this.touched_ms = now_ms();
    this.api.onAnswer = (answered) => this.onAnswer(answered);
    this.api.onRefused = (refused) => this.refused(refused);
    this.outbox.onChange = () => this.onChange();
    this.api.token = this.kept(TOKEN);
    this.restored = this.drafts.open(Number(this.kept(ACCOUNT)) || 0, this.kept(KEY));
  }

  get stage(): Stage {
    if (this.without) return 'without';
    if (!this.state) return this.silentSince ? 'absent' : 'looking';
    if (this.state.clinic !== 'open') return this.state.clinic;
    if (this.api.token === '') return 'who';
    return this.hidden ? 'hidden' : 'in';
  }

  get account(): number { return this.drafts.account; }
  get tile(): Tile | undefined { return this.api.token === '' ? undefined : this.state?.tiles.find(({ id }) => id === this.account); }

  /** Asks the station once for the port of the records, then the records for their state. */
  async look(station: Fetch = (url, init) => fetch(url, init)): Promise<void> {
    await this.restored;
    // The records process may listen on another port after a restart.
    if (this.port === 0 || this.silentSince) await this.findPort(station);
    if (this.port === 0) return;
    try {
      this.state = await this.api.get<RecordsState>('/api/state');
      if (this.state.clinic !== 'open') this.forgetNames();
      if (this.stage === 'in' || this.stage === 'hidden') await this.lookAtVisit();
      if (this.stage === 'in' && !this.presets) this.takePresets(await this.api.get<Presets>('/api/presets'));
      if (this.state.clinic === 'open') void this.outbox.flush();
    } catch (problem) {
      if (!(problem instanceof NoAnswerError) && !(problem instanceof RefusalError)) throw problem;
    }
    this.onChange();
  }

  async lookAtVisit(): Promise<void> {
    const { visit, patient } = await this.api.get<{ visit: Visit | null; patient: PatientRow | null }>('/api/visits/open');
    this.visit = visit;
    if (visit?.patient && !patient) this.hidden = true;
    this.visitPatient = this.hidden ? null : patient;
    this.onChange();
  }

  /** Reads patient data and remembers it while names may be shown. */
  async read<T>(path: string): Promise<T> {
    const value = await this.api.get<T>(path);
    if (!this.hidden) this.seen.set(path, { at: new Date(), value });
    return value;
  }

  /** Stores the gentle preset's numbers beyond the tab: without records no session starts above them. */
  takePresets(presets: Presets): void {
    this.presets = presets;
    try { this.local()?.setItem(GENTLE, JSON.stringify(presets.force[0]?.parameters ?? {})); } catch { /* this page knows them */ }
  }

  get gentle(): Values {
    if (this.presets) return this.presets.force[0]?.parameters ?? {};
    try { return JSON.parse(this.local()?.getItem(GENTLE) ?? '{}') as Values; } catch { return {}; }
  }

  /** Sets the visit that was opened, changed or ended from this page. */
  take(visit: Visit | null, patient = this.visitPatient): void {
    this.visit = visit && isOpen(visit) ? visit : null;
    this.visitPatient = this.visit && !this.hidden ? patient : null;
    this.onChange();
  }

  async signedIn({ token, account, browser_key }: SignInResult): Promise<void> {
    await this.drafts.open(account, browser_key);
    this.api.token = token;
    this.hidden = false;
    this.keep(TOKEN, token);
    this.keep(ACCOUNT, String(account));
    this.keep(KEY, browser_key);
    this.touch();
    void this.outbox.flush();
  }

  /** @param typing true: text that the account types into an open visit is still kept for it */
  signedOut(typing = false): void {
    this.api.token = '';
    this.keep(TOKEN, '');
    if (!typing) {
      this.drafts.close();
      this.keep(ACCOUNT, '');
    }
    this.hidden = false;
    this.forgetNames();
    this.onChange();
  }

  /** Removes the names from the page first, then notifies the records. */
  async hide(): Promise<void> {
    this.hideHere();
    await this.api.send('POST', '/api/hide').catch(() => {});
  }

  async show(pin: string): Promise<void> {
    const { browser_key } = await this.api.send<Pick<SignInResult, 'browser_key'>>('POST', '/api/show', { pin });
    await this.drafts.open(this.account, browser_key);
    this.keep(KEY, browser_key);
    this.hidden = false;
    this.touch();
    await this.lookAtVisit().catch(() => {});
    void this.outbox.flush();
    this.onChange();
  }

  /** Records that somebody pressed or typed. */
  touch(): void {
    this.touched_ms = this.now_ms();
    if (this.stage !== 'in' || this.touched_ms - this.awake_ms < AWAKE_EVERY_MS) return;
    this.awake_ms = this.touched_ms;
    void this.api.get('/api/presets').catch(() => {});
  }

  /** Hides names after NAMES_FOR_MS without input. It must be called often. */
  watch(): void {
    if (this.stage === 'in' && this.now_ms() - this.touched_ms > NAMES_FOR_MS) void this.hide();
  }

  private async findPort(station: Fetch): Promise<void> {
    try {
      const answer = await station('/api/clinic', { cache: 'no-store', signal: AbortSignal.timeout(6000) });
      if (answer.status === 404) this.without = true;
      else if (answer.ok) {
        const port = Number((await answer.json() as { port?: number }).port) || 0;
        this.moved ||= this.port > 0 && port > 0 && port !== this.port;
        this.port = port;
        this.without = false;
      }
    } catch { /* the next call tries again */ }
    if (this.port === 0 && !this.without) this.onAnswer(false);
    this.onChange();
  }

  private onAnswer(answered: boolean): void {
    if (answered === (this.silentSince === undefined)) return;
    this.silentSince = answered ? undefined : new Date();
    if (answered) {
      this.cameBack = this.state !== null;
      void this.outbox.flush();
    }
    this.onChange();
  }

  private refused({ code }: RefusalError): void {
    if (code === 'hidden') this.hideHere();
    else if (code === 'not_signed_in') this.signedOut(this.visit !== null);
    else if (code === 'locked' && this.state) {
      this.state = { ...this.state, clinic: 'locked', tiles: [] };
      this.forgetNames();
      this.onChange();
    }
  }

  private hideHere(): void {
    this.hidden = true;
    this.forgetNames();
    this.onChange();
  }

  private forgetNames(): void {
    this.keep(KEY, '');
    this.seen.clear();
    this.finished = undefined;
    this.visitPatient = null;
    if (this.visit) this.visit = { ...this.visit, notes: [] };
  }

  private kept(key: string): string {
    try { return this.session()?.getItem(key) ?? ''; } catch { return ''; }
  }

  private keep(key: string, text: string): void {
    try {
      if (text === '') this.session()?.removeItem(key);
      else this.session()?.setItem(key, text);
    } catch { /* the value stays in this page */ }
  }
}
