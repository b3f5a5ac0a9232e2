// The clinic's page against records in memory: stored data, requests and display.
import { readdirSync, readFileSync } from 'node:fs';
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { ClinicApi, RefusalError, NoAnswerError } from '../src/clinic/api';
import { Clinic, NAMES_FOR_MS } from '../src/clinic/clinic';
import { curvePoints, intervalsOverlap, withIntervals } from '../src/clinic/curves';
import { Drafts } from '../src/clinic/drafts';
import { besideLast } from '../src/clinic/end_screen';
import { de } from '../src/clinic/i18n/de';
import { en } from '../src/clinic/i18n/en';
import { fr } from '../src/clinic/i18n/fr';
import { NoteKeeper, SAVED_AFTER_MS } from '../src/clinic/note_keeper';
import { Outbox } from '../src/clinic/outbox';
import { painWords } from '../src/clinic/pain';
import { differing } from '../src/clinic/patient_form';
import { allNotes, isCounting, isOpen, itemNow, nextWish, timeOf_s, type Note, type Patient, type Visit } from '../src/clinic/records';
import { LiveTime } from '../src/clinic/visit_screen';
import { hashOf, routeOf, type Route } from '../src/clinic/routes';
import { activeWords, resultName, timeWords, trialWords } from '../src/clinic/words';
import { FakeClinic } from './clinic_fake';

class MemoryStorage {
  readonly all = new Map<string, string>();
  getItem = (key: string): string | null => this.all.get(key) ?? null;
  setItem = (key: string, text: string): void => { this.all.set(key, text); };
  removeItem = (key: string): void => { this.all.delete(key); };
  key = (i: number): string | null => [...this.all.keys()][i] ?? null;
  get length(): number { return this.all.size; }
}

let fake: FakeClinic;
let local: MemoryStorage, session: MemoryStorage;
let now_ms: number;

beforeEach(() => {
  fake = new FakeClinic(() => 1.8e15);
  fake.clinic = 'open';
  fake.phrase = 'correct horse';
  fake.tiles = [{ id: 1, name: 'A. Keller', colour: '#0B6B58', pin: '1234' }, { id: 2, name: 'B. Rossi', colour: '#1F5FC4', pin: '4321' }];
  [local, session, now_ms] = [new MemoryStorage(), new MemoryStorage(), 0];
});
afterEach(() => { vi.useRealTimers(); });

/** An open page with an account that has signed in. */
async function page(signed = true): Promise<Clinic> {
  const kept = local;
  const clinic = new Clinic('127.0.0.1', () => session, () => kept, () => now_ms, fake.fetch);
  if (signed && clinic.api.token === '') await clinic.signedIn(fake.signIn());
  await clinic.look(fake.fetch);
  return clinic;
}

