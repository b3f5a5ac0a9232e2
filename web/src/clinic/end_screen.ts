import { columns, h } from '../console/dom';
import { Changes } from '../shared/changes';
import { fill } from '../shared/i18n';
import { texts } from './i18n';
import { NoteBox } from './notes';
import type { ClinicContext } from './clinic_context';
import { activeOf_s, isCounting, newestFirst, timeOf_s, tookPlace, type Patient, type Result, type Trial, type Visit } from './records';
import { hashOf } from './routes';
import { action, button, link, panel, StatusMessage, textInput, Field, type Screen } from './ui';
import { painChoice } from './visit_screen';
import { proposals, toggled } from './wishes';
import { clock, itemWords, minutes, number, resultName, resultWords, sideWords, timeWords, visitDay } from './words';

const EVERY_MS = 2500;

/** Results of the exercise's panel, then the person's reaches and the share of help, where they were measured. */
export function measured(trial: Trial): readonly Result[] {
  const more: readonly (readonly [name: string, value: number | null | undefined, unit: string])[] = [['reach_s', trial.reach_s, 's'], ['peak_speed_m_s', trial.peak_speed_m_s, 'm/s'], ['path_ratio', trial.path_ratio, '×'],
    ['helped_share', trial.helped_share === null ? null : 100 * trial.helped_share, '%']];
  return [...trial.results, ...more.flatMap(([name, value, unit]) => (typeof value === 'number' ? [{ name, value, unit }] : []))];
}

/** Each result beside that of the last visit with the same exercise and level, if there is one. They are not judged. */
export function besideLast(trial: Trial, last: Visit | undefined): readonly { readonly result: Result; readonly before: Result | undefined }[] {
  const other = [...(last?.trials ?? [])].reverse().find(({ exercise, level, state }) => exercise === trial.exercise && level === trial.level && state === 'measured');
  const before = other ? measured(other) : [];
  return measured(trial).map((result) => ({ result, before: before.find(({ name, unit }) => name === result.name && unit === result.unit) }));
}

/** The end of a visit: done against planned, results beside those of the last visit, the next appointment; then a card for the patient. */
export class EndScreen implements Screen {
  readonly element = h('main', { class: 'end' });
  private readonly t = texts().end;
  private readonly done = h('div', {});
  private readonly message = new StatusMessage();
  private patient: Patient | undefined;
  private note: NoteBox | undefined;
  private readonly changes = new Changes();
  private finished: Visit | undefined;
  private closed = false;
  private readonly timer: ReturnType<typeof setInterval>;

  constructor(private readonly context: ClinicContext, private readonly id: number) {
    this.timer = setInterval(() => { if (!this.finished && !context.clinic.silentSince) void context.clinic.lookAtVisit().then(() => this.show()).catch(() => {}); else this.lookAgain(); }, EVERY_MS);
    void this.open();
  }

  who(): readonly [string, string] {
    const { visitPatient } = this.context.clinic;
    return [visitPatient?.name ?? this.patient?.name ?? (this.visit?.patient ? texts().visit.hiddenName : texts().visit.noPatient), visitPatient ? `${visitPatient.code} · ${sideWords(this.visit?.side ?? visitPatient.side)}` : ''];
  }
  what(): readonly [string, string] { return [this.t.title, this.visit ? timeWords(this.visit) : '']; }

  close(): void {
    this.closed = true;
    clearInterval(this.timer);
    this.note?.close();
  }

  private get visit(): Visit | undefined {
    const { visit } = this.context.clinic;
    return visit?.id === this.id ? visit : this.finished;
  }

  private async open(): Promise<void> {
    const { clinic } = this.context;
    this.element.replaceChildren(h('section', { class: 'panel narrow' }, this.message.element));
    try {
      if (clinic.finished?.visit.id === this.id) {
        this.finished = clinic.finished.visit;
        if (this.finished.patient) this.patient = await clinic.api.get<Patient>(`/api/patients/${this.finished.patient}`).catch(() => undefined);
        if (this.closed) return;
        return this.card(this.finished, clinic.finished.next);
      }
      if (!this.visit) await clinic.lookAtVisit();
      if (this.closed) return;
      if (!this.visit) return this.over(texts().visit.over);
      if (this.visit.patient) this.patient = await clinic.api.get<Patient>(`/api/patients/${this.visit.patient}`).catch(() => undefined);
      if (!this.closed) this.build(this.visit);
    } catch (problem) {
      if (!this.closed) this.message.showProblem(problem);
    }
  }

  private over(words: string): void {
    this.note?.close();
    this.message.show(words);
    this.element.replaceChildren(h('section', { class: 'panel narrow', 'data-testid': 'visit-over' }, this.message.element, link(texts().patients.title, { at: 'patients' })));
  }

