import { fact, h } from '../console/dom';
import { replayUrl, reportUrl } from '../console/recordings';
import { tokenOf } from '../net/open_connection';
import { fill } from '../shared/i18n';
import { RefusalError } from './api';
import { TodayPanel } from './begin';
import { curveFigure, withIntervals } from './curves';
import { gentleOffer } from './gentle_visit';
import { texts } from './i18n';
import { accountName, NoteBox, noteList } from './notes';
import type { ClinicContext } from './clinic_context';
import { painWords } from './pain';
import { pickPatient } from './picker';
import { allNotes, newestFirst, tookPlace, type OneSide, type Patient, type PatientRow, type Size, type Trial, type Visit } from './records';
import { hashOf } from './routes';
import { saveText } from './save_text';
import { action, besideTitle, button, Field, link, panel, problemWords, StatusMessage, textInput, twice, type Screen } from './ui';
import { activeWords, clock, bornWords, itemWords, parameterWords, presetName, sideWords, trialWords, visitClock, visitDay } from './words';

/** Number of visits that are listed at first. */
const NEWEST = 12;
/** Number of notes that are shown at first. */
const FIRST_NOTES = 3;
/** Results that are still being measured are requested again after this [ms]. */
const MEASURED_MS = 4000;

/** One patient: curves over the visits, the list of visits, today's plan, personal data, notes. */
export class PatientScreen implements Screen {
  readonly element = h('main', { class: 'patient' });
  private readonly t = texts().patient;
  private patient: Patient | undefined;
  private today: TodayPanel | undefined;
  private notes: NoteBox | undefined;
  private readonly message = new StatusMessage();
  private readonly extra = h('div', { class: 'extra' });
  private readonly listed = h('div', {});
  private failedSince: Date | undefined;
  private all = false;
  private allNotes = false;
  private closed = false;
  private reading: Promise<void> | undefined;
  private timer: ReturnType<typeof setTimeout> | undefined;

  constructor(private readonly context: ClinicContext, private readonly id: number) {
    this.element.append(h('section', { class: 'panel narrow' }, this.message.element, h('p', { class: 'none' }, this.t.reading)));
    void this.read();
  }

  who(): readonly [string, string] { return [this.patient?.name ?? this.t.patient, this.patient ? `${this.patient.code} · ${sideWords(this.patient.side)}` : '']; }
  what(): readonly [string, string] {
    const { patient, t } = this;
    if (!patient) return ['', ''];
    const done = newestFirst(patient.visits).filter(tookPlace);
    return [fill(done.length === 1 ? t.oneVisit : t.visitCount, { n: done.length }), done[0] ? fill(t.lastOn, { day: visitDay(done[0]) }) : t.noVisit];
  }

  refresh(): void {
    this.today?.refresh();
    if (this.failedSince && !this.context.clinic.silentSince) void this.read();
  }

  close(): void {
    this.closed = true;
    clearTimeout(this.timer);
    this.notes?.close();
  }

  private read(): Promise<void> {
    this.reading ??= this.readNow().finally(() => { this.reading = undefined; });
    return this.reading;
  }

  private async readNow(): Promise<void> {
    const { clinic } = this.context;
    try {
      if (!clinic.presets) clinic.takePresets(await clinic.api.get('/api/presets'));
      const patient = await clinic.read<Patient>(`/api/patients/${this.id}`);
      if (this.closed) return;
      const first = this.patient === undefined;
      this.patient = patient;
      this.failedSince = undefined;
      this.message.show('');
      if (first) this.build(patient);
      else this.showLists(patient);
      clearTimeout(this.timer);
      if (patient.visits.some(({ trials }) => trials.some(({ state }) => state === 'waiting'))) this.timer = setTimeout(() => void this.read(), MEASURED_MS);
    } catch (problem) {
      if (this.closed) return;
      if (problem instanceof RefusalError && problem.code === 'damaged') return this.element.replaceChildren(h('section', { class: 'panel narrow' }, h('p', { class: 'said', role: 'alert' }, problemWords(problem)), link(this.t.signAgain, { at: 'edit', patient: this.id }, 'sign-again'), gentleOffer(this.context)));
      this.failedSince ??= new Date();
      const seen = clinic.seen.get(`/api/patients/${this.id}`);
      if (!this.patient && seen) this.build(this.patient = seen.value as Patient);
      this.message.show([problemWords(problem), fill(this.t.failed, { at: clock(this.failedSince) }), seen ? fill(this.t.asOf, { at: clock(seen.at) }) : ''].filter(Boolean).join(' '));
    }
  }