describe('the clinic page', () => {
  it('shows its gates in this order: first start, pass phrase, account tile, names', async () => {
    fake.clinic = 'new';
    const clinic = await page(false);
    expect(clinic.stage).toBe('new');
    await clinic.api.send('POST', '/api/init', { pass_phrase: 'correct horse', tile: { name: 'A', colour: '#0B6B58', pin: '1234' } });
    await clinic.look(fake.fetch);
    expect(clinic.stage).toBe('who');
    fake.clinic = 'locked';
    await clinic.look(fake.fetch);
    expect(clinic.stage).toBe('locked');
  });

  it('reports a station without records', async () => {
    const clinic = new Clinic('127.0.0.1', () => session, () => local, () => now_ms, fake.fetch);
    await clinic.look(async () => new Response('', { status: 404 }));
    expect(clinic.stage).toBe('without');
  });

  it('hides names after five minutes without input, and keeps the visit', async () => {
    const maria = fake.add({ name: 'Maria Huber' });
    const clinic = await page();
    fake.open(maria.id, 'right', maria.plan);
    await clinic.look(fake.fetch);
    expect(clinic.visitPatient?.name).toBe('Maria Huber');
    now_ms = NAMES_FOR_MS - 1;
    clinic.watch();
    expect(clinic.stage).toBe('in');
    now_ms = NAMES_FOR_MS + 1;
    clinic.watch();
    await clinic.look(fake.fetch);
    expect([clinic.stage, clinic.visitPatient, clinic.visit?.patient]).toEqual(['hidden', null, maria.id]);
    expect(JSON.stringify([clinic.state?.visit, clinic.visit, clinic.visitPatient])).not.toContain('Maria');
    expect(session.getItem('wholehand.clinic.key')).toBeNull();
    // The next item is set up, too.
    const next = await clinic.api.send<Visit>('POST', `/api/visits/${clinic.visit!.id}/item`, { item: 1 });
    expect(next.item).toBe(1);
    await expect(clinic.api.get(`/api/patients/${maria.id}`)).rejects.toMatchObject({ code: 'hidden' });
    await clinic.show('1234');
    expect([clinic.stage, clinic.visitPatient?.name]).toEqual(['in', 'Maria Huber']);
  });

  it('hides names when the records hide them', async () => {
    const maria = fake.add({ name: 'Maria Huber' });
    fake.open(maria.id, 'right', maria.plan);
    const clinic = await page();
    fake.hidden = true;
    await expect(clinic.api.get('/api/patients')).rejects.toMatchObject({ code: 'hidden' });
    expect([clinic.stage, clinic.visitPatient]).toEqual(['hidden', null]);
  });

  it('stays signed in after a reload, and stores nothing in the address', async () => {
    await page();
    expect((await page(false)).stage).toBe('in');
    expect([...session.all.keys()].sort()).toEqual(['wholehand.clinic.account', 'wholehand.clinic.key', 'wholehand.clinic.token']);
  });

  it('shows the number of remaining tries', async () => {
    const clinic = await page(false);
    await expect(clinic.api.send('POST', '/api/sign_in', { account: 1, pin: '9999' })).rejects.toMatchObject({ code: 'wrong_pin', more: { tries_left: 4 } });
  });
});

describe('an idempotency key', () => {
  it('is one for a double press, which opens one visit', async () => {
    const maria = fake.add({ name: 'Maria Huber' });
    const { api } = await page();
    const begin = () => api.send<Visit>('POST', `/api/patients/${maria.id}/visits`, { side: 'right', plan: maria.plan });
    const [first, second] = await Promise.all([begin(), begin()]);
    expect(first.id).toBe(second.id);
    expect(fake.visits).toHaveLength(1);
  });

  it('is kept after a lost answer', async () => {
    const maria = fake.add({ name: 'Maria Huber' });
    const token = fake.signIn().token;
    let lost = true;
    const api = new ClinicApi(() => 'http://127.0.0.1:9', async (url, init) => {
      const answer = await fake.fetch(url, init);
      if (!lost) return answer;
      lost = false;
      throw new TypeError('the answer was lost');
    });
    api.token = token;
    const begin = () => api.send<Visit>('POST', `/api/patients/${maria.id}/visits`, { side: 'right', plan: maria.plan });
    await expect(begin()).rejects.toBeInstanceOf(NoAnswerError);
    expect((await begin()).id).toBe(fake.visits[0].id);
    expect(fake.visits).toHaveLength(1);
  });

  it('is replaced after a refusal', async () => {
    const { api } = await page();
    fake.instead = { path: /accounts/, answer: { status: 503, body: { refused: 'busy', why: 'busy' } } };
    const add = () => api.send('POST', '/api/accounts', { name: 'C', colour: '#0B6B58', pin: '1111' });
    await expect(add()).rejects.toBeInstanceOf(RefusalError);
    fake.instead = undefined;
    await add();
    expect(fake.tiles).toHaveLength(3);
  });
});

/** The drafts of one account, as a newly opened tab finds them. */
async function draftsOf(account: number, key = fake.signIn(account).browser_key): Promise<Drafts> {
  const kept = local, drafts = new Drafts(() => kept);
  await drafts.open(account, key);
  return drafts;
}

