import { choice, h, setText } from '../console/dom';
import type { EventT } from '../protocol';
import { Changes } from '../shared/changes';
import { duration } from '../shared/format';
import { FreshButtons } from '../shared/fresh_buttons';
import { fill } from '../shared/i18n';
import { texts } from './i18n';
import { NoteBox } from './notes';
import type { ClinicContext } from './clinic_context';
import { PainChoice, type PainTime } from './pain';
import { activeOf_s, itemNow, type Patient, type Visit } from './records';
import { gently, running, SideQuestion, Training } from './training';
import { besideTitle, button, link, panel, problemWords, redraw, StatusMessage, type Screen } from './ui';
import { clock, clockOf, helpWords, itemWords, minutes, sideWords } from './words';

/** The visit is requested again this often [ms]. */
const EVERY_MS = 4000;
const MARKS = ['tired', 'spasm', 'cue', 'hands_on'] as const;

/** A visit under way: the picture, the plan, the most used controls, and quick notes. It works while names are hidden or the records do not answer. */
export class VisitScreen implements Screen {
  readonly element = h('main', { class: 'visit' });
  private readonly t = texts().visit;
  private readonly training: Training;
  private readonly planned = h('div', {});
  private readonly clock = h('b', { class: 'num' });
  private readonly active = h('span', { class: 'num', 'data-testid': 'active' });
  private readonly side: SideQuestion;
  private readonly message = new StatusMessage();
  private readonly warning = h('p', { class: 'warning', hidden: true, 'data-testid': 'visit-warnings' });
  private readonly marked = h('p', { class: 'marked', role: 'status' });
  private readonly next: HTMLButtonElement;
  private readonly end: HTMLButtonElement;
  private readonly stop: HTMLButtonElement;
  private readonly planChanges = new Changes();
  private readonly painChanges = new Changes();
  private note: NoteBox | undefined;
  private painAsked: PainTime | undefined;
  private painWhen: PainTime | undefined;
  private readonly painPlace = h('div', { class: 'pain-place' });
  private readonly painFresh = new FreshButtons(this.painPlace);
  private readonly live = new LiveTime();
  private marks: readonly string[] = [];
  /** The visit that is shown; null once it is over. */
  private shown: Visit | null | undefined;
  private closed = false;
  private busy = false;
  private read_ms = -Infinity;

  constructor(private readonly context: ClinicContext, private readonly id: number) {
    const { t } = this;
    this.training = new Training(context);
    this.side = new SideQuestion(String(id), () => this.visit?.side, t.wrongSide, () => this.refresh());
    this.next = button(t.next, 'next-item', () => this.goTo(this.now + 1), 'first wide');
    this.end = button(t.end, 'end-visit', () => this.ending(), 'wide');
    this.stop = button(t.stop, 'gentle-stop', () => gently(context, t.stop), 'wide');
    if (context.clinic.visit?.id === id) this.build();
    else void this.find();
  }

  private get visit(): Visit | undefined {
    const { visit } = this.context.clinic;
    return visit?.id === this.id ? visit : undefined;
  }
  private get now(): number { return this.visit ? itemNow(this.visit) : 0; }
  private get named(): boolean { return this.context.clinic.stage === 'in'; }

  who(): readonly [string, string] {
    const { visitPatient, visit } = this.context.clinic, { t } = this;
    const side = visit ? sideWords(visit.side) : '';
    if (visit && !visit.patient) return [t.noPatient, `${side} · ${t.gentle}`];
    if (!this.named || !visitPatient) return [t.hiddenName, side];
    return [visitPatient.name, `${visitPatient.code} · ${side}`];
  }

  what(): readonly [string, string] {
    const { visit, t, context: { model } } = this;
    const item = visit?.plan[this.now];
    const recorded = model.recorded === undefined ? [] : [model.recorded ? t.recorded : t.unrecorded];
    return item ? [itemWords(item), [fill(t.itemOf, { n: this.now + 1, m: visit!.plan.length }), ...recorded].join(' · ')] : [t.title, ''];
  }

  /** Start needs a confirmed hand side, and the exercise and limits of this visit. */
  startable(): boolean { return this.visit !== undefined && !this.busy && this.side.confirmed && this.setUp; }

  refresh(): void {
    const { visit, t } = this;
    if (!visit) {
      if (this.shown) this.over(fill(t.endedElsewhere, { at: clock(new Date()) }));
      return;
    }
    if (this.shown === null) return;
    setText(this.clock, clock(new Date()));
    setText(this.active, this.activeWords(visit));
    this.training.refresh();
    this.side.refresh();
    this.showPlan(visit);
    this.stop.disabled = !running(this.context);
    this.showPain(visit);
    if (this.message.element.textContent === '' && !this.setUp) this.message.show(t.notSetUp);
    else if (this.message.element.textContent === t.notSetUp && this.setUp) this.message.show('');
    const now_ms = performance.now();
    if (now_ms - this.read_ms < EVERY_MS || this.context.clinic.silentSince) return;
    this.read_ms = now_ms;
    if (['in', 'hidden'].includes(this.context.clinic.stage)) void this.context.clinic.lookAtVisit().catch(() => {});
  }

