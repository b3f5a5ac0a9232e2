import { choice, fact, h, setText } from '../console/dom';
import { viewOf } from '../console/parameter_model';
import { texts as consoleTexts } from '../console/i18n';
import { fill } from '../shared/i18n';
import { RefusalError } from './api';
import { BREADTH_M, handPicture, LENGTH_M, MEDIAN } from './hand_picture';
import { texts } from './i18n';
import type { ClinicContext } from './clinic_context';
import { goalChoice } from './goals';
import { planList, select } from './plan';
import type { DamagedPatient, Item, OneSide, Patient, PatientText, Presets, Side, Size } from './records';
import { button, Field, form, panel, problemWords, redraw, StatusMessage, submitButton, textInput, type Screen } from './ui';
import { parameterWords, presetName, sideWords } from './words';

/** Parameters for the reach and fingers of one person; they may be set where the program has them. */
export const OF_PERSON = ['reach_left_m', 'reach_right_m', 'reach_forward_m', 'fingers_open_rad', 'fingers_close_rad'] as const;
const EMPTY: PatientText = { name: '', code: '', born: '', number: '', side: 'both', hands: {}, preset: 'gentle', parameters: {}, warnings: '', plan: [] };
type FormValues = Omit<PatientText, 'side'> & { readonly side: Side | '' };
const editable = ({ name, code, born, number, side, hands, preset, parameters, warnings, plan }: FormValues): FormValues => ({ name, code, born, number, side, hands, preset, parameters, warnings, plan });

/** The form of a patient. Text is kept until it is saved: over hidden names, a reload and a records process that does not answer. */
export class PatientForm implements Screen {
  readonly element = h('main', { class: 'form' });
  private readonly t = texts().form;
  private typed: FormValues = { ...EMPTY, side: '' };
  private version = 0;
  /** The row in the records is damaged: saving signs it again. */
  private damaged: DamagedPatient | undefined;
  private readonly confirmed = h('input', { type: 'checkbox', id: 'hand-confirmed', 'data-testid': 'hand-confirmed' });
  private presets: Presets | undefined;
  private readonly message = new StatusMessage();
  private readonly fields = new Map<string, Field<HTMLInputElement | HTMLTextAreaElement>>();
  private readonly hands = h('div', { class: 'hands' });
  private readonly numbers = h('dl', { class: 'facts' });
  private readonly planned = h('div', { class: 'parts' });
  private readonly both = h('div', {});
  private readonly sideWrong = h('span', { class: 'wrong', role: 'alert' });
  private closed = false;

  /** @param id the patient's number; 0: a new patient */
  constructor(private readonly context: ClinicContext, private readonly id: number) { void this.open(); }

  who(): readonly [string, string] { return [this.id > 0 ? texts().form.edit : texts().form.title, '']; }
  close(): void { this.closed = true; }

  private async open(): Promise<void> {
    const { clinic } = this.context;
    try {
      if (!clinic.presets) clinic.takePresets(await clinic.api.get<Presets>('/api/presets'));
      this.presets = clinic.presets!;
      const kept = clinic.drafts.get<{ typed: FormValues; version: number; damaged?: DamagedPatient }>('form', this.id);
      if (kept) ({ typed: this.typed, version: this.version, damaged: this.damaged } = kept);
      else if (this.id > 0) await this.read();
      else {
        const { code } = await clinic.api.get<{ code: string }>('/api/patients/propose');
        const plan = this.presets.plans[0];
        this.typed = { ...this.typed, code, preset: this.presets.force[0]?.id ?? '', plan: plan?.items ?? [] };
      }
      if (!this.closed) this.build(kept !== undefined);
    } catch (problem) {
      if (this.closed) return;
      this.message.showProblem(problem);
      this.element.replaceChildren(h('section', { class: 'panel narrow' }, this.message.element, button(texts().again, 'form-again', () => void this.open())));
    }
  }

  private async read(): Promise<void> {
    const { api } = this.context.clinic;
    try {
      this.takePatient(await api.get<Patient>(`/api/patients/${this.id}`));
    } catch (problem) {
      if (!(problem instanceof RefusalError) || problem.code !== 'damaged') throw problem;
      this.damaged = await api.get<DamagedPatient>(`/api/patients/${this.id}/damaged`);
      this.typed = editable(this.damaged);
    }
  }

  private takePatient(patient: Patient): void {
    this.typed = editable(patient);
    this.version = patient.version;
  }

