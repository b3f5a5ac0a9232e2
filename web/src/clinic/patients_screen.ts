import { columns, h } from '../console/dom';
import { replayUrl } from '../console/recordings';
import { tokenOf } from '../net/open_connection';
import { Changes } from '../shared/changes';
import { duration } from '../shared/format';
import { fill } from '../shared/i18n';
import { gentleVisit } from './gentle_visit';
import { texts } from './i18n';
import type { ClinicContext } from './clinic_context';
import { pickPatient } from './picker';
import type { LooseSession, Patient, PatientList, PatientRow, Restored, Visit } from './records';
import { hashOf } from './routes';
import { action, button, problemWords, StatusMessage, textInput, twice, type Screen } from './ui';
import { itemNow } from './records';
import { clock, clockOf, dayOf, itemWords, locale, sideWords, timeWords, visitClock, visitDay } from './words';

/** The list is requested again this often [ms]. */
const EVERY_MS = 15_000;

/** Patients on a page of the list. */
const PAGE = 50;

/** Open and unfinished visits first, then all patients, with a search by name or code. */
export class PatientsScreen implements Screen {
  readonly element = h('main', { class: 'patients' });
  private readonly t = texts().patients;
  private readonly find = textInput('find', '', { type: 'search', 'aria-label': this.t.find, placeholder: this.t.find });
  private readonly cards = h('div', { class: 'cards' });
  private readonly rows = h('div', { class: 'rows' });
  private readonly message = new StatusMessage();
  private readonly count = h('span', { class: 'aside', role: 'status' });
  private readonly extra = h('div', { class: 'extra' });
  private readonly timer: ReturnType<typeof setInterval>;
  private typing: ReturnType<typeof setTimeout> | undefined;
  private readonly notices = h('div', { class: 'extra' });
  private readonly loose = h('div', { class: 'extra' });
  private readonly chosen = new Set<number>();
  private list: PatientList | undefined;
  private listed: Date | undefined;
  private failedSince: Date | undefined;
  private page = 0;
  private readonly listChanges = new Changes();
  private readonly looseChanges = new Changes();
  private closed = false;

  constructor(private readonly context: ClinicContext) {
    const { t } = this;
    this.find.addEventListener('input', () => { clearTimeout(this.typing); this.page = 0; this.typing = setTimeout(() => void this.read(), 150); });
    const fresh = h('a', { class: 'b go', href: hashOf({ at: 'new' }), 'data-testid': 'new-patient' }, t.fresh);
    this.element.append(this.notices, this.cards, this.extra, this.loose, h('section', { class: 'panel list', 'aria-label': t.title },
      h('div', { class: 'tools' }, this.find, fresh, this.count, button(t.without, 'without-patient', () => this.askSide())), this.message.element, this.rows));
    this.timer = setInterval(() => { if (!document.hidden && !this.context.clinic.silentSince) void this.read(); }, EVERY_MS);
    const seen = context.clinic.seen.get('/api/patients');
    if (seen) {
      this.list = seen.value as PatientList;
      this.listed = seen.at;
      this.show();
    }
    void this.read();
  }

  who(): readonly [string, string] {
    return [texts().patients.title, new Date().toLocaleDateString(locale(), { weekday: 'long', day: 'numeric', month: 'long' })];
  }

  private turn(page: number): void {
    this.page = page;
    void this.read();
  }

  refresh(): void {
    // The list is read at once when the records answer again.
    if (this.failedSince && !this.context.clinic.silentSince) void this.read();
  }

  close(): void {
    this.closed = true;
    clearInterval(this.timer);
    clearTimeout(this.typing);
  }

  private async read(): Promise<void> {
    const find = this.find.value.trim(), { page } = this;
    const query = [...(find === '' ? [] : [`find=${encodeURIComponent(find)}`]), ...(page === 0 ? [] : [`page=${page}`])].join('&');
    try {
      const list = await this.context.clinic.read<PatientList>(`/api/patients${query === '' ? '' : `?${query}`}`);
      if (this.closed || find !== this.find.value.trim() || page !== this.page) return;
      this.list = list;
      this.listed = new Date();
      this.failedSince = undefined;
      this.message.show('');
      this.show();
      this.showLoose(await this.context.clinic.api.get('/api/sessions'));
    } catch (problem) {
      if (this.closed) return;
      this.failedSince ??= new Date();
      this.message.show([problemWords(problem), fill(this.t.failed, { at: clock(this.failedSince) }), this.listed ? fill(this.t.asOf, { at: clock(this.listed) }) : ''].join(' '));
    }
  }