  draw(): void { this.training.draw(); }
  take(events: readonly EventT[]): void { this.training.take(events); }
  sceneChanged(): void { this.training.sceneChanged(); }

  close(): void {
    this.closed = true;
    this.note?.close();
    this.training.close();
  }

  private async find(): Promise<void> {
    this.element.replaceChildren(h('section', { class: 'panel narrow' }, this.message.element));
    try {
      await this.context.clinic.lookAtVisit();
      if (this.closed) return;
      if (this.visit) this.build();
      else this.over(this.t.over);
    } catch (problem) {
      if (!this.closed) this.message.showProblem(problem);
    }
  }

  /** Closes the screen after the visit has ended, here or on another screen. */
  private over(words: string): void {
    const { clinic } = this.context, { shown } = this;
    this.shown = null;
    this.message.show(clinic.visit ? this.t.another : words);
    this.element.replaceChildren(h('section', { class: 'panel narrow', 'data-testid': 'visit-over' }, this.message.element, h('div', { class: 'pair' },
      clinic.visit ? link(texts().visitOpen, { at: 'visit', visit: clinic.visit.id }) : link(texts().patients.title, { at: 'patients' }),
      shown?.patient ? link(texts().end.card.toPatient, { at: 'summary', patient: shown.patient, visit: this.id }) : null)));
  }

  private build(): void {
    const { t, context } = this, visit = this.shown = this.visit!;
    const plan = besideTitle(panel(t.plan, 'planned', h('p', { class: 'session' }, this.clock, ' ', this.active), this.planned, this.message.element, h('div', { class: 'pair acts' }, this.next, this.stop, this.end)));
    const marks = panel(t.marks, 'marks', h('div', { class: 'mark-keys' }, ...MARKS.map((kind) => button(texts().notes.kinds[kind], `mark-${kind}`, () => this.mark(kind)))), this.marked);
    if (this.named) {
      this.note = new NoteBox(context, { visit: this.id }, `note-visit-${this.id}`, visit.patient ?? 0, () => void context.clinic.lookAtVisit().catch(() => {}));
      marks.append(this.note.element);
    }
    this.element.replaceChildren(h('div', { class: 'col seen' }, this.warning, this.side.element, this.training.picture, h('div', { class: 'under' }, marks, panel(t.pain, 'pains', this.painPlace))), h('div', { class: 'col' }, plan, this.training.controls));
    this.training.begin();
    this.refresh();
    if (this.named && visit.patient) void this.readWarnings(visit.patient);
  }

  /** What the therapist must know of the person, during the visit too. It goes with the names. */
  private async readWarnings(patient: number): Promise<void> {
    const { warnings } = await this.context.clinic.read<Patient>(`/api/patients/${patient}`).catch(() => ({ warnings: '' }));
    if (this.closed) return;
    this.warning.hidden = warnings === '';
    setText(this.warning, warnings);
  }

  /** The active time of the item and of the visit: measured trials plus the running session. */
  private activeWords(visit: Visit): string {
    const { counters } = this.context.model, { t, now } = this;
    const from_us = (counters.from?.getTime() ?? 0) * 1000;
    const measured = visit.trials.some(({ began_us, state }) => state === 'measured' && began_us > from_us - 5e6);
    const live_s = from_us > visit.began_us - 5e6 && !measured ? counters.active_s : 0;
    const here_s = this.live.of(counters.from, now) ? live_s : 0;
    const all_s = live_s + visit.trials.reduce((sum, { active_s }) => sum + (active_s ?? 0), 0);
    return fill(t.active, { item: duration(activeOf_s(visit, now) + here_s), of: visit.plan[now]?.minutes ?? 0, all: duration(all_s) });
  }