  private change(part: Partial<FormValues>): void {
    this.typed = { ...this.typed, ...part };
    this.context.clinic.drafts.set('form', this.id, { typed: this.typed, version: this.version, damaged: this.damaged });
  }

  private field(key: 'name' | 'code' | 'born' | 'number' | 'warnings', attributes: Readonly<Record<string, string | number | boolean>> = {}, wide = false): HTMLElement {
    const { t } = this;
    const input = key === 'warnings' ? h('textarea', { class: 'in', rows: 3, 'data-testid': 'patient-warnings', maxlength: 4000 }) : textInput(`patient-${key}`, '', attributes);
    input.value = this.typed[key];
    input.addEventListener('input', () => { this.change({ [key]: input.value }); this.fields.get(key)?.refuse(''); });
    const field = new Field(t.fields[key], input, { hint: t.hints[key] ?? '', wide });
    this.fields.set(key, field);
    return field.element;
  }

  private build(kept: boolean): void {
    const { t, context } = this;
    const save = submitButton(t.save, 'save-patient', 'go');
    const back = button(t.back, 'form-back', () => {
      context.clinic.drafts.drop('form', this.id);
      context.go(this.id > 0 ? { at: 'patient', patient: this.id } : { at: 'patients' });
    });
    const side = choice(t.fields.side, (['left', 'right', 'both'] as const).map((key) => ({ key, name: sideWords(key) })), this.typed.side, (key) => {
      this.change({ side: key as Side });
      side.choose(key);
      setText(this.sideWrong, '');
      this.showHands();
    });
    side.element.dataset.testid = 'patient-side';
    const person = panel(t.person, 'person', h('div', { class: 'grid' }, this.field('name', { maxlength: 200 }, true), this.field('code', { maxlength: 60 }), this.field('born', { type: 'date' }), this.field('number', { maxlength: 60 }),
      h('div', { class: 'field wide' }, h('span', { class: 'label' }, t.fields.side), side.element, this.sideWrong), this.field('warnings', {}, true)));
    const hands = panel(t.hands, 'sizes', this.hands, h('p', { class: 'aside' }, t.measure));
    const force = panel(t.limits, 'limits', h('label', { class: 'field' }, h('span', { class: 'label' }, t.preset), select('patient-preset', t.preset, (this.presets?.force ?? []).map(({ id }) => [id, presetName(id)]), this.typed.preset, (id) => { this.change({ preset: id }); this.showNumbers(); })), this.numbers, this.reach());
    const plan = panel(t.plan, 'planned', this.planned);
    this.element.replaceChildren(this.both, form({ class: 'form-columns', novalidate: true, 'aria-label': this.id > 0 ? t.edit : t.title }, save, this.message, () => this.save(),
      h('div', { class: 'col' }, person), h('div', { class: 'col' }, hands), h('div', { class: 'col' }, force, plan), h('div', { class: 'form-end' }, kept ? h('p', { class: 'aside', role: 'status' }, t.kept) : null, this.message.element, this.damaged ? h('label', { class: 'tick', for: 'hand-confirmed' }, this.confirmed, t.damaged.confirm) : null, back, save)));
    if (this.damaged) this.showDamaged(this.damaged);
    this.showHands();
    this.showNumbers();
    this.showPlan();
    this.fields.get(this.typed.name === '' ? 'name' : 'code')?.input.focus();
  }

  /** What the damaged row says, for comparison. None of it is taken over unseen. */
  private showDamaged({ was, unreadable }: DamagedPatient): void {
    const { t } = this;
    const sides: Readonly<Record<string, string>> = texts().sides;
    const hands = Object.entries(was.hands).map(([side, size]) => `${sides[side] ?? side} ${JSON.stringify(size)}`);
    const parameters = Object.entries(was.parameters).map(([name, value]) => (typeof value === 'number' ? parameterWords(name, value).join(' ') : name));
    const rows = [[t.fields.side, sides[was.side] ?? was.side], [t.fields.hands, hands.join(', ')], [t.fields.preset, [presetName(was.preset), ...parameters].join(', ')]];
    this.both.replaceChildren(h('section', { class: 'panel both', role: 'alert', 'data-testid': 'damaged-patient' }, h('h2', {}, t.damaged.title), h('p', {}, t.damaged.words),
      h('dl', { class: 'facts' }, ...rows.map(([name, words]) => fact(name, words))),
      unreadable.length > 0 ? h('p', { class: 'warning' }, fill(t.damaged.unreadable, { fields: unreadable.map((key) => t.fields[key as keyof typeof t.fields] ?? key).join(', ') })) : null));
  }

