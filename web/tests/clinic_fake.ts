// An in-memory substitute for the records process with the same HTTP interface. It encrypts and measures nothing.
import type { BackupPlace, Item, LogEntry, LooseSession, Note, Patient, PatientRow, PatientText, Trial, Visit } from '../src/clinic/records';

export interface Answer { readonly status: number; readonly body: unknown }
type Body = Readonly<Record<string, unknown>>;
type Row = PatientText & { id: number; version: number };
type Writable<T> = { -readonly [Key in keyof T]: T[Key] };

/** A key of 64 hexadecimal digits, different for each account. */
const browserKey = (account: number): string => account.toString(16).padStart(64, '0');
const refuse = (status: number, refused: string, why: string, more: Body = {}): Answer => ({ status, body: { refused, why, ...more } });
const ok = (body: unknown): Answer => ({ status: 200, body });

const GENTLE = { effort_limit_hand_tip_n: 3, effort_limit_arm_n: 5, viscosity_ratio: 0.3 };
const PLAN: Item[] = [
  { exercise: 'squeeze-to-level', level: 1, minutes: 5, help: 'full' },
  { exercise: 'free-grasping', level: 1, minutes: 10, help: 'some' },
];
export const PRESETS = {
  force: [{ id: 'gentle', parameters: GENTLE }, { id: 'normal', parameters: { effort_limit_hand_tip_n: 6, effort_limit_arm_n: 12, viscosity_ratio: 0.1 } }],
  plans: [{ id: 'first', items: PLAN }, { id: 'short', items: [PLAN[0]] }],
  goals: [{ id: 'reach', items: [PLAN[1]] }],
  course: { weeks: 6, visits_a_week: 3 },
  exercises: [{ id: 'squeeze-to-level', levels: 3 }, { id: 'free-grasping', levels: 4 }],
};

export class FakeClinic {
  clinic: 'new' | 'locked' | 'open' = 'new';
  tiles: { id: number; name: string; colour: string; pin: string; left?: boolean }[] = [];
  places: BackupPlace[] = [{ folder: '/srv/backup', own: true, last_us: 0, free_bytes: 1e10 }];
  log: LogEntry[] = [];
  phrase = '';
  readonly code = 'TRAY-7KQM-WOLF-29XD-MINT';
  hidden = false;
  /** true: no request is answered. */
  gone = false;
  /** A refusal that replaces the answers of the next requests with that path. */
  instead: { path: RegExp; answer: Answer } | undefined;
  patients: Row[] = [];
  visits: Writable<Visit>[] = [];
  sessions: LooseSession[] = [];
  notes: (Note & { patient: number })[] = [];
  backup = { last_us: 0, folder: '/srv/backup' };
  asked: string[] = [];
  tries = 5;
  private token = '';
  private account = 0;
  private last = 100;
  private readonly answered = new Map<string, Answer>();

  constructor(private readonly now_us: () => number = () => Date.now() * 1000) {}

  /** Has the signature of fetch(). */
  fetch = async (url: string, init: RequestInit = {}): Promise<Response> => {
    const { pathname, search } = new URL(url, 'http://127.0.0.1');
    if (pathname === '/api/clinic') return new Response('{"port":9}', { status: 200 });
    if (this.gone) throw new TypeError('Failed to fetch');
    const { status, body } = this.handle(init.method ?? 'GET', pathname + search, new Headers(init.headers), typeof init.body === 'string' ? JSON.parse(init.body) as Body : {});
    return new Response(typeof body === 'string' ? body : JSON.stringify(body), { status });
  };

  handle(method: string, path: string, headers: { get(name: string): string | null }, body: Body): Answer {
    this.asked.push(`${method} ${path}`);
    const key = headers.get('Idempotency-Key');
    if (method !== 'GET' && !key && !path.startsWith('/api/notes/')) return refuse(400, 'bad_value', 'no Idempotency-Key');
    const before = key ? this.answered.get(key) : undefined;
    if (before) return before;
    const answer = this.instead?.path.test(path) ? this.instead.answer : this.answer(method, path, headers.get('Authorization') ?? '', body);
    if (key) this.answered.set(key, answer);
    return answer;
  }

  signIn(account = this.account || this.tiles[0].id): { token: string; account: number; browser_key: string } {
    this.account = account;
    this.token = `token-${this.last += 1}`;
    this.hidden = false;
    return { token: this.token, account, browser_key: browserKey(account) };
  }