describe('typed text', () => {
  it('is stored for the same account and patient only', async () => {
    const drafts = await draftsOf(1);
    drafts.set('note', 12, 'of Maria');
    await drafts.settled();
    const again = await draftsOf(1);
    expect([again.get('note', 12), again.get('note', 13)]).toEqual(['of Maria', undefined]);
    expect((await draftsOf(2)).get('note', 12)).toBeUndefined();
    again.close();
    expect(again.get('note', 12)).toBeUndefined();
  });

  it('cannot be read in the browser, nor with another account’s key', async () => {
    const drafts = await draftsOf(1);
    drafts.set('note', 12, 'of Maria');
    await drafts.settled();
    expect(local.all.size).toBe(1);
    expect([...local.all].join()).not.toContain('Maria');
    expect((await draftsOf(1, fake.signIn(2).browser_key)).get('note', 12)).toBeUndefined();
    expect((await draftsOf(1)).get('note', 12)).toBe('of Maria');
  });

  it('stays in the page if the browser stores nothing, or the key is not known yet', async () => {
    const denied = (): never => { throw new Error('denied'); };
    const drafts = new Drafts(denied);
    await drafts.open(1, fake.signIn(1).browser_key);
    drafts.set('note', 12, 'of Maria');
    await drafts.settled();
    expect(drafts.get('note', 12)).toBe('of Maria');
    const early = await draftsOf(1, '');
    early.set('note', 12, 'of Maria');
    await early.settled();
    expect(local.all.size).toBe(0);
    await early.open(1, fake.signIn(1).browser_key);
    await early.settled();
    expect((await draftsOf(1)).get('note', 12)).toBe('of Maria');
  });

  it('is saved once, a second after the last key, and later under the same note number', async () => {
    const maria = fake.add({ name: 'Maria Huber' });
    const { outbox, drafts } = await page();
    vi.useFakeTimers();
    const keeper = new NoteKeeper(outbox, drafts, { patient: maria.id }, 'note', maria.id);
    for (const text of ['T', 'Ti', 'Tired']) {
      keeper.type(text);
      await vi.advanceTimersByTimeAsync(SAVED_AFTER_MS - 10);
    }
    expect(fake.notes).toHaveLength(0);
    await vi.advanceTimersByTimeAsync(50);
    expect(fake.notes.map(({ text }) => text)).toEqual(['Tired']);
    expect(keeper.state).toBe('saved');
    keeper.type('Tired after 20 min');
    await vi.advanceTimersByTimeAsync(SAVED_AFTER_MS + 50);
    expect(fake.notes.map(({ text }) => text)).toEqual(['Tired after 20 min']);
    expect(await keeper.done()).toBe(true);
    expect([keeper.text, drafts.get('note', maria.id), outbox.waiting]).toEqual(['', undefined, 0]);
  });

  it('survives absent records and a killed tab, and is saved once', async () => {
    const maria = fake.add({ name: 'Maria Huber' });
    const clinic = await page();
    fake.gone = true;
    const keeper = new NoteKeeper(clinic.outbox, clinic.drafts, { patient: maria.id }, 'note', maria.id);
    keeper.type('Asks for more');
    await keeper.save();
    expect([keeper.state, keeper.text, fake.notes.length]).toEqual(['waits', 'Asks for more', 0]);
    keeper.close();
    await clinic.drafts.settled();
    // The tab was killed. Another tab knows nothing until somebody signs in; then the note is sent, although nobody opens its patient.
    session.all.clear();
    fake.gone = false;
    const again = await page(false);
    expect(again.outbox.waiting).toBe(0);
    await again.signedIn(fake.signIn(2));
    await again.outbox.flush();
    expect(fake.notes).toHaveLength(0);
    await again.signedIn(fake.signIn(1));
    expect(new NoteKeeper(again.outbox, again.drafts, { patient: maria.id }, 'note', maria.id).text).toBe('Asks for more');
    await again.outbox.flush();
    await again.outbox.flush();
    expect(fake.notes.map(({ text, patient }) => [text, patient])).toEqual([['Asks for more', maria.id]]);
  });
});