  private showPlan(): void {
    const { t, typed: { plan } } = this, { plans = [], goals = [] } = this.presets ?? {}, now = JSON.stringify(plan);
    const take = (items: readonly Item[]): void => {
      if (items !== plan) this.change({ plan: items });
      this.showPlan();
    };
    const start = select('patient-plan', t.planPreset, [['', t.ownPlan], ...plans.map(({ id }) => [id, presetName(id)] as const)], plans.find(({ items }) => JSON.stringify(items) === now)?.id ?? '', (id) => take(plans.find((preset) => preset.id === id)?.items ?? plan));
    redraw(this.planned, goalChoice(goals, plan, take), h('label', { class: 'field' }, h('span', { class: 'label' }, t.planPreset), start), planList(plan));
  }

  private showNumbers(): void {
    const preset = this.presets?.force.find(({ id }) => id === this.typed.preset);
    this.numbers.replaceChildren(...Object.entries({ ...preset?.parameters }).map(([name, value]) => fact(...parameterWords(name, value))));
  }

  /** Fields for this person's reach and fingers, where the program has them; an empty field means the exercise's value. */
  private reach(): HTMLElement | null {
    const known = (this.context.model.scene?.parameters ?? []).filter(({ name }) => (OF_PERSON as readonly string[]).includes(String(name)));
    if (known.length === 0) return null;
    return h('details', { open: OF_PERSON.some((name) => name in this.typed.parameters) }, h('summary', {}, this.t.reach), h('div', { class: 'grid' }, ...known.map((parameter) => {
      const view = viewOf(parameter, consoleTexts().parameters.names);
      const now = this.typed.parameters[view.name];
      const input = textInput(`patient-${view.name}`, now === undefined ? '' : String(Number((now * view.factor).toPrecision(4))), { inputmode: 'decimal' });
      const field = new Field(`${view.label}, ${view.unit}`, input, { hint: `${view.lower}–${view.upper}` });
      input.addEventListener('input', () => {
        const text = input.value.trim().replace(',', '.'), value = Number(text);
        const { [view.name]: _, ...others } = this.typed.parameters;
        const good = text === '' || (Number.isFinite(value) && value >= view.lower && value <= view.upper);
        field.refuse(good ? '' : fill(consoleTexts().parameters.notANumber, { lo: view.lower, hi: view.upper }));
        this.change({ parameters: good && text !== '' ? { ...others, [view.name]: value / view.factor } : others });
      });
      this.fields.set(`parameters.${view.name}`, field);
      return field.element;
    })));
  }

  private showHands(): void {
    const { side } = this.typed;
    const sides: OneSide[] = side === 'both' ? ['left', 'right'] : side === '' ? [] : [side];
    for (const key of [...this.fields.keys()]) if (key.startsWith('hands.')) this.fields.delete(key);
    this.hands.replaceChildren(...(sides.length === 0 ? [h('p', { class: 'none' }, this.t.sideFirst)] : sides.map((of) => this.hand(of))));
  }

  private hand(side: OneSide): HTMLElement {
    const { t } = this;
    const drawn = h('div', {});
    const size = (): Size => this.typed.hands[side] ?? MEDIAN;
    if (!this.typed.hands[side]) this.typed = { ...this.typed, hands: { ...this.typed.hands, [side]: MEDIAN } };
    const draw = (): void => drawn.replaceChildren(handPicture(side, size(), fill(t.handImage, { side: sideWords(side), length: Math.round(size().length_m * 1000), breadth: Math.round(size().breadth_m * 1000) })));
    const slider = (key: 'length_m' | 'breadth_m', [low, high]: readonly [number, number]): HTMLElement => {
      const input = h('input', { type: 'range', min: low * 1000, max: high * 1000, step: 1, value: Math.round(size()[key] * 1000), 'data-testid': `hand-${side}-${key}`, class: 'slide' });
      const shown = h('output', { class: 'num' }, `${input.value} mm`);
      input.addEventListener('input', () => {
        this.change({ hands: { ...this.typed.hands, [side]: { ...size(), [key]: Number(input.value) / 1000 } } });
        setText(shown, `${input.value} mm`);
        field.refuse('');
        draw();
      });
      const field = new Field(t[key], input);
      this.fields.set(`hands.${side}.${key}`, field);
      field.element.querySelector('label')!.append(shown);
      return field.element;
    };
    draw();
    return h('fieldset', { class: 'hand' }, h('legend', {}, sideWords(side)), drawn, slider('length_m', LENGTH_M), slider('breadth_m', BREADTH_M));
  }

