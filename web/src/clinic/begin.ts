import { choice, h, setText } from '../console/dom';
import { fill } from '../shared/i18n';
import { RefusalError } from './api';
import { gentleOffer } from './gentle_visit';
import { texts } from './i18n';
import { accountName } from './notes';
import type { ClinicContext } from './clinic_context';
import { goalChoice } from './goals';
import { planEditor, planList } from './plan';
import { newestFirst, nextWish, tookPlace, type Item, type Note, type OneSide, type Patient, type Visit } from './records';
import { besideTitle, button, once, panel, redraw, StatusMessage } from './ui';
import { wishedPlan } from './wishes';
import { itemWords, minutes, sideWords, visitClock, visitDay } from './words';

/** Today's plan, filled in from the last visit, and the button that begins it. */
export class TodayPanel {
  readonly element: HTMLElement;
  private readonly t = texts().today;
  private readonly body = h('div', { class: 'parts' });
  private readonly total = h('span', { class: 'aside' });
  private readonly hint = h('p', { class: 'hint', role: 'status' });
  private readonly message = new StatusMessage();
  private readonly offer = h('div', {});
  private readonly begin: HTMLButtonElement;
  private plan: readonly Item[];
  private readonly from: string;
  private readonly wish: Note | undefined;
  private side: OneSide | undefined;
  private editing = false;

  constructor(private readonly context: ClinicContext, private readonly patient: Patient) {
    const { t } = this, { clinic } = context;
    const filled = patient.today.length > 0 ? patient.today : patient.plan;
    this.plan = clinic.drafts.get<Item[]>('today', patient.id) ?? filled;
    this.side = patient.side === 'both' ? undefined : patient.side;
    const sides = choice(t.side, (['left', 'right'] as const).map((key) => ({ key, name: sideWords(key) })), '', (key) => {
      this.side = key as OneSide;
      sides.choose(key);
      this.refresh();
    });
    sides.element.dataset.testid = 'visit-side';
    this.begin = h('button', { type: 'button', class: 'b go large wide', 'data-testid': 'begin-visit', onclick: () => void once(this.begin, () => this.press()) });
    const change = button(t.change, 'change-plan', () => { this.editing = !this.editing; setText(change, this.editing ? t.ready : t.change); this.show(); }, 'wide');
    const last = newestFirst(patient.visits).find(tookPlace), wish = this.wish = nextWish(patient);
    this.from = last && patient.today.length > 0 ? fill(t.from, { day: visitDay(last) }) : t.fromPlan;
    this.element = besideTitle(panel(t.title, 'today', patient.warnings === '' ? null : h('p', { class: 'warning', 'data-testid': 'warnings' }, patient.warnings),
      wish ? h('p', { class: 'wish', 'data-testid': 'next-wish' }, h('b', {}, `${texts().end.card.next} `), wish.text) : null, this.body,
      patient.side === 'both' ? h('div', { class: 'field' }, h('span', { class: 'label' }, t.side), sides.element) : null, this.hint, this.message.element, this.offer, this.begin, change), this.total);
    this.show();
    this.refresh();
  }

  /** The number of the visit that would begin. */
  private get number(): number { return this.patient.visits.filter(tookPlace).length + 1; }

  refresh(): void {
    const { t, begin, context: { clinic }, patient } = this;
    const open = clinic.visit;
    const own = open?.patient === patient.id;
    setText(begin, open ? (own ? t.goOn : t.otherOpen) : fill(t.begin, { n: this.number }));
    begin.disabled = !open && (this.side === undefined || this.plan.length === 0 || clinic.silentSince !== undefined);
    const preparing = begin.getAttribute('aria-busy') === 'true';
    setText(this.hint, preparing ? t.preparing : open ? (own ? fill(t.openSince, { at: visitClock(open), who: accountName(this.context)(open.account) }) : '') : clinic.silentSince ? t.notNow : this.plan.length === 0 ? t.noPlan : '');
  }

  private take(items: readonly Item[]): void {
    this.plan = items;
    this.context.clinic.drafts.set('today', this.patient.id, items);
    this.show();
    this.refresh();
  }

  private show(): void {
    const { t, plan, wish } = this, { course, exercises = [], goals = [] } = this.context.clinic.presets ?? {}, of = (course?.weeks ?? 0) * (course?.visits_a_week ?? 0), n = this.number;
    setText(this.total, [this.from, minutes(plan.reduce((sum, item) => sum + item.minutes, 0)), ...(n <= of ? [fill(t.ofCourse, { n, of })] : [])].join(' · '));
    const take = (items: readonly Item[]): void => this.take(items);
    // What was written for this visit, as far as it is understood, is taken into the plan by one touch.
    const wished = wish && wishedPlan(wish.text, plan, exercises), fresh = wished?.filter((item) => !plan.some((other) => JSON.stringify(other) === JSON.stringify(item))) ?? [];
    redraw(this.body, h('div', { class: 'wished' }, wished ? button(fill(t.takeWish, { what: fresh.map((item) => itemWords(item)).join(', ') }), 'take-wish', () => take(wished), 'go wide') : null),
      ...(this.editing ? [goalChoice(goals, plan, take), planEditor(plan, exercises, take)] : [planList(plan)]));
  }

  private async press(): Promise<void> {
    const { context, patient, side } = this, { clinic } = context;
    if (clinic.visit) return context.go({ at: 'visit', visit: clinic.visit.id });
    if (!side) return;
    this.message.show('');
    try {
      const visit = await clinic.api.send<Visit>('POST', `/api/patients/${patient.id}/visits`, { side, plan: this.plan });
      clinic.drafts.drop('today', patient.id);
      clinic.take(visit, { id: patient.id, code: patient.code, name: patient.name, side: patient.side, visits: patient.visits.length, last_visit_us: 0, state: 'open', visit: visit.id });
      context.go({ at: 'visit', visit: visit.id });
    } catch (problem) {
      if (problem instanceof RefusalError && problem.code === 'visit_open') await clinic.lookAtVisit().catch(() => {});
      this.message.showProblem(problem);
      if (problem instanceof RefusalError && problem.code === 'damaged') this.offer.replaceChildren(gentleOffer(context));
    }
  }
}