  private build(patient: Patient): void {
    const { context, t } = this;
    this.today = new TodayPanel(context, patient);
    this.notes = new NoteBox(context, { patient: patient.id }, 'note', patient.id, () => void this.read());
    const progress = h('div', { class: 'lists' }, this.progressPanel(patient), this.visitsPanel(patient));
    this.listed.className = 'listed';
    this.element.replaceChildren(h('div', { class: 'col' }, this.extra, progress), h('div', { class: 'col side' }, this.message.element, this.today.element, panel(t.notes, 'notes-panel', this.notes.element, this.listed), this.personPanel(patient)));
    this.showLists(patient);
  }

  private showLists(patient: Patient): void {
    const notes = allNotes(patient).filter(({ id }) => id !== this.notes?.writing), first = this.allNotes ? notes : notes.slice(0, FIRST_NOTES);
    this.listed.replaceChildren(noteList(first, accountName(this.context)), notes.length > first.length ? button(fill(this.t.all, { n: notes.length }), 'all-notes', () => { this.allNotes = true; this.showLists(patient); }, 'wide') : '');
    this.element.querySelector('.lists')?.replaceChildren(this.progressPanel(patient), this.visitsPanel(patient));
  }

  private progressPanel({ curves, visits }: Patient): HTMLElement {
    const { t } = this;
    const first = newestFirst(visits).filter(tookPlace).at(-1);
    return besideTitle(panel(first ? fill(t.progressSince, { day: visitDay(first) }) : t.progress, 'progress',
      first ? h('div', { class: 'curves' }, ...(curves.some(({ points }) => points.length > 1) ? [] : [h('p', { class: 'none' }, texts().curves.one)]), ...withIntervals(curves).map(curveFigure)) : h('p', { class: 'none' }, t.noProgress)), h('span', { class: 'aside' }, first ? t.noClaim : ''));
  }

  private visitsPanel(patient: Patient): HTMLElement {
    const { t } = this;
    const visits = newestFirst(patient.visits);
    const shown = this.all ? visits : visits.slice(0, NEWEST);
    const csv = action(t.csv, 'csv', this.message, () => saveText(this.context, `/api/export/patient/${patient.id}.csv`, `patient-${patient.id}.csv`));
    const more = visits.length > NEWEST ? button(this.all ? t.newest : fill(t.all, { n: visits.length }), 'all-visits', () => { this.all = !this.all; this.showLists(patient); }) : null;
    return besideTitle(panel(t.visits, 'visits', visits.length === 0 ? h('p', { class: 'none' }, t.noVisits) : h('ul', { class: 'visit-list', 'data-testid': 'visits' }, ...shown.map((visit, i) => this.visitRow(visit, visits.slice(i + 1)))), more),
      h('span', { class: 'sp' }), visits.length > 0 ? h('a', { class: 'b', href: hashOf({ at: 'progress', patient: patient.id }), 'data-testid': 'print-progress' }, t.print) : null, visits.length > 0 ? csv : null);
  }

  private visitRow(visit: Visit, earlier: readonly Visit[]): HTMLElement {
    const { t } = this;
    const when = h('div', { class: 'when' }, h('b', {}, visitDay(visit)), h('small', {}, visit.state === 'no_show' ? '' : visitClock(visit)));
    if (visit.state === 'damaged') return h('li', { 'data-visit': visit.id }, h('span', { class: 'tag warn' }, fill(t.damagedVisit, { visit: visit.id })));
    if (visit.state === 'no_show') return h('li', { 'data-visit': visit.id }, when, h('span', { class: 'tag' }, t.noShow));
    const pain = visit.pain_before === null && visit.pain_after === null ? '' : fill(t.painWords, { before: painWords(visit.pain_before), after: painWords(visit.pain_after) });
    const tag = visit.state === 'unfinished' ? t.unfinished : visit.state === 'open' ? t.open : '';
    const links = h('span', { class: 'links' }, h('a', { href: hashOf({ at: 'summary', patient: this.id, visit: visit.id }) }, t.look), visit.state === 'open' ? null : button(t.move, `move-${visit.id}`, () => this.move(visit)));
    return h('li', { 'data-visit': visit.id }, when, h('div', { class: 'did' },
      h('div', { class: 'first' }, h('span', {}, h('b', {}, activeWords(visit)), ` · ${[sideWords(visit.side), pain].filter(Boolean).join(' · ')} `, tag ? h('span', { class: 'tag warn' }, tag) : null), links),
      ...(visit.trials.length === 0 ? [h('small', {}, t.nothingDone)] : visit.trials.map((trial) => this.trialRow(trial, earlier)))));
  }

