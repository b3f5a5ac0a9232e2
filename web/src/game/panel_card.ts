// The card of an exercise without its own view: its values, each with its range and goal band.
import { AnswerButtons, type Chosen } from '../exercises/answer_buttons';
import { h, setAttribute, setText } from '../shared/dom';
import type { ExercisePanel, PanelValueView } from '../exercises/panel';
import { Steering, type WorldStateT } from '../protocol';
import { hasHardware } from '../shared/hardware';

/** Time for which the last event is shown [ms]. */
const EVENT_MS = 4000;

interface Row { readonly row: HTMLElement; readonly label: HTMLElement; readonly number: HTMLElement; readonly unit: HTMLElement; readonly track: HTMLElement; readonly fill: HTMLElement; readonly band: HTMLElement }

function makeRow(name: string): Row {
  const label = h('span'), number = h('b', { class: 't-read' }), unit = h('span', { class: 't-s' });
  const band = h('u'), fill = h('i');
  const track = h('div', { class: 'range', role: 'meter', 'aria-valuemin': 0, 'aria-valuemax': 100 }, band, fill);
  const row = h('li', { 'data-value': name }, h('span', { class: 't-s' }, label), h('span', { class: 'figure' }, number, ' ', unit), track);
  return { row, label, number, unit, track, fill, band };
}

export class PanelCard {
  readonly element = h('section', { class: 'card values', 'data-testid': 'panel', hidden: true });
  private readonly title = h('h1', { class: 't-m' });
  private readonly list = h('ul');
  private readonly event = h('p', { class: 't-s', role: 'status', 'data-testid': 'panel-event' });
  private readonly rows = new Map<string, Row>();
  private shown_ms = -Infinity;

  private readonly answers: AnswerButtons;

  constructor(answer: (chosen: Chosen) => void) {
    this.answers = new AnswerButtons('button plain t-s', answer);
    this.element.append(this.title, this.list, this.answers.element, this.event);
  }

  show(panel: ExercisePanel | null, state: WorldStateT, now_ms: number): void {
    this.element.hidden = panel === null;
    if (!panel) return;
    setText(this.title, panel.title);
    this.answers.show(panel, state, state.steering === Steering.Person || hasHardware(state));
    const values = panel.values(state);
    if (values.map(({ name }) => name).join() !== [...this.rows.keys()].join()) this.build(values);
    for (const value of values) this.update(this.rows.get(value.name)!, value);
    if (now_ms - this.shown_ms > EVENT_MS) setText(this.event, '');
  }

  /** Shows an event for EVENT_MS. */
  showEvent(words: string, now_ms: number): void {
    this.shown_ms = now_ms;
    setText(this.event, words);
  }

  private build(values: readonly PanelValueView[]): void {
    this.rows.clear();
    for (const { name } of values) this.rows.set(name, makeRow(name));
    this.list.replaceChildren(...[...this.rows.values()].map(({ row }) => row));
  }

  private update({ row, label, number, unit, track, fill, band }: Row, value: PanelValueView): void {
    setText(label, value.label);
    setText(number, value.number);
    setText(unit, value.unit);
    setAttribute(row, 'data-zone', value.zone);
    setAttribute(track, 'aria-label', value.label);
    setAttribute(track, 'aria-valuenow', String(Math.round(100 * value.share)));
    setAttribute(track, 'aria-valuetext', value.shown);
    fill.style.transform = `scaleX(${value.share.toFixed(3)})`;
    band.hidden = value.goal === null;
    if (!value.goal) return;
    band.style.left = `${(100 * value.goal.low).toFixed(1)}%`;
    band.style.width = `${(100 * (value.goal.high - value.goal.low)).toFixed(1)}%`;
  }
}