  private showPlan(visit: Visit): void {
    const { now, t } = this;
    const last = now >= visit.plan.length - 1;
    if (!this.planChanges.of(visit.plan, now, visit.trials.map(({ item, active_s, state }) => [item, active_s, state]), this.busy)) return;
    this.next.hidden = last;
    // The next button to press: Start until the item was trained.
    const trained = visit.trials.some((trial) => trial.item === now);
    this.next.classList.toggle('go', trained && !last);
    this.end.classList.toggle('go', trained && last);
    this.next.disabled = this.end.disabled = this.busy;
    const following = visit.plan[now + 1];
    setText(this.next, following ? fill(t.nextIs, { name: itemWords(following) }) : t.next);
    this.planned.replaceChildren(h('ol', { class: 'plan' }, ...visit.plan.map((item, i) => {
      const done_s = activeOf_s(visit, i);
      const state = i === now ? t.inProgress : visit.trials.some((trial) => trial.item === i) ? t.done : '';
      const again = i === now ? null : button(t.setUp, `item-${i}`, () => this.goTo(i), 'small', { 'aria-label': `${t.setUp}: ${itemWords(item)}` });
      return h('li', { ...(i === now ? { 'aria-current': 'step' } : {}) }, h('span', { class: 'nr', 'aria-hidden': 'true' }, state === t.done ? '✓' : String(i + 1)), h('span', {}, h('b', {}, itemWords(item)),
        h('small', {}, [state, `${done_s > 0 ? `${duration(done_s)} / ` : ''}${minutes(item.minutes)}`, i === now ? fill(texts().helpOf, { help: helpWords(item.help) }) : ''].filter(Boolean).join(' · '))), again);
    })));
  }

  /** Whether the program has set up this visit and item. */
  private get setUp(): boolean {
    const { scene } = this.context.model;
    return Number(scene?.visit ?? 0) === this.id && scene?.visitItem === this.now;
  }

  // ---- stop, next, end

  /** Stops gently, then sets up the item's exercise, help and limits. It does not start. */
  private async goTo(item: number): Promise<void> {
    if (this.busy) return;
    const { clinic } = this.context, { t } = this;
    this.busy = true;
    this.message.show('');
    this.refresh();
    try {
      if (!await gently(this.context, t.stop)) return this.message.show(t.doesNotStop);
      clinic.take(await clinic.api.send<Visit>('POST', `/api/visits/${this.id}/item`, { item }));
    } catch (problem) {
      this.message.show(`${problemWords(problem)} ${t.staysAsItIs}`);
    } finally {
      this.busy = false;
      this.refresh();
    }
  }

  private async ending(): Promise<void> {
    if (this.busy) return;
    this.busy = true;
    try {
      if (await gently(this.context, this.t.stop)) this.context.go({ at: 'end', visit: this.id });
      else this.message.show(this.t.doesNotStop);
    } finally {
      this.busy = false;
    }
  }

  // ---- quick notes, pain

  private mark(kind: (typeof MARKS)[number]): void {
    const at_us = Date.now() * 1000;
    this.marks = [`${clockOf(at_us)} ${texts().notes.kinds[kind]}`, ...this.marks].slice(0, 4);
    setText(this.marked, this.marks.join(' · '));
    void this.context.clinic.outbox.add(`/api/visits/${this.id}/notes`, { kind, text: '', at_us });
  }

  /** Shows the question for pain before the session until the first item has ended, later that for after it; the other one can be chosen. */
  private showPain(visit: Visit): void {
    const { counters } = this.context.model;
    const trained = visit.trials.length > 0 || (counters.active_s > 0 && (counters.from?.getTime() ?? 0) * 1000 > visit.began_us - 5e6);
    const ended = trained && !running(this.context);
    const when: PainTime = this.painAsked ?? (ended || this.painWhen === 'after' ? 'after' : 'before');
    if (!this.painChanges.of(when, visit.pain_before, visit.pain_after)) return;
    if (this.painWhen !== when && this.painWhen !== undefined && this.painAsked === undefined) this.painFresh.changed();
    this.painWhen = when;
    const t = texts().pain;
    const whens = choice(this.t.pain, [{ key: 'before', name: t.before }, { key: 'after', name: t.after }], when, (key) => { this.painAsked = key as PainTime; this.showPain(this.visit ?? visit); });
    redraw(this.painPlace, whens.element, painChoice(this.context, visit, when).element);
  }
}

/** Whose time a session's is: that of the item under way when the page first saw the session, also after the next item is set up. */
export class LiveTime {
  private from: number | undefined;
  private item = 0;

  of(from: Date | undefined, now: number): boolean {
    if (from?.getTime() !== this.from) [this.from, this.item] = [from?.getTime(), now];
    return this.item === now;
  }
}

/** Buttons for pain; the value is sent, or kept until the records answer, and set in the visit at once. */
export function painChoice({ clinic }: ClinicContext, visit: Visit, when: PainTime): PainChoice {
  const key = when === 'before' ? 'pain_before' : 'pain_after';
  return new PainChoice(when, visit[key], (value) => {
    if (clinic.visit?.id === visit.id) clinic.visit = { ...clinic.visit, [key]: value };
    void clinic.outbox.add(`/api/visits/${visit.id}/pain`, { when, value }, `pain-${visit.id}-${when}`);
  });
}