  /** The results of a trial with links to its replay and report, beside the last trial of the same exercise. */
  private trialRow(trial: Trial, earlier: readonly Visit[]): HTMLElement {
    const { t } = this, token = tokenOf(location), name = itemWords(trial);
    const link = (href: string, words: string, spoken: string): HTMLElement => h('a', { href, target: '_blank', rel: 'noopener', 'aria-label': `${words}: ${spoken}` }, words);
    const before = earlier.flatMap(({ trials }) => trials).find((other) => other.exercise === trial.exercise && other.recording !== '');
    return h('div', { class: 'trial' }, h('span', {}, name, h('small', {}, trialWords(trial))), trial.recording === '' ? h('span', { class: 'aside' }, t.noRecording) : h('span', { class: 'links' },
      link(replayUrl([trial.recording], token), t.replay, name), link(reportUrl(trial.recording, token), t.report, name), before ? link(replayUrl([trial.recording, before.recording], token), t.compare, name) : null));
  }

  private personPanel(patient: Patient): HTMLElement {
    const { t, context } = this;
    const force = context.clinic.presets?.force.find(({ id }) => id === patient.preset);
    const facts: (readonly [string, string])[] = [
      ...(patient.born === '' ? [] : [[t.born, bornWords(patient.born)] as const]), ...(patient.number === '' ? [] : [[t.number, patient.number] as const]),
      ...(Object.entries(patient.hands) as [OneSide, Size][]).map(([side, size]) => [fill(t.hand, { side: sideWords(side) }), `${Math.round(size.length_m * 1000)} × ${Math.round(size.breadth_m * 1000)} mm${size.limits?.length ? ` · ${fill(t.limitCount, { n: size.limits.length })}` : ''}`] as const),
      [t.preset, presetName(patient.preset)], ...Object.entries({ ...force?.parameters, ...patient.parameters }).map(([name, value]) => parameterWords(name, value)),
    ];
    return besideTitle(panel(t.person, 'person', h('dl', { class: 'facts' }, ...facts.map(([name, value]) => fact(name, value))), this.mistakes(patient)),
    h('span', { class: 'sp' }), link(texts().limits.title, { at: 'limits', patient: patient.id }, 'limits'), link(t.edit, { at: 'edit', patient: patient.id }, 'edit-patient'));
  }

  /** Rarely needed corrections, each confirmed by a second press. */
  private mistakes(patient: Patient): HTMLElement {
    const { t, context } = this, { api } = context.clinic;
    const message = new StatusMessage();
    const code = new Field(fill(t.erase.code, { code: patient.code }), textInput('erase-code'));
    const erase = action(t.erase.press, 'erase-yes', message, async () => {
      if (code.input.value.trim() !== patient.code) return code.refuse(t.erase.wrong);
      await api.send('POST', `/api/patients/${patient.id}/erase`, { code: patient.code });
      context.showMessage(t.erase.done);
      context.go({ at: 'patients' });
    }, 'danger');
    return h('details', { class: 'mistakes' }, h('summary', {}, t.more), message.element, h('div', { class: 'pair' },
      twice(t.noShowNote, t.noShowYes, 'no-show', message, () => api.send('POST', `/api/patients/${patient.id}/no_show`, { at_us: Date.now() * 1000 }), () => void this.read()),
      button(t.merge.title, 'merge', () => this.merge(patient)),
      patient.visits.length === 0 ? twice(t.remove, fill(t.removeYes, { name: patient.name }), 'delete-patient', message, () => api.send('DELETE', `/api/patients/${patient.id}`), () => context.go({ at: 'patients' })) : null),
    h('details', {}, h('summary', {}, t.erase.title), h('p', {}, t.erase.words), code.element, erase));
  }

  private pick(title: string, ask: string, act: (other: PatientRow) => Promise<unknown>): void {
    pickPatient(this.extra, this.context, { title, ask, not: this.id }, act, () => { if (!this.closed) return this.read(); });
  }

  private move(visit: Visit): void {
    this.pick(fill(this.t.moveTitle, { day: visitDay(visit), at: visitClock(visit) }), this.t.moveYes, async (row) => {
      await this.context.clinic.api.send('POST', `/api/visits/${visit.id}/move`, { patient: row.id });
      this.context.showMessage(fill(this.t.moved, { name: row.name, code: row.code }));
      this.context.go({ at: 'patient', patient: row.id });
    });
  }

  private merge(patient: Patient): void {
    this.pick(fill(this.t.merge.which, { name: patient.name, code: patient.code }), this.t.merge.yes, async (row) => {
      await this.context.clinic.api.send('POST', `/api/patients/${patient.id}/merge`, { from: row.id });
      this.context.showMessage(fill(this.t.merge.done, { name: row.name, code: row.code }));
    });
  }
}