  add(text: Partial<PatientText> & { readonly name: string }): Row {
    const row: Row = { code: `P-${String(this.patients.length + 1).padStart(3, '0')}`, born: '', number: '', side: 'right', hands: { right: { length_m: 0.188, breadth_m: 0.085 } }, preset: 'gentle', parameters: {}, warnings: '', plan: PLAN, ...text, id: this.last += 1, version: 1 };
    this.patients.push(row);
    return row;
  }

  open(patient: number | null, side: Visit['side'], plan: readonly Item[], state: Visit['state'] = 'open', began_us = this.now_us()): Writable<Visit> {
    const visit: Writable<Visit> = { id: this.last += 1, patient, side, began_us, ended_us: 0, offset_min: 60, state, account: this.account, plan, item: 0, trials: [], pain_before: null, pain_after: null };
    this.visits.push(visit);
    return visit;
  }

  trial(visit: Writable<Visit>, item: number, score: number, state: Trial['state'] = 'measured'): void {
    const { exercise, level } = visit.plan[item];
    visit.trials = [...visit.trials, { item, exercise, level, recording: `r${visit.id}-${item}.h5`, began_us: visit.began_us + item * 6e8, active_s: 60 * visit.plan[item].minutes - 20, helped_share: 0.3, results: [{ name: 'score', value: score, unit: '' }, { name: 'reach_s', value: 3 - score / 100, unit: 's' }], state, why: '' }];
  }

  private answer(method: string, path: string, authorization: string, body: Body): Answer {
    const [where, query = ''] = path.split('?');
    const route = `${method} ${where.replace(/\/\d+/g, '/N')}`;
    const [first] = (where.match(/\d+/g) ?? []).map(Number);
    if (route === 'GET /api/state') return ok({ clinic: this.clinic, tiles: this.clinic === 'open' ? this.tiles.map(({ pin: _, ...tile }) => tile) : [], station: { heard: true }, folder: { path: '/media/records/clinic', empty: true }, visit: this.openVisit?.id ?? 0, backup: this.backup, version: 1 });
    if (route === 'POST /api/init') return this.init(body);
    if (route === 'POST /api/unlock') {
      if (body.pass_phrase !== this.phrase && body.recovery_code !== this.code) return refuse(403, 'wrong_phrase', 'wrong');
      this.clinic = 'open';
      return ok({});
    }
    if (this.clinic !== 'open') return refuse(403, 'locked', 'locked');
    if (route === 'POST /api/sign_in') return this.pin(body, Number(body.account));
    if (authorization !== `Bearer ${this.token}` || this.token === '') return refuse(401, 'not_signed_in', 'no session');
    if (route === 'POST /api/show') {
      const { status, body: said } = this.pin(body, this.account, false);
      return { status, body: status === 200 ? { browser_key: browserKey(this.account) } : said };
    }
    const ofVisit = /^(GET \/api\/visits\/open|POST \/api\/visits\/N\/(item|finish|notes|pain)|POST \/api\/(hide|sign_out|lock)|GET \/api\/presets|PUT \/api\/notes\/N)$/;
    if (this.hidden && !ofVisit.test(route)) return refuse(403, 'hidden', 'hidden');
    return this.inside(route, first, query, body);
  }