  private build(visit: Visit): void {
    const { t, context } = this;
    this.note = new NoteBox(context, { visit: this.id }, `note-visit-${this.id}`, visit.patient ?? 0, () => {});
    const drafts = context.clinic.drafts;
    const kept = (what: string): Field => {
      const field = new Field(what === 'next' ? t.next : t.reason, textInput(`end-${what}`, drafts.get<string>(`${what}-${this.id}`, visit.patient ?? 0) ?? '', { maxlength: 500 }));
      field.input.addEventListener('input', () => drafts.set(`${what}-${this.id}`, visit.patient ?? 0, field.input.value));
      return field;
    };
    const next = kept('next'), reason = kept('reason');
    next.element.append(this.proposed(visit, next.input));
    const nothing = visit.trials.length === 0 && context.model.counters.active_s === 0;
    const finish = (state: 'done' | 'unfinished', words: string, kind: string): HTMLButtonElement => action(words, `finish-${state}`, this.message, () => this.finish(state, [['next', next], ['reason', reason]]), kind);
    this.element.replaceChildren(
      h('div', { class: 'col' }, panel(t.doneTitle, 'done', this.done)),
      h('div', { class: 'col side' }, panel(texts().pain.after, 'pains', painChoice(context, visit, 'after').element), panel(texts().visit.noteTitle, 'marks', this.note.element, nothing ? reason.element : null, next.element),
        h('section', { class: 'panel', 'aria-label': t.title }, this.message.element, finish('done', t.finish, 'go large wide'), finish('unfinished', t.unfinished, 'wide'), h('a', { class: 'b wide', href: hashOf({ at: 'visit', visit: this.id }) }, t.back))));
    this.show();
  }

  /** One step harder for each exercise, written into the field by one touch. */
  private proposed(visit: Visit, input: HTMLInputElement): HTMLElement {
    const trained = visit.plan.filter((_, i) => visit.trials.some(({ item }) => item === i) || i === visit.item);
    const wishes = proposals(trained, this.context.clinic.presets?.exercises ?? []).map(({ words }) => words);
    const presses = wishes.map((wish, i) => button(wish, `propose-${i}`, () => {
      input.value = toggled(input.value, wish);
      input.dispatchEvent(new Event('input'));
    }, 'small'));
    const mark = (): void => presses.forEach((press, i) => press.setAttribute('aria-pressed', String(input.value.includes(wishes[i]))));
    input.addEventListener('input', mark);
    mark();
    return h('div', { class: 'proposals', role: 'group', 'aria-label': this.t.next }, ...presses);
  }

  private show(): void {
    const { visit, t, patient } = this;
    if (this.closed) return;
    if (!visit) return this.over(fill(texts().visit.endedElsewhere, { at: clock(new Date()) }));
    const last = newestFirst(patient?.visits ?? []).find((other) => other.id !== visit.id && tookPlace(other));
    if (!this.changes.of(visit.trials, visit.plan, isCounting(visit))) return;
    this.done.replaceChildren(...(visit.trials.length === 0 ? [h('p', { class: 'none' }, t.nothing)] : []), doneList(visit, last));
  }

  private async finish(state: 'done' | 'unfinished', notes: readonly (readonly [string, Field])[]): Promise<void> {
    const { context: { clinic }, id } = this, visit = this.visit;
    if (!visit) return;
    this.message.show('');
    await this.note?.save();
    for (const [kind, { input }] of notes) {
      if (input.value.trim() === '') continue;
      await clinic.outbox.add(`/api/visits/${id}/notes`, { kind, text: input.value.trim(), at_us: Date.now() * 1000 });
      clinic.drafts.drop(`${kind}-${id}`, visit.patient ?? 0);
    }
    this.finished = await clinic.api.send<Visit>('POST', `/api/visits/${id}/finish`, { state });
    clinic.finished = { visit: this.finished, next: notes[0][1].input.value.trim() };
    if (clinic.visit?.id === id) clinic.take(null);
    this.card(this.finished, clinic.finished.next);
  }

  /** Draws the card again when a recording of the finished visit has been measured. */
  private lookAgain(): void {
    const { context: { clinic }, finished } = this;
    if (!finished || !isCounting(finished) || clinic.silentSince) return;
    void clinic.api.get<Visit>(`/api/visits/${this.id}`).then((visit) => {
      if (this.closed || this.finished !== finished) return;
      this.finished = visit;
      if (clinic.finished?.visit.id === this.id) clinic.finished = { ...clinic.finished, visit };
      this.card(visit, clinic.finished?.next ?? '');
    }).catch(() => {});
  }

  /** One number that grew since the last visit. */
  private grown(visit: Visit): HTMLElement | null {
    const more = moreMinutes(visit, this.patient?.visits ?? []);
    return more > 0 ? h('p', { class: 'grown', 'data-testid': 'grown' }, fill(this.t.card.grown, { min: minutes(more) })) : null;
  }

  /** The visits of the course as a row of marks, filled up to this one. */
  private course(visit: Visit): HTMLElement | null {
    const at = visit.patient === null ? undefined : ofCourse(visit, this.patient?.visits ?? [], this.context.clinic.presets?.course);
    if (!at) return null;
    const words = fill(texts().today.ofCourse, at);
    return h('div', { class: 'course' }, h('div', { class: 'dots-of', 'aria-hidden': 'true' }, ...Array.from({ length: at.of }, (_, i) => h('i', { class: i < at.n ? 'on' : '' }))), h('span', {}, words.charAt(0).toUpperCase() + words.slice(1)));
  }