describe('marks and pain values', () => {
  it('wait for absent records, also after a reload', async () => {
    const maria = fake.add({ name: 'Maria Huber' });
    const clinic = await page();
    const visit = fake.open(maria.id, 'right', maria.plan);
    fake.gone = true;
    await clinic.outbox.add(`/api/visits/${visit.id}/notes`, { kind: 'tired', text: '', at_us: 1 });
    // The last answer counts.
    for (const value of [7, 0]) await clinic.outbox.add(`/api/visits/${visit.id}/pain`, { when: 'before', value }, 'pain');
    expect(clinic.silentSince).toBeDefined();
    expect(clinic.outbox.waiting).toBe(2);
    await clinic.drafts.settled();
    fake.gone = false;
    const later = await page(false);
    await vi.waitFor(() => expect(later.outbox.waiting).toBe(0));
    expect(fake.notes.map(({ kind }) => kind)).toEqual(['tired']);
    expect(visit.pain_before).toBe(0);
  });

  it('are not blocked by a note that needs the PIN', async () => {
    const maria = fake.add({ name: 'Maria Huber' });
    const clinic = await page();
    const visit = fake.open(maria.id, 'right', maria.plan);
    await clinic.hide();
    clinic.outbox.keep('note-7', { method: 'PUT', path: '/api/notes/7', body: { patient: maria.id, kind: 'text', text: 'Calls', at_us: 1 } });
    await clinic.outbox.add(`/api/visits/${visit.id}/notes`, { kind: 'spasm', text: '', at_us: 1 });
    expect([fake.notes.map(({ kind }) => kind), clinic.outbox.waiting]).toEqual([['spasm'], 1]);
    await clinic.show('1234');
    await vi.waitFor(() => expect(fake.notes.map(({ text }) => text)).toContain('Calls'));
  });

  it('are reported when the records will never accept them', async () => {
    const drafts = await draftsOf(1);
    const outbox = new Outbox({ send: () => Promise.reject(new RefusalError(404, 'not_found', 'gone')) }, drafts);
    const refused = vi.fn();
    outbox.onRefused = refused;
    await outbox.add('/api/visits/1/notes', { kind: 'next', text: 'Level 2', at_us: 1 });
    expect(outbox.waiting).toBe(0);
    expect(refused.mock.calls[0][0].body.text).toBe('Level 2');
  });

  it('distinguish 0 from "not asked"', () => {
    expect([painWords(0), painWords(null), painWords(undefined), painWords(10)]).toEqual(['0', 'not asked', 'not asked', '10']);
  });
});

describe('curves', () => {
  it('are not drawn from fewer than two points', () => {
    for (const points of [[], [[1, 3]], [[1, 3], [2, NaN]]] as [number, number][][]) expect(curvePoints({ name: 'score', points })).toBeUndefined();
  });

  it('are drawn from the first visit to the last, in order of time', () => {
    const drawn = curvePoints({ name: 'score', points: [[200, 10], [100, 20], [300, 20]] })!;
    expect(drawn.dots.map(([x]) => x)).toEqual([...drawn.dots.map(([x]) => x)].sort((a, b) => a - b));
    expect(drawn.dots[0][1]).toBe(drawn.dots[2][1]);
    expect(drawn.dots[1][1]).toBeGreaterThan(drawn.dots[0][1]);
  });

  it('stay inside their picture if all values are equal, or zero', () => {
    for (const value of [0, 5, -2]) for (const [x, y] of curvePoints({ name: 'score', points: [[1, value], [1, value]] })!.dots) expect([Number.isFinite(x), y >= 0 && y <= 132]).toEqual([true, true]);
  });
});