  private inside(route: string, id: number, query: string, body: Body): Answer {
    const visit = this.visits.find((other) => other.id === id), patient = this.patients.find((other) => other.id === id);
    switch (route) {
      case 'POST /api/lock': this.clinic = 'locked'; this.token = ''; return ok({});
      case 'POST /api/hide': this.hidden = true; return ok({});
      case 'POST /api/sign_out': this.token = ''; return ok({});
      case 'POST /api/accounts': this.tiles.push({ id: this.last += 1, name: String(body.name), colour: String(body.colour), pin: String(body.pin) }); return ok({});
      case 'POST /api/accounts/N/leave': this.tiles = this.tiles.map((tile) => (tile.id === id ? { ...tile, left: true } : tile)); return ok({});
      case 'GET /api/backup/places': return ok({ places: this.places });
      case 'POST /api/backup': this.places = this.places.map((place) => (place.folder === body.folder ? { ...place, last_us: this.now_us() } : place)); return ok({ file: `${String(body.folder)}/clinic-1.db`, last_us: this.now_us() });
      case 'GET /api/log': return ok({ log: this.log });
      case 'POST /api/pin': {
        const mine = this.tiles.find((tile) => tile.id === this.account)!;
        if (mine.pin !== body.pin) return refuse(401, 'wrong_pin', 'wrong', { tries_left: 4 });
        mine.pin = String(body.new_pin);
        return ok({});
      }
      case 'GET /api/presets': return ok(PRESETS);
      case 'GET /api/patients': return this.list(decodeURIComponent(query.replace(/^find=/, '')));
      case 'GET /api/patients/propose': return ok({ code: `P-${String(this.patients.length + 1).padStart(3, '0')}` });
      case 'POST /api/patients': return this.check(body, 0) ?? ok(this.whole(this.add(body as unknown as PatientText)));
      case 'PUT /api/patients/N': return patient ? this.change(patient, body) : refuse(404, 'not_found', 'gone');
      case 'GET /api/patients/N': return patient ? ok(this.whole(patient)) : refuse(404, 'not_found', 'gone');
      case 'DELETE /api/patients/N': case 'POST /api/patients/N/erase': this.patients = this.patients.filter((other) => other.id !== id); return ok({});
      case 'POST /api/patients/N/merge': for (const each of this.visits) if (each.patient === body.from) each.patient = id; this.patients = this.patients.filter((other) => other.id !== body.from); return ok({});
      case 'POST /api/patients/N/no_show': this.open(id, 'right', [], 'no_show'); return ok({});
      case 'POST /api/patients/N/visits': return this.openVisit ? refuse(409, 'visit_open', 'open') : ok(this.open(id, body.side as Visit['side'], body.plan as Item[]));
      case 'POST /api/guest_visits': return this.openVisit ? refuse(409, 'visit_open', 'open') : ok(this.open(null, body.side as Visit['side'], PLAN));
      case 'GET /api/visits/open': return ok({ visit: this.openVisit ?? null, patient: this.openVisit && !this.hidden ? this.rowOf(this.openVisit.patient ?? 0) ?? null : null });
      case 'POST /api/visits/N/notes': return this.note(body, visit, this.last += 1);
      case 'PUT /api/notes/N': return this.note(body, this.visits.find((other) => other.id === body.visit), id);
      case 'GET /api/sessions': return ok({ sessions: this.sessions, more: 0 });
      case 'POST /api/sessions/give': return this.give(Number(body.patient), body.sessions as number[]);
      case 'DELETE /api/sessions/N': this.sessions = this.sessions.filter((other) => other.id !== id); return ok({ recordings_left: [] });
      case 'GET /api/export/patient/N.csv': case 'GET /api/export/all.csv': return { status: 200, body: 'code,day,active_min\r\nP-001,2026-11-02,14\r\n' };
      default: return visit ? this.ofVisit(route, visit, body) : refuse(404, 'not_found', `nothing at ${route}`);
    }
  }

  private ofVisit(route: string, visit: Writable<Visit>, body: Body): Answer {
    switch (route) {
      case 'POST /api/visits/N/item': visit.item = Number(body.item); visit.state = 'open'; return ok(visit);
      case 'POST /api/visits/N/finish': visit.state = visit.patient === null ? 'guest' : body.state as Visit['state']; visit.ended_us = this.now_us(); return ok(visit);
      case 'POST /api/visits/N/pain':
        if (body.value !== null && !(Number.isInteger(body.value) && Number(body.value) >= 0 && Number(body.value) <= 10)) return refuse(400, 'bad_value', 'pain', { field: 'value' });
        visit[body.when === 'before' ? 'pain_before' : 'pain_after'] = body.value as number | null;
        return ok(visit);
      case 'POST /api/visits/N/move': visit.patient = Number(body.patient); if (visit.state === 'guest') visit.state = 'done'; return ok(visit);
      case 'DELETE /api/visits/N': this.visits = this.visits.filter((other) => other !== visit); return ok({});
      default: return refuse(404, 'not_found', `nothing at ${route}`);
    }
  }

  private give(patient: number, ids: readonly number[]): Answer {
    const given = this.sessions.filter(({ id }) => ids.includes(id));
    if (given.length < ids.length) return refuse(409, 'changed', 'given meanwhile');
    const visit = this.open(patient, given[0].side, given.map(({ exercise, level, duration_s }) => ({ exercise, level, minutes: duration_s / 60, help: 'full' as const })), 'done', given[0].began_us);
    visit.trials = given.map((session, item) => ({ ...session, item }));
    this.sessions = this.sessions.filter(({ id }) => !ids.includes(id));
    return ok(visit);
  }