  private show(): void {
    const { list, t } = this;
    if (!list || !this.listChanges.of(list)) return;
    this.notices.replaceChildren(...(list.under_way ?? []).map(({ what, problem }) => h('p', { class: problem === '' ? 'aside' : 'warning', role: 'status', 'data-testid': 'under-way' }, [t.underWay[what], problem].filter(Boolean).join(' '))),
      ...(list.damaged?.length ? [h('p', { class: 'warning', 'data-testid': 'damaged' }, fill(t.damaged, { rows: list.damaged.join(', ') }))] : []),
      ...(list.lost ? [this.toConfirm(fill(t.lost, { n: list.lost }), '/api/lost/done', 'lost')] : []),
      ...(list.clock_jumped_us ? [this.toConfirm(fill(t.clockJumped, { day: dayOf(list.clock_jumped_us), at: clockOf(list.clock_jumped_us) }), '/api/clock/done', 'clock-jumped')] : []),
      ...(list.restored ? [this.restored(list.restored)] : []));
    this.cards.replaceChildren(...list.open.map((row) => this.card(row)), ...(list.guests ?? []).map((visit) => this.unassigned(visit)));
    const searched = this.find.value.trim() !== '';
    const found = list.count ?? list.patients.length, page = list.page ?? 0;
    const empty = found === 0 && !searched;
    this.element.classList.toggle('none-yet', empty);
    this.count.textContent = empty ? '' : fill(found === 1 ? t.countOne : t.count, { n: found });
    if (empty) this.rows.replaceChildren(h('div', { class: 'empty', 'data-testid': 'empty' }, h('p', {}, t.empty), h('a', { class: 'b go large', href: hashOf({ at: 'new' }), 'data-testid': 'first-patient' }, t.fresh)));
    else if (list.patients.length === 0) this.rows.replaceChildren(h('p', { class: 'none', 'data-testid': 'nobody' }, fill(t.nobody, { find: this.find.value.trim() })));
    else this.rows.replaceChildren(h('table', { class: 'table' }, columns([t.name, t.code, t.hand, t.last, t.visits]),
      h('tbody', {}, ...list.patients.map((row) => this.row(row)))),
    h('div', { class: 'pair' }, page > 0 ? button(t.before, 'page-before', () => this.turn(page - 1)) : null, (page + 1) * PAGE < found ? button(t.further, 'page-further', () => this.turn(page + 1)) : null));
  }

  /** A button that sends a change, after which the list is read again. */
  private change(words: string, test: string, message: StatusMessage, path: string, body = {}): HTMLButtonElement {
    return action(words, test, message, async () => {
      await this.context.clinic.api.send('POST', path, body);
      await this.read();
    });
  }

  /** Something that waits for a yes. */
  private toConfirm(words: string, path: string, test: string): HTMLElement {
    const message = new StatusMessage();
    return h('div', { class: 'warning', 'data-testid': test }, h('p', {}, words), message.element, this.change(this.t.restored.done, `${test}-done`, message, path));
  }

  /** What a restore left to people. */
  private restored({ at_us, until_us, again }: Restored): HTMLElement {
    const words = this.t.restored, message = new StatusMessage();
    const done = this.change(words.done, 'restored-done', message, '/api/restored/done');
    const line = ({ what, to, from = '', began_us }: Restored['again'][number]): string => fill(words[what], { to, from, day: began_us === undefined ? '' : dayOf(began_us) });
    return h('section', { class: 'panel', 'aria-label': words.title, 'data-testid': 'restored' }, h('div', { class: 'hd' }, h('h2', {}, words.title), h('span', { class: 'sp' }), done),
      until_us < at_us ? h('p', {}, fill(words.until, { day: dayOf(until_us), at: clockOf(until_us) })) : null,
      again.length > 0 ? h('p', {}, words.again) : null, message.element, h('ul', {}, ...again.map((entry) => h('li', {}, line(entry)))));
  }

  private row(row: PatientRow): HTMLElement {
    const { t } = this;
    const line = h('tr', {}, h('th', { scope: 'row' }, h('a', { href: hashOf({ at: 'patient', patient: row.id }), 'data-testid': `patient-${row.id}` }, row.name)),
      h('td', { class: 'num', 'data-name': t.code }, row.code), h('td', { 'data-name': t.hand }, sideWords(row.side)), h('td', { 'data-name': t.last }, row.last_visit_us > 0 ? dayOf(row.last_visit_us) : t.never), h('td', { class: 'num', 'data-name': t.visits }, String(row.visits)));
    // The whole line reacts to a pointer; the keyboard uses its link.
    line.addEventListener('click', (event) => { if (!(event.target instanceof HTMLAnchorElement)) this.context.go({ at: 'patient', patient: row.id }); });
    return line;
  }

  private card(row: PatientRow): HTMLElement {
    const { t } = this, { context } = this;
    const open = row.state === 'open';
    const message = new StatusMessage();
    const go = action(t.goOn, `go-on-${row.id}`, message, () => (open ? context.go({ at: 'visit', visit: row.visit }) : this.goOn(row)), 'go');
    const end = this.change(t.endIt, `end-it-${row.id}`, message, `/api/visits/${row.visit}/finish`, { state: 'done' });
    return h('article', { class: 'panel card' }, h('p', {}, h('span', { class: open ? 'tag on' : 'tag warn' }, open ? t.open : t.unfinished)),
      h('h2', {}, h('a', { href: hashOf({ at: 'patient', patient: row.id }) }, row.name)), h('p', { class: 'aside' }, [row.code, sideWords(row.side), row.last_visit_us > 0 ? dayOf(row.last_visit_us) : ''].filter(Boolean).join(' · ')),
      message.element, h('div', { class: 'pair' }, go, open ? null : end));
  }