describe('a visit', () => {
  const visit = (): Visit => {
    const maria = fake.add({ name: 'Maria Huber' });
    const opened = fake.open(maria.id, 'right', maria.plan);
    fake.trial(opened, 0, 60);
    return opened;
  };

  it('draws a threshold with its interval, and says no change while intervals overlap', () => {
    const curve = (name: string, values: readonly number[], exercise = 'tell-apart-firmer') => ({ name, exercise, unit: '%', points: values.map((value, i) => [100 * i, value] as const) });
    const shown = (low: readonly number[], high: readonly number[]) => withIntervals([curve('threshold_percent', [30, 20]), curve('threshold_low_percent', low), curve('threshold_high_percent', high), curve('threshold_low_percent', [1, 1], 'tell-apart-later'), curve('score', [1, 2])]);
    const [threshold, other, score] = shown([24, 12], [40, 25]);
    expect([threshold!.intervals, other!.exercise, other!.intervals, score!.intervals]).toEqual([[[24, 40], [12, 25]], 'tell-apart-later', undefined, undefined]);
    const { dots, bars, low, high } = curvePoints(threshold!)!;
    expect([low <= 12, high >= 40]).toEqual([true, true]);
    bars.forEach((bar, i) => expect([bar![0], bar![1] < dots[i]![1], bar![2] > dots[i]![1]]).toEqual([dots[i]![0], true, true]));
    expect([intervalsOverlap(threshold!), intervalsOverlap(shown([24, 12], [40, 23])[0]!), intervalsOverlap(score!)]).toEqual([true, false, undefined]);
  });

  it('is compared with the last one of the same exercise and level', () => {
    const [before, now] = [visit(), visit()];
    fake.trial(before, 1, 30);
    expect(besideLast(now.trials[0], before).map(({ before: other }) => other?.value)).toEqual([60, 2.4, 30]);
    expect(besideLast({ ...now.trials[0], level: 2 }, before)[0].before).toBeUndefined();
    expect(besideLast(now.trials[0], undefined)[0].before).toBeUndefined();
  });

  it('reports that an incomplete recording was measured in part', () => {
    const [trial] = visit().trials;
    expect(trialWords(trial)).not.toContain(en.patient.partly);
    expect(trialWords({ ...trial, why: 'the recording is not whole' })).toContain(en.patient.partly);
    expect(trialWords({ ...trial, state: 'failed', why: 'no tick' })).toBe('not measured: no tick');
  });

  it('counts active minutes, and stays at its last item', () => {
    expect(timeOf_s(visit(), 'active_s')).toBe(280);
    expect([0, 1, 2, 7].map((item) => itemNow({ ...visit(), item }))).toEqual([0, 1, 1, 1]);
  });

  it('is counted before its minutes are told', () => {
    const measured = visit();
    expect([isCounting(measured), timeWords(measured)]).toEqual([false, '5 min']);
    const counted = { ...measured, trials: [...measured.trials, { ...measured.trials[0], state: 'waiting' as const, active_s: null }] };
    expect([isCounting(counted), timeWords(counted), activeWords(counted)]).toEqual([true, 'counting …', 'counting …']);
  });

  it('tells led time apart from active time', () => {
    const [trial] = visit().trials;
    expect(activeWords({ ...visit(), trials: [{ ...trial, active_s: 60, led_s: 120 }] })).toBe('1 min active, 2 min led');
    expect(activeWords({ ...visit(), trials: [{ ...trial, active_s: 60, led_s: 0 }] })).toBe('1 min active');
    expect(trialWords({ ...trial, active_s: 0, led_s: 120 })).not.toContain(en.patient.notByPerson);
    expect(trialWords({ ...trial, active_s: 0, led_s: 0 })).toContain(en.patient.notByPerson);
  });

  it('tells how a session ended that nobody ended', () => {
    const [trial] = visit().trials;
    expect(trialWords({ ...trial, ended_by: 'stop' })).not.toMatch(/broken|fault/);
    expect(trialWords({ ...trial, ended_by: 'fault' })).toContain(en.patient.endedByFault);
    expect(trialWords({ ...trial, ended_by: 'broken_off', why: 'the session was broken off' })).toContain(en.patient.brokenOff);
  });

  it('without a patient is open until it has ended', () => {
    const opened = { ...visit(), state: 'guest' } as Visit;
    expect([isOpen(opened), isOpen({ ...opened, ended_us: 5 })]).toEqual([true, false]);
  });

  it('is found again by a page that is opened later', async () => {
    const opened = visit();
    expect((await page()).visit?.id).toBe(opened.id);
  });
});

describe('sessions without a patient', () => {
  it('become one visit of a patient together', async () => {
    const maria = fake.add({ name: 'Maria Huber' });
    const { api } = await page();
    fake.sessions = [7, 8].map((id) => ({ id, recording: `${id}.h5`, began_us: 1e15 + id, duration_s: 300, side: 'right', exercise: 'squeeze-to-level', level: 1, active_s: 200, helped_share: 0, results: [], state: 'measured' }));
    await api.send('POST', '/api/sessions/give', { patient: maria.id, sessions: [7, 8] });
    const { visits } = await api.get<Patient>(`/api/patients/${maria.id}`);
    expect(visits.map(({ trials }) => trials.map(({ recording }) => recording))).toEqual([['7.h5', '8.h5']]);
    await expect(api.send('POST', '/api/sessions/give', { patient: maria.id, sessions: [7] })).rejects.toMatchObject({ code: 'changed' });
  });
});

describe('without records', () => {
  it('a new tab knows the gentle limits', async () => {
    await page();
    session.all.clear();
    fake.gone = true;
    const later = await page(false);
    expect([later.stage, later.gentle.effort_limit_hand_tip_n]).toEqual(['absent', 3]);
  });
});

