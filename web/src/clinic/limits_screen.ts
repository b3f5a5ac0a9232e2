import { choice, h } from '../console/dom';
import { texts as consoleTexts } from '../console/i18n';
import { fixed } from '../shared/format';
import { fill } from '../shared/i18n';
import { RefusalError } from './api';
import type { ClinicContext } from './clinic_context';
import { texts } from './i18n';
import { limitPicture } from './limit_picture';
import { faultOf, fromOwn, leastWidth, limitsFrom, ownMovement, rangesOf, type LimitAxis, type OwnMovement, type Range } from './person_limits';
import type { OneSide, Patient } from './records';
import { action, besideTitle, button, Field, link, panel, StatusMessage, type Screen } from './ui';
import { dayOf, sideWords } from './words';

/** The unit in which an axis is shown, and its size. */
const shownIn = ({ turns }: LimitAxis): { readonly unit: string; readonly per: number; readonly decimals: number } => (turns ? { unit: '°', per: Math.PI / 180, decimals: 0 } : { unit: 'cm', per: 0.01, decimals: 1 });

/** Limits of each hand that are not saved yet. */
type Typed = Partial<Record<OneSide, readonly (readonly [axis: string, range: Range])[]>>;

/** The limits of a person's hand, filled in from own movement: narrowed freely, widened up to the device's range. */
export class LimitsScreen implements Screen {
  readonly element = h('main', { class: 'form limits' });
  private readonly t = texts().limits;
  private readonly message = new StatusMessage();
  private patient: Patient | undefined;
  private side: OneSide = 'right';
  private ranges = new Map<string, Range>();
  private shownAxes = '';
  private closed = false;

  constructor(private readonly context: ClinicContext, private readonly id: number) {
    this.element.append(h('section', { class: 'panel narrow' }, this.message.element));
    void this.read();
  }

  who(): readonly [string, string] { return [this.patient?.name ?? texts().patient.patient, this.patient?.code ?? '']; }
  what(): readonly [string, string] { return [this.t.title, this.patient ? sideWords(this.side) : '']; }
  close(): void { this.closed = true; }

  /** The axes of the station's device; empty until the station has said them. */
  private get axes(): LimitAxis[] {
    return (this.context.model.scene?.axes ?? []).map(({ name, unit, lower, upper }) => ({ name: String(name), turns: String(unit) === 'rad', lower, upper }));
  }

  sceneChanged(): void {
    if (this.patient && JSON.stringify(this.axes) !== this.shownAxes) this.build();
  }

  private async read(): Promise<void> {
    try {
      const patient = await this.context.clinic.read<Patient>(`/api/patients/${this.id}`);
      if (this.closed) return;
      this.patient = patient;
      this.choose(patient.side === 'both' ? 'right' : patient.side);
    } catch (problem) {
      this.message.showProblem(problem);
    }
  }

  /** What was typed is kept over a reload, hidden names and a look at the other hand. */
  private get typed(): Typed { return this.context.clinic.drafts.get<Typed>('limits', this.id) ?? {}; }

  private choose(side: OneSide): void {
    this.side = side;
    this.ranges = new Map(this.typed[side] ?? rangesOf(this.patient!.hands[side]?.limits));
    this.build();
  }

  private build(): void {
    const { t, patient, axes } = this;
    if (!patient) return;
    this.shownAxes = JSON.stringify(axes);
    const own = ownMovement(patient, this.side);
    const sides = choice(texts().today.side, (['left', 'right'] as const).map((key) => ({ key, name: sideWords(key) })), this.side, (key) => this.choose(key as OneSide));
    const from = own.at_us > 0 ? fill(t.measured, { day: dayOf(own.at_us) }) : t.notMeasured;
    const all = own.at_us > 0 ? button(t.takeAll, 'take-all', () => this.change(() => { for (const axis of axes) this.put(axis, fromOwn(axis, own.of.get(axis.name))); })) : null;
    this.element.replaceChildren(
      h('div', { class: 'col whole' }, besideTitle(panel(t.title, 'limits-panel',
        h('p', {}, t.words), h('p', { class: 'aside', 'data-testid': 'own-from' }, from), patient.side === 'both' ? sides.element : null,
        h('ul', { class: 'legend' }, ...(['own', 'device', 'end'] as const).map((what) => h('li', { class: what }, t.legend[what]))),
        axes.length === 0 ? h('p', { class: 'hint' }, t.noStation) : h('div', { class: 'limit-cards' }, ...axes.map((axis) => this.card(axis, own.of.get(axis.name))))), all)),
      h('div', { class: 'form-end' }, this.message.element, link(texts().form.back, { at: 'patient', patient: patient.id }, 'limits-back'), action(texts().form.save, 'save-limits', this.message, () => this.save(), 'go')));
  }

