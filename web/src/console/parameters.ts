import { ParameterGroup, type ParameterT } from '../protocol';
import { fill } from '../shared/i18n';
import { h, setText, setAttribute } from './dom';
import { fixed } from '../shared/format';
import { handFacts } from './hand_facts';
import { texts } from './i18n';
import type { ConsoleModel, Panel } from './model';
import { meantBySlider, parsed, ParameterTarget, roundAway, viewOf, type ParameterView } from './parameter_model';

/** A refusal is shown for this long [ms]. */
const REFUSAL_MS = 8000;

/** The state of a parameter's row that is kept when its panel is rebuilt. */
interface KeptRow { readonly target: ParameterTarget; readonly typed: string | undefined }
type KeptRows = ReadonlyMap<string, KeptRow>;

/** A slider and a number for one parameter, with its range, its ramp, and the reason of a refusal. */
class ParameterRow {
  readonly element: HTMLElement;
  private readonly t = texts().parameters;
  private readonly view: ParameterView;
  private readonly target: ParameterTarget;
  private readonly slider: HTMLInputElement;
  private readonly number: HTMLInputElement;
  private readonly ramp = h('span', { class: 'ramp', hidden: true });
  private readonly initial: number;
  private readonly refusal: HTMLElement;
  private refusalTimer: ReturnType<typeof setTimeout> | undefined;
  private typing = false;   // the person typed since the last request

  constructor(private readonly model: ConsoleModel, private readonly index: number, parameter: ParameterT, kept?: KeptRow) {
    this.view = viewOf(parameter, this.t.names);
    this.initial = roundAway(parameter.initial * this.view.factor);
    this.target = kept?.target ?? new ParameterTarget(model.state?.parameters[index] ?? parameter.initial);
    const { view } = this;
    const lo = fixed(view.lower, view.decimals);
    const hi = fixed(view.upper, view.decimals);
    const range = fill(this.t.range, { name: view.label, lo, hi, unit: view.unit });
    const id = `parameter-${view.name}`;
    this.refusal = h('p', { class: 'refusal', role: 'alert', id: `${id}-refusal`, hidden: true });
    this.number = h('input', { type: 'text', inputmode: 'decimal', id, autocomplete: 'off', 'aria-describedby': `${id}-refusal`, 'data-testid': id });
    this.slider = h('input', { type: 'range', min: view.lower, max: view.upper, step: view.step, 'aria-label': range, 'data-testid': `${id}-slider` });
    this.element = h('div', { class: 'par', 'data-parameter': view.name },
      h('label', { for: id }, view.label, this.ramp), h('span', { class: 'v' }, this.number, h('span', { class: 'unit' }, view.unit)),
      h('div', { class: 'r' }, h('span', {}, trimmed(lo)), this.slider, h('span', {}, trimmed(hi))), this.refusal);
    const slid = (): number => meantBySlider(Number(this.slider.value), this.initial, view.step);
    this.slider.addEventListener('input', () => { this.number.value = fixed(slid(), view.decimals); });
    this.slider.addEventListener('change', () => void this.ask(slid() / view.factor));
    this.number.addEventListener('input', () => { this.typing = true; });
    this.number.addEventListener('change', () => { if (this.typing) this.typed(); });
    // The browser does not report a change for text that was restored from the earlier panel.
    this.number.addEventListener('keydown', (event) => { if (event.key === 'Enter' && this.typing) this.typed(); });
    this.refresh(true);
    if (kept?.typed === undefined) return;
    this.number.value = kept.typed;
    this.typing = true;
  }

  get name(): string {
    return this.view.name;
  }

  keep(): KeptRow {
    return { target: this.target, typed: this.typing ? this.number.value : undefined };
  }

  refresh(always = false): void {
    this.target.onState(this.model.state?.parameters[this.index] ?? this.target.now, this.model.stated_ms);
    const { target } = this.target;
    const ramping = target !== undefined;
    if (this.ramp.hidden === ramping) this.ramp.hidden = !ramping;
    // Shows both the present and the requested value: a moved slider is not yet the limit in force.
    if (ramping) setText(this.ramp, fill(this.t.ramp, { now: this.text(this.target.now), v: this.text(target) }));
    // A control that the person is using, or has half typed into, is not overwritten.
    const half = this.typing && document.activeElement === this.number;
    const touched = half || this.slider.matches(':active');
    if (touched && !always) return;
    const shown = this.text(this.target.shown);
    if (!half && this.number.value !== shown) this.write(shown);
    const value = String(this.target.shown * this.view.factor);
    if (Math.abs(Number(this.slider.value) - Number(value)) > this.view.step / 2) this.slider.value = value;
    setAttribute(this.slider, 'aria-valuetext', `${shown} ${this.view.unit}`);
  }