  private async save(): Promise<void> {
    const { t, typed, context: { clinic } } = this;
    this.message.show('');
    const future = typed.born !== '' && new Date(`${typed.born}T00:00:00`) > new Date();
    setText(this.sideWrong, typed.side === '' ? t.noSide : '');
    if (typed.side === '') this.element.querySelector<HTMLElement>('[data-testid=patient-side] button')?.focus();
    // Every mistake is marked at once, and the first one has the focus.
    if (future) this.refuse('born', t.bornLater);
    if (typed.name.trim() === '') this.refuse('name', t.noName);
    if (future || typed.side === '' || typed.name.trim() === '') return;
    if (this.damaged && !this.confirmed.checked) {
      this.message.show(t.damaged.confirmFirst);
      return this.confirmed.focus();
    }
    const hands = Object.fromEntries(Object.entries(typed.hands).filter(([side]) => typed.side === 'both' || side === typed.side));
    const body = { ...typed, name: typed.name.trim(), code: typed.code.trim(), hands };
    try {
      const saved = this.damaged
        ? await clinic.api.send<Patient>('POST', `/api/patients/${this.id}/sign_again`, { ...body, confirmed: true })
        : this.id > 0
        ? await clinic.api.send<Patient>('PUT', `/api/patients/${this.id}`, { ...body, version: this.version })
        : await clinic.api.send<Patient>('POST', '/api/patients', body);
      clinic.drafts.drop('form', this.id);
      this.context.go({ at: 'patient', patient: saved.id });
    } catch (problem) {
      if (problem instanceof RefusalError && problem.code === 'changed' && problem.more.now) this.showBoth(problem.more.now as Patient);
      else if (problem instanceof RefusalError && (problem.field !== '' || problem.code === 'code_exists')) this.refuse(problem.field || 'code', problemWords(problem));
      else this.message.show(`${problemWords(problem)} ${t.stays}`);
    }
  }

  /** Shows the error at its field and focuses it; typed text is kept. */
  private refuse(key: string, words: string): void {
    const field = this.fields.get(key) ?? [...this.fields].find(([name]) => name.startsWith(`${key}.`) || key.startsWith(`${name}.`))?.[1];
    if (!field) return this.message.show(words);
    const details = field.element.closest('details');
    if (details) details.open = true;
    field.refuse(words);
    field.input.focus();
  }

  /** Another account saved the same patient meanwhile: shows both versions beside each other. */
  private showBoth(now: Patient): void {
    const { t, typed } = this;
    const rows = differing(typed, now);
    const words = (value: unknown): string => (typeof value === 'string' ? value : JSON.stringify(value));
    const mine = button(t.both.mine, 'keep-mine', () => { this.version = now.version; this.both.replaceChildren(); void this.save(); }, 'go');
    const theirs = button(t.both.theirs, 'take-theirs', () => {
      this.context.clinic.drafts.drop('form', this.id);
      this.takePatient(now);
      this.both.replaceChildren();
      this.build(false);
    });
    this.both.replaceChildren(h('section', { class: 'panel both', role: 'alert', 'data-testid': 'both-texts' }, h('h2', {}, t.both.title), h('p', {}, t.both.words),
      h('table', { class: 'table' }, h('thead', {}, h('tr', {}, h('td'), h('th', { scope: 'col' }, t.both.yours), h('th', { scope: 'col' }, t.both.now))),
        h('tbody', {}, ...rows.map((key) => h('tr', {}, h('th', { scope: 'row' }, t.fields[key as keyof typeof t.fields] ?? key), h('td', {}, words(typed[key])), h('td', {}, words(now[key])))))), h('div', { class: 'pair' }, mine, theirs)));
    this.both.scrollIntoView({ block: 'start' });
    mine.focus();
  }
}

/** The fields in which two versions of a patient differ. */
export function differing(mine: FormValues, theirs: PatientText): (keyof PatientText)[] {
  return (Object.keys(EMPTY) as (keyof PatientText)[]).filter((key) => JSON.stringify(mine[key]) !== JSON.stringify(theirs[key]));
}