describe('two consoles with one patient', () => {
  it('show both versions to the second one, which may save its own', async () => {
    const maria = fake.add({ name: 'Maria Huber' });
    const { api } = await page();
    const opened = await api.get<Patient>(`/api/patients/${maria.id}`);
    await api.send('PUT', `/api/patients/${maria.id}`, { ...opened, warnings: 'theirs' });
    const refused = await api.send<Patient>('PUT', `/api/patients/${maria.id}`, { ...opened, warnings: 'mine' }).catch((problem: RefusalError) => problem);
    expect(refused).toMatchObject({ status: 409, code: 'changed' });
    const now = (refused as RefusalError).more.now as Patient;
    expect(differing({ ...opened, warnings: 'mine' }, now)).toEqual(['warnings']);
    const saved = await api.send<Patient>('PUT', `/api/patients/${maria.id}`, { ...opened, warnings: 'mine', version: now.version });
    expect(saved.warnings).toBe('mine');
  });

  it('refuse a code of another patient, with the error at its field', async () => {
    fake.add({ name: 'Maria Huber', code: 'P-7' });
    const { api } = await page();
    await expect(api.send('POST', '/api/patients', { name: 'B', code: 'P-7', born: '' })).rejects.toMatchObject({ code: 'code_exists', field: 'code' });
  });
});

describe('records that do not answer', () => {
  it('are reported with the time, the page keeps its data, and they reconnect automatically', async () => {
    const maria = fake.add({ name: 'Maria Huber' });
    const clinic = await page();
    fake.open(maria.id, 'right', maria.plan);
    await clinic.look(fake.fetch);
    fake.gone = true;
    await clinic.look(fake.fetch);
    expect([clinic.stage, clinic.silentSince instanceof Date, clinic.visit?.patient]).toEqual(['in', true, maria.id]);
    fake.gone = false;
    await clinic.look(fake.fetch);
    expect([clinic.silentSince, clinic.cameBack]).toEqual([undefined, true]);
  });

  it('need the pass phrase after a restart; the visit stays', async () => {
    const maria = fake.add({ name: 'Maria Huber' });
    fake.open(maria.id, 'right', maria.plan);
    const clinic = await page();
    fake.clinic = 'locked';
    await clinic.look(fake.fetch);
    expect([clinic.stage, clinic.visit !== null, clinic.visitPatient]).toEqual(['locked', true, null]);
    // Marks are kept under the same account meanwhile.
    await clinic.outbox.add(`/api/visits/${clinic.visit!.id}/notes`, { kind: 'spasm', text: '', at_us: 1 });
    expect(clinic.outbox.waiting).toBe(1);
    await clinic.api.send('POST', '/api/unlock', { recovery_code: fake.code });
    await clinic.signedIn(await clinic.api.send('POST', '/api/sign_in', { account: 1, pin: '1234' }));
    await vi.waitFor(() => expect(fake.notes.map(({ kind }) => kind)).toEqual(['spasm']));
  });
});