  /** Continues an unfinished visit. */
  private async goOn(row: PatientRow): Promise<void> {
    const { clinic } = this.context;
    const patient = await clinic.api.get<Patient>(`/api/patients/${row.id}`);
    const visit = patient.visits.find(({ id }) => id === row.visit);
    clinic.take(await clinic.api.send<Visit>('POST', `/api/visits/${row.visit}/item`, { item: visit ? itemNow(visit) : 0 }), row);
    this.context.go({ at: 'visit', visit: row.visit });
  }

  /** Recordings without a patient, to be assigned or deleted. */
  private showLoose({ sessions, more }: { readonly sessions: readonly LooseSession[]; readonly more: number }): void {
    const { t, context, chosen } = this, words = t.sessions, token = tokenOf(location), { api } = context.clinic;
    if (!this.looseChanges.of(sessions, more)) return;
    for (const id of chosen) if (!sessions.some((session) => session.id === id)) chosen.delete(id);
    if (sessions.length === 0) return this.loose.replaceChildren();
    const message = new StatusMessage();
    const give = button(words.give, 'give-sessions', () => this.pick(words.whose, (patient) => api.send('POST', '/api/sessions/give', { patient, sessions: [...chosen] })), 'go');
    const away = twice(t.remove, t.removeYes, 'delete-sessions', message, async () => {
      for (const id of chosen) await api.send('DELETE', `/api/sessions/${id}`);
    }, () => void this.read());
    const count = (): void => {
      // A session that cannot be assigned, for example one of another clinic, can still be deleted.
      give.disabled = chosen.size === 0 || sessions.some(({ id, state }) => chosen.has(id) && state !== 'measured');
      away.disabled = chosen.size === 0;
    };
    const rows = sessions.map((session) => {
      const at = { day: dayOf(session.began_us), at: clockOf(session.began_us) };
      const box = h('input', { type: 'checkbox', checked: chosen.has(session.id), 'aria-label': fill(words.choose, at), 'data-testid': `session-${session.id}` });
      box.addEventListener('change', () => {
        if (box.checked) chosen.add(session.id);
        else chosen.delete(session.id);
        count();
      });
      return h('li', {}, h('label', { class: 'tick' }, box, h('span', {}, `${at.day}, ${at.at} · ${itemWords(session)}`, h('small', {}, [duration(session.duration_s), sideWords(session.side), session.why ?? ''].filter(Boolean).join(' · ')))),
        h('a', { href: replayUrl([session.recording], token), target: '_blank', rel: 'noopener', 'aria-label': `${texts().patient.replay}: ${at.day}, ${at.at}` }, texts().patient.replay));
    });
    count();
    this.loose.replaceChildren(h('section', { class: 'panel loose', 'aria-label': words.title, 'data-testid': 'loose-sessions' }, h('div', { class: 'hd' }, h('h2', {}, words.title), h('span', { class: 'sp' }), give, away),
      h('p', {}, words.words), message.element, h('ul', {}, ...rows), more > 0 ? h('p', { class: 'aside' }, fill(words.more, { n: more })) : null));
  }

  private pick(title: string, act: (patient: number) => Promise<unknown>): void {
    pickPatient(this.extra, this.context, { title, ask: this.t.giveYes }, ({ id }) => act(id), () => this.read());
  }

  /** A visit without a patient, to be assigned or deleted. */
  private unassigned(visit: Visit): HTMLElement {
    const { t } = this, { api } = this.context.clinic;
    const message = new StatusMessage();
    const give = button(t.give, `give-${visit.id}`, () => this.pick(t.giveTo, (patient) => api.send('POST', `/api/visits/${visit.id}/move`, { patient })), 'go');
    const away = twice(t.remove, t.removeYes, `delete-${visit.id}`, message, () => api.send('DELETE', `/api/visits/${visit.id}`), () => void this.read());
    return h('article', { class: 'panel card' }, h('p', {}, h('span', { class: 'tag warn' }, t.noPatient)), h('h2', {}, `${visitDay(visit)}, ${visitClock(visit)}`),
      h('p', { class: 'aside' }, `${sideWords(visit.side)} · ${timeWords(visit)}`), message.element, h('div', { class: 'pair' }, give, away));
  }

  /** A visit without a patient has the gentle limits; the page says so before it begins. */
  askSide(): void {
    const { t } = this;
    this.extra.replaceChildren(h('section', { class: 'panel', 'aria-label': t.without }, h('div', { class: 'hd' }, h('h2', {}, t.without), h('span', { class: 'sp' }), button(texts().picker.cancel, 'without-cancel', () => this.extra.replaceChildren())),
      h('p', {}, t.withoutMore), gentleVisit(this.context)));
  }
}