  private get openVisit(): Writable<Visit> | undefined { return this.visits.find(({ state }) => state === 'open'); }

  private init(body: Body): Answer {
    if (String(body.pass_phrase).length < 8) return refuse(400, 'bad_value', 'too short', { field: 'pass_phrase' });
    const tile = body.tile as { name: string; colour: string; pin: string };
    this.phrase = String(body.pass_phrase);
    this.tiles = [{ id: 1, ...tile }];
    this.account = 1;
    this.clinic = 'open';
    return ok({ recovery_code: this.code, ...this.signIn() });
  }

  private pin({ pin }: Body, account: number, anew = true): Answer {
    const tile = this.tiles.find(({ id }) => id === account);
    if (tile?.pin !== pin) return this.tries <= 1 ? refuse(429, 'too_many_tries', 'wait', { wait_s: 60 }) : refuse(403, 'wrong_pin', 'wrong', { tries_left: this.tries -= 1 });
    this.tries = 5;
    this.account = account;
    this.hidden = false;
    return ok(anew ? this.signIn() : {});
  }

  private list(find: string): Answer {
    const rows = this.patients.map(({ id }) => this.rowOf(id)!).filter(({ name, code }) => `${name} ${code}`.toLowerCase().includes(find.toLowerCase())).sort((a, b) => a.name.localeCompare(b.name));
    return ok({ open: rows.filter(({ state }) => state !== ''), patients: rows, guests: this.visits.filter(({ state }) => state === 'guest') });
  }

  private rowOf(id: number): PatientRow | undefined {
    const row = this.patients.find((other) => other.id === id);
    if (!row) return undefined;
    const visits = this.visits.filter(({ patient }) => patient === id), due = visits.find(({ state }) => state === 'open' || state === 'unfinished');
    return { id, code: row.code, name: row.name, side: row.side, visits: visits.filter(({ state }) => state !== 'no_show').length, last_visit_us: Math.max(0, ...visits.map(({ began_us }) => began_us)), state: (due?.state ?? '') as PatientRow['state'], visit: due?.id ?? 0 };
  }

  private whole(row: Row): Patient {
    const visits = this.visits.filter(({ patient }) => patient === row.id), notes = this.notes.filter(({ patient }) => patient === row.id);
    const done = visits.filter(({ trials }) => trials.length > 0);
    const points = (n: number) => done.flatMap(({ began_us, trials }) => trials.at(-1)!.results.slice(n, n + 1).map(({ value }) => [began_us, value] as const));
    return { ...row, visits, notes, today: done.at(-1)?.plan ?? row.plan, curves: [{ name: 'active_min', points: done.map((visit) => [visit.began_us, visit.trials.reduce((sum, { active_s }) => sum + (active_s ?? 0) / 60, 0)] as const) },
      { name: 'score', points: points(0) }, { name: 'reach_s', points: points(1) }, { name: 'helped_share', points: [] }] };
  }

  private check(body: Body, id: number): Answer | undefined {
    if (this.patients.some((other) => other.code === body.code && other.id !== id)) return refuse(409, 'code_exists', 'code exists', { field: 'code' });
    if (!/^[\w-]{1,60}$/.test(String(body.code))) return refuse(400, 'bad_value', `The code "${String(body.code)}" may have letters, digits, "-" and "_", 60 at most.`, { field: 'code' });
    if (String(body.born) > new Date(this.now_us() / 1000).toISOString().slice(0, 10)) return refuse(400, 'bad_value', `The birth date ${String(body.born)} is in the future.`, { field: 'born' });
    return undefined;
  }

  private change(row: Row, body: Body): Answer {
    if (body.version !== row.version) return refuse(409, 'changed', 'changed', { now: this.whole(row) });
    const wrong = this.check(body, row.id);
    if (!wrong) Object.assign(row, body, { version: row.version + 1 });
    return wrong ?? ok(this.whole(row));
  }

  /** A note with a known number replaces the earlier text. */
  private note(body: Body, visit: Visit | undefined, id: number): Answer {
    const { kind = 'text', text = '', at_us = this.now_us() } = body;
    const patient = visit ? visit.patient ?? 0 : Number(body.patient);
    if (this.hidden && visit !== this.openVisit) return refuse(403, 'hidden', 'hidden');
    const note = { id, visit: visit?.id ?? 0, patient, at_us: Number(at_us), account: this.account, kind: String(kind), text: String(text) };
    this.notes = [...this.notes.filter((other) => other.id !== id), note];
    return ok(note);
  }
}