  /** The card for the patient: large type, no name, and only what was done. */
  private card(visit: Visit, next: string): void {
    const t = this.t.card, counting = isCounting(visit), led_s = timeOf_s(visit, 'led_s'), active_s = timeOf_s(visit, 'active_s');
    const trained = counting ? texts().patient.counting : active_s === 0 && led_s === 0 ? t.here
      : [...(active_s > 0 ? [fill(t.trained, { min: timeWords(visit) })] : []), ...(led_s > 0 ? [fill(t.led, { min: timeWords(visit, 'led_s') })] : [])].join(' ');
    const rows = visit.plan.flatMap((item, i) => {
      const trials = visit.trials.filter((trial) => trial.item === i);
      if (trials.length === 0) return [];
      const result = trials.at(-1)!.results[0];
      return [h('li', {}, h('b', {}, itemWords(item)), h('span', {}, [counting || activeOf_s(visit, i) === 0 ? '' : minutes(activeOf_s(visit, i) / 60), result && (active_s > 0 || led_s > 0) ? resultWords(result) : ''].filter(Boolean).join(' · ')))];
    });
    this.element.replaceChildren(h('section', { class: 'panel patient-card', 'data-testid': 'patient-card', 'aria-label': t.title }, h('div', { class: 'crown' }, h('h2', {}, t.title), h('span', {}, visitDay(visit))), h('p', { class: 'most', 'data-testid': 'trained' }, trained), this.grown(visit), this.course(visit),
      h('ul', {}, ...rows), next === '' ? null : h('p', {}, h('b', {}, t.next), ` ${next}`)),
    h('div', { class: 'pair no-print' }, h('a', { class: 'b go large', href: hashOf({ at: 'patients' }), 'data-testid': 'next-patient' }, t.nextPatient),
      visit.patient ? h('a', { class: 'b', href: hashOf({ at: 'patient', patient: visit.patient }), 'data-testid': 'to-patient' }, t.toPatient) : null, button(t.print, 'print-card', () => print(), '', { disabled: counting })));
    this.element.classList.add('carded');
  }
}

/** The visits of a course until this one, this one included, and all of them; undefined: it is no part of one. */
export function ofCourse(visit: Visit, visits: readonly Visit[], course: { readonly weeks: number; readonly visits_a_week: number } | undefined): { readonly n: number; readonly of: number } | undefined {
  const n = visits.filter((other) => tookPlace(other) && other.id !== visit.id && other.began_us < visit.began_us).length + 1, of = (course?.weeks ?? 0) * (course?.visits_a_week ?? 0);
  return n <= of ? { n, of } : undefined;
}

/** Whole minutes of activity more than in the visit before; 0 where there are not more. */
export function moreMinutes(visit: Visit, visits: readonly Visit[]): number {
  const before = newestFirst(visits).find((other) => tookPlace(other) && other.began_us < visit.began_us && other.id !== visit.id);
  return before && !isCounting(visit) && !isCounting(before) ? Math.max(0, Math.floor((timeOf_s(visit, 'active_s') - timeOf_s(before, 'active_s')) / 60)) : 0;
}

/** Done against planned, with the results of each item. */
export function doneList(visit: Visit, last: Visit | undefined): HTMLElement {
  const t = texts().end;
  return h('ol', { class: 'plan' }, ...visit.plan.map((item, i) => {
    const trials = visit.trials.filter((trial) => trial.item === i);
    return h('li', {}, h('span', { class: 'nr', 'aria-hidden': 'true' }, trials.length > 0 ? '✓' : String(i + 1)), h('div', { class: 'grow' }, h('p', { class: 'split' }, h('b', {}, itemWords(item)), h('span', { class: 'num' }, isCounting({ trials }) ? texts().patient.counting : fill(t.of, { done: minutes(activeOf_s(visit, i) / 60), planned: minutes(item.minutes) }))),
      ...(trials.length === 0 ? [h('small', {}, t.notDone)] : trials.map((trial) => resultTable(trial, last)))));
  }));
}

/** A table of a trial's results beside those of the last visit. */
function resultTable(trial: Trial, last: Visit | undefined): HTMLElement {
  const t = texts().end, p = texts().patient;
  if (trial.state === 'waiting') return h('small', {}, p.waiting);
  if (trial.state === 'failed') return h('small', {}, fill(p.failedTrial, { why: trial.why ?? '' }));
  const rows = besideLast(trial, last);
  if (rows.length === 0) return h('small', {}, t.noResults);
  const words = (result: Result | undefined): string => (result ? `${number(result.value)}${result.unit === '' ? '' : ` ${result.unit}`}` : '–');
  const partly = trial.why ? h('caption', {}, p.partly) : null;
  return h('table', { class: 'table results' }, partly, columns([t.result, t.now, last ? fill(t.last, { day: visitDay(last) }) : t.lastNone]),
    h('tbody', {}, ...rows.map(({ result, before }) => h('tr', {}, h('th', { scope: 'row' }, resultName(result.name)), h('td', { class: 'num' }, words(result)), h('td', { class: 'num' }, words(before))))));
}