  /** Writes a value and keeps a selection: a changing value must not mix with typed text. */
  private write(shown: string): void {
    const { number } = this;
    const selected = document.activeElement === number && number.selectionStart !== number.selectionEnd;
    number.value = shown;
    if (selected) number.select();
  }

  private text(value: number): string {
    return fixed(value * this.view.factor, this.view.decimals);
  }

  private typed(): void {
    this.typing = false;
    const value = parsed(this.number.value, this.view);
    if (value !== undefined) void this.ask(value);
    else {
      const { lower, upper, decimals } = this.view;
      this.refuse(fill(this.t.notANumber, { lo: fixed(lower, decimals), hi: fixed(upper, decimals) }));
    }
  }

  private async ask(value: number): Promise<void> {
    this.clearRefusal();
    this.typing = false;
    this.target.ask(value, this.model.stated_ms);
    const { view, model } = this;
    const answer = await model.command(view.label, () => model.connection.setParameter(view.name, value), { quietly: true });
    if (answer.accepted) this.refresh();
    else this.refuse(fill(this.t.refused, { reason: answer.reason }));
  }

  private refuse(reason: string): void {
    this.typing = false;
    this.target.refuse();
    this.number.value = this.text(this.target.shown);
    this.refresh(true);
    this.refusal.hidden = false;
    setText(this.refusal, reason);
    setAttribute(this.number, 'aria-invalid', 'true');
    clearTimeout(this.refusalTimer);
    this.refusalTimer = setTimeout(() => this.clearRefusal(), REFUSAL_MS);
  }

  private clearRefusal(): void {
    this.refusal.hidden = true;
    setText(this.refusal, '');
    this.number.removeAttribute('aria-invalid');
  }
}

// The ends of a slider need only enough digits to be recognized.
function trimmed(text: string): string {
  return text.replace(/([.,]\d*?)0+$/, '$1').replace(/[.,]$/, '');
}

/** All live parameters in their three groups. */
export class ParametersPanel implements Panel {
  readonly element: HTMLElement;
  private readonly tabs: HTMLButtonElement[] = [];
  private readonly pages: HTMLElement[] = [];
  private readonly rows: ParameterRow[] = [];

  /** @param kept requests and half-typed text of the earlier panel, by name */
  constructor(private readonly model: ConsoleModel, private group: number, private readonly kept: KeptRows = new Map()) {
    const t = texts().parameters;
    for (const key of Object.keys(t.groups).map(Number)) this.addGroup(key, t.groups[key], t.none);
    const tablist = h('div', { class: 'seg', role: 'tablist', 'aria-label': t.title }, ...this.tabs);
    tablist.addEventListener('keydown', (event) => this.onArrow(event));
    this.element = h('section', { class: 'panel parameters', 'aria-label': t.title },
      h('div', { class: 'hd' }, h('h2', {}, t.title), tablist), ...this.pages);
    this.show(this.group);
  }

  /** Which group is open. */
  get openGroup(): number {
    return this.group;
  }

  refresh(): void {
    for (const row of this.rows) row.refresh();
  }

  /** The state of all rows, for the next panel. */
  keep(): KeptRows {
    return new Map(this.rows.map((row) => [row.name, row.keep()]));
  }

  private addGroup(key: number, name: string, none: string): void {
    const rows = (this.model.scene?.parameters ?? [])
      .map((parameter, index) => ({ parameter, index }))
      .filter(({ parameter }) => parameter.group === key)
      .map(({ parameter, index }) => new ParameterRow(this.model, index, parameter, this.kept.get(String(parameter.name))));
    this.rows.push(...rows);
    const tab = h('button', { type: 'button', role: 'tab', id: `group-${key}`, 'aria-controls': `page-${key}`, 'data-testid': `group-${key}` }, name);
    tab.addEventListener('click', () => this.show(key));
    this.tabs.push(tab);
    const facts = key === ParameterGroup.Hand && this.model.scene ? handFacts(this.model.scene) : null;
    const content = facts || rows.length > 0 ? [...rows.map((row) => row.element), facts] : [h('p', { class: 'none' }, none)];
    this.pages.push(h('div', { role: 'tabpanel', id: `page-${key}`, 'aria-labelledby': `group-${key}`, class: 'page', tabindex: 0 }, ...content));
  }

  private show(key: number): void {
    this.group = key;
    this.tabs.forEach((tab, i) => {
      const on = i === key;
      tab.setAttribute('aria-selected', String(on));
      tab.tabIndex = on ? 0 : -1;
      this.pages[i].hidden = !on;
    });
  }

  private onArrow(event: KeyboardEvent): void {
    const step = event.key === 'ArrowRight' ? 1 : event.key === 'ArrowLeft' ? -1 : 0;
    if (step === 0) return;
    event.preventDefault();
    this.show((this.group + step + this.tabs.length) % this.tabs.length);
    this.tabs[this.group].focus();
  }
}
