import { columns, h } from '../console/dom';
import { fill } from '../shared/i18n';
import { curveFigure, withIntervals } from './curves';
import { doneList } from './end_screen';
import { texts } from './i18n';
import { accountName, noteList } from './notes';
import type { ClinicContext } from './clinic_context';
import { painWords } from './pain';
import { newestFirst, tookPlace, type Patient, type Visit } from './records';
import { hashOf } from './routes';
import { button, StatusMessage, type Screen } from './ui';
import { activeWords, bornWords, itemWords, sideWords, timeWords, visitClock, visitDay } from './words';

/** A printable sheet, shown on the screen before it is printed. */
abstract class Sheet implements Screen {
  readonly element = h('main', { class: 'sheet' });
  protected readonly t = texts().sheet;
  protected patient: Patient | undefined;
  private readonly message = new StatusMessage();
  private closed = false;
  private theme: string | undefined;
  private readonly light = (): void => { this.theme = document.documentElement.dataset.theme; document.documentElement.dataset.theme = 'light'; };
  private readonly back = (): void => { document.documentElement.dataset.theme = this.theme; };

  constructor(protected readonly context: ClinicContext, private readonly id: number) {
    addEventListener('beforeprint', this.light);
    addEventListener('afterprint', this.back);
    this.element.append(h('section', { class: 'panel narrow' }, this.message.element));
    void this.open();
  }

  who(): readonly [string, string] { return [this.patient?.name ?? '', this.patient?.code ?? '']; }
  close(): void {
    this.closed = true;
    removeEventListener('beforeprint', this.light);
    removeEventListener('afterprint', this.back);
  }

  /** The content of the sheet; undefined where there is none. */
  protected abstract paper(patient: Patient): Node[] | undefined;

  private async open(): Promise<void> {
    try {
      const patient = this.patient = await this.context.clinic.api.get<Patient>(`/api/patients/${this.id}`);
      if (this.closed) return;
      const paper = this.paper(patient);
      const { t } = this;
      this.element.replaceChildren(h('div', { class: 'pair no-print' }, h('a', { class: 'b', href: hashOf({ at: 'patient', patient: this.id }) }, fill(t.back, { name: patient.name })), paper ? button(t.print, 'print', () => print(), 'go') : null),
        h('article', { class: 'panel paper' }, ...(paper ?? [h('p', { class: 'none' }, t.nothing)])));
    } catch (problem) {
      if (!this.closed) this.message.showProblem(problem);
    }
  }

  protected head(title: string, patient: Patient): Node[] {
    return [h('h2', {}, title), h('p', { class: 'of' }, h('b', {}, patient.name), ` · ${patient.code} · ${sideWords(patient.side)}`, patient.born === '' ? '' : ` · ${bornWords(patient.born)}`)];
  }
}

/** A sheet with the curves and visits of a patient. */
export class ProgressPrint extends Sheet {
  protected paper(patient: Patient): Node[] | undefined {
    const { t } = this, visits = newestFirst(patient.visits).filter(tookPlace);
    if (visits.length === 0) return undefined;
    return [...this.head(t.progress, patient), h('div', { class: 'curves' }, ...withIntervals(patient.curves).map(curveFigure)), h('p', { class: 'aside' }, texts().patient.noClaim),
      h('table', { class: 'table' }, columns([t.day, t.hand, t.done, t.active, t.helped, t.led, t.pain]),
        h('tbody', {}, ...visits.map((visit) => h('tr', {}, h('th', { scope: 'row' }, visitDay(visit)), h('td', {}, sideWords(visit.side)), h('td', {}, [...new Set(visit.trials.map(itemWords))].join(', ')), ...(['active_s', 'helped_s', 'led_s'] as const).map((time) => h('td', { class: 'num' }, timeWords(visit, time))),
          h('td', {}, `${painWords(visit.pain_before)} → ${painWords(visit.pain_after)}`)))))];
  }
}

/** A sheet with one visit: done against planned, results, pain, notes. */
export class VisitPrint extends Sheet {
  constructor(context: ClinicContext, id: number, private readonly visitId: number) { super(context, id); }

  protected paper(patient: Patient): Node[] | undefined {
    const { t } = this, visits = newestFirst(patient.visits);
    const at = visits.findIndex(({ id }) => id === this.visitId), visit: Visit | undefined = visits[at];
    if (!visit) return undefined;
    const last = visits.slice(at + 1).find(tookPlace);
    const notes = (visit.notes?.length ?? 0) > 0 ? visit.notes! : patient.notes.filter((note) => note.visit === visit.id);
    return [...this.head(`${t.visit} ${visitDay(visit)}, ${visitClock(visit)}`, patient),
      h('p', {}, `${sideWords(visit.side)} · ${activeWords(visit)} · ${fill(texts().patient.painWords, { before: painWords(visit.pain_before), after: painWords(visit.pain_after) })}`),
      doneList(visit, last), h('h3', {}, texts().patient.notes), noteList(notes, accountName(this.context))];
  }
}