  private put(axis: LimitAxis, range: Range | undefined): void {
    if (range) this.ranges.set(axis.name, range);
    else this.ranges.delete(axis.name);
  }

  private change(act: () => void): void {
    act();
    this.context.clinic.drafts.set('limits', this.id, { ...this.typed, [this.side]: [...this.ranges] });
    this.message.show('');
    const focused = document.activeElement?.getAttribute('data-testid');
    this.build();
    if (focused) this.element.querySelector<HTMLElement>(`[data-testid="${focused}"]`)?.focus();
  }

  private card(axis: LimitAxis, own: OwnMovement | undefined): HTMLElement {
    const { t } = this, { unit, per, decimals } = shownIn(axis), range = this.ranges.get(axis.name);
    const name = consoleTexts().axesLong[axis.name] ?? axis.name;
    const shown = (value: number): string => fixed(value / per, decimals), typed = (value: number): string => (value / per).toFixed(decimals);
    const between = (of: OwnMovement): string => `${of.lower === undefined ? '…' : shown(of.lower)} – ${of.upper === undefined ? '…' : shown(of.upper)} ${unit}`;
    const words = fill(t.picture, { axis: name, device: between(axis), own: own ? between(own) : t.none, limit: range ? between(range) : t.none });
    const field = (end: 'lower' | 'upper'): Field => {
      const input = h('input', { type: 'number', class: 'in', 'data-testid': `limit-${axis.name}-${end}`, step: axis.turns ? 1 : 0.1, min: typed(axis.lower), max: typed(axis.upper), value: range ? typed(range[end]) : '', inputmode: 'decimal' });
      const of = new Field(t.ends[end], input, { hint: unit });
      input.addEventListener('change', () => {
        if (input.value === '' || !Number.isFinite(input.valueAsNumber)) return;
        this.change(() => this.put(axis, { ...(range ?? { lower: axis.lower, upper: axis.upper }), [end]: input.valueAsNumber * per }));
      });
      return of;
    };
    const fields = { lower: field('lower'), upper: field('upper') };
    const fault = range && faultOf(axis, range);
    if (fault) fields.upper.refuse(fill(t.faults[fault], { lower: shown(axis.lower), upper: `${shown(axis.upper)} ${unit}`, least: `${shown(leastWidth(axis))} ${unit}` }));
    const taken = fromOwn(axis, own);
    return h('section', { class: 'limit-card', 'aria-label': name, 'data-axis': axis.name }, h('h3', {}, name), limitPicture(axis, own, range, words),
      h('p', { class: 'aside' }, own ? fill(t.ownIs, { own: between(own) }) : t.notThis), h('div', { class: 'pair' }, fields.lower.element, fields.upper.element),
      h('div', { class: 'pair' }, own ? button(taken ? t.takeOwn : t.tooNarrow, `own-${axis.name}`, () => this.change(() => this.put(axis, taken)), '', { disabled: !taken }) : null,
        range ? button(t.noLimit, `free-${axis.name}`, () => this.change(() => this.put(axis, undefined))) : null));
  }

  private async save(): Promise<void> {
    const { t, patient, context: { clinic } } = this, axes = this.axes;
    if (!patient || axes.length === 0) return this.message.show(t.noStation);
    const wrong = axes.find((axis) => { const range = this.ranges.get(axis.name); return range && faultOf(axis, range); });
    if (wrong) return this.element.querySelector<HTMLElement>(`[data-testid="limit-${wrong.name}-upper"]`)?.focus();
    const hand = patient.hands[this.side];
    if (!hand) return this.message.show(fill(t.noHand, { side: sideWords(this.side) }));
    const { id, version, name, code, born, number, side, hands, preset, parameters, warnings, plan } = patient;
    try {
      await clinic.api.send('PUT', `/api/patients/${id}`, { name, code, born, number, side, preset, parameters, warnings, plan, version, hands: { ...hands, [this.side]: { ...hand, limits: limitsFrom(axes, this.ranges) } } });
      const { [this.side]: _saved, ...other } = this.typed;
      if (Object.keys(other).length > 0) clinic.drafts.set('limits', id, other);
      else clinic.drafts.drop('limits', id);
      this.context.showMessage(t.saved);
      this.context.go({ at: 'patient', patient: id });
    } catch (problem) {
      if (!(problem instanceof RefusalError) || problem.code !== 'changed') throw problem;
      this.patient = problem.more.now as Patient;
      this.message.show(t.changed);
    }
  }
}