describe('addresses', () => {
  it.each<Route>([{ at: 'patients' }, { at: 'new' }, { at: 'settings' }, { at: 'alone' }, { at: 'patient', patient: 7 }, { at: 'edit', patient: 7 }, { at: 'progress', patient: 7 }, { at: 'summary', patient: 7, visit: 9 }, { at: 'visit', visit: 9 }, { at: 'end', visit: 9 }])('contain numbers only: $at', (route) => {
    expect(routeOf(hashOf(route))).toEqual(route);
    expect(hashOf(route)).toMatch(/^#\/[a-z]+(\/\d+)?(\/[a-z]+)?(\/\d+)?$/);
  });

  it('without a known screen lead to the list', () => {
    for (const hash of ['', '#', '#/patient/Maria', '#/patient/0', '#/visit/-1', '#/patient/1e3', '#/<b>']) expect(routeOf(hash)).toEqual({ at: 'patients' });
  });
});

describe('texts', () => {
  const flat = (of: unknown, path = ''): [string, string][] => (typeof of === 'string' ? [[path, of]] : Object.entries(of as object).flatMap(([key, value]) => flat(value, `${path}.${key}`)));
  const places = (words: string): string[] => (words.match(/\{\w+\}/g) ?? []).sort();

  it.each([['fr', fr], ['de', de]] as const)('in %s have the keys and placeholders of English', (_name, other) => {
    const there = new Map(flat(other));
    expect([...there.keys()].sort()).toEqual(flat(en).map(([key]) => key).sort());
    for (const [key, words] of flat(en)) expect(places(there.get(key)!), key).toEqual(places(words));
  });

  it('name every result like the panel of its exercise', () => {
    const folder = new URL('../../config/exercises/', import.meta.url);
    const results = readdirSync(folder).flatMap((file) => readFileSync(new URL(file, folder), 'utf8').split('[[panel.values]]').slice(1)).filter((value) => /^result = true/m.test(value.split(/^\[/m)[0]));
    expect(results.length).toBeGreaterThan(3);
    for (const value of results) {
      const [, name] = /^name = "([\w/]+)"/m.exec(value)!;
      if (name.startsWith('own/')) { // an end of own movement is named by its axis
        expect(resultName(name)).toMatch(/^[A-Z]?[\w, ]+, (from|to)$/);
        continue;
      }
      for (const [language, texts] of Object.entries({ en, fr, de })) expect(texts.results[name], name).toBe(new RegExp(`${language} = "([^"]*)"`).exec(value)![1]);
    }
  });

  it('cover every code of a refusal', () => {
    const codes = ['locked', 'not_signed_in', 'hidden', 'wrong_pin', 'too_many_tries', 'wrong_phrase', 'not_found', 'code_exists', 'changed', 'visit_open', 'station', 'station_silent', 'no_recording', 'database', 'busy', 'own_account', 'backup', 'damaged'];
    for (const texts of [en, fr, de]) expect(Object.keys(texts.refusals).sort()).toEqual([...codes].sort());
  });
});

describe('the seams of a visit', () => {
  it('the time of an exercise is not shown as that of the next one', () => {
    const live = new LiveTime(), first = new Date(1000);
    expect([live.of(first, 0), live.of(first, 0)]).toEqual([true, true]);
    expect(live.of(first, 1), 'item 2 is set up, item 1 is still being measured').toBe(false);
    expect(live.of(new Date(2000), 1), 'item 2 is started').toBe(true);
  });


  const note = (id: number, visit: number, kind: string, text: string, at_us = id): Note => ({ id, visit, kind, text, at_us, account: 1 });
  const visit = (id: number, began_us: number, notes: Note[], state: Visit['state'] = 'done'): Visit => ({ id, began_us, notes, state, patient: 1, side: 'right', ended_us: began_us + 1, offset_min: 0, account: 1, plan: [], item: 0, trials: [], pain_before: null, pain_after: null });

  it('what comes next, as written in the last visit, stands in Today, and every note with words in the list', () => {
    const patient = { visits: [visit(7, 100, [note(1, 7, 'next', 'Level 2'), note(2, 7, 'tired', '')]), visit(8, 200, [note(3, 8, 'next', 'Left hand too'), note(4, 8, 'text', 'Good mood')]), visit(9, 300, [], 'no_show')], notes: [note(5, 0, 'text', 'From home')] };
    expect(nextWish(patient)?.text).toBe('Left hand too');
    expect(nextWish({ ...patient, visits: [patient.visits[1]!, visit(10, 400, [])] })).toBeUndefined();
    expect(allNotes(patient).map(({ text }) => text)).toEqual(['From home', 'Good mood', 'Left hand too', 'Level 2']);
  });

  it('a page whose records answer at another port is loaded again', async () => {
    const clinic = await page();
    expect(clinic.moved).toBe(false);
    fake.gone = true;
    await clinic.look(fake.fetch);
    await clinic.look(async (url, init) => (url === '/api/clinic' ? new Response('{"port":10}') : fake.fetch(url, init)));
    expect(clinic.moved).toBe(true);
  });

  it('a half-typed note goes on in the field after names were hidden', async () => {
    const clinic = await page();
    const keeper = (): NoteKeeper => new NoteKeeper(clinic.outbox, clinic.drafts, { patient: 1 }, 'note', 1, () => now_ms);
    const first = keeper();
    first.type('Half a no');
    await first.save();
    first.close();
    expect(keeper().text).toBe('Half a no');
    now_ms += 31 * 60_000;
    expect(keeper().text).toBe('');
  });
});
