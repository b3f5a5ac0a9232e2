import { AnswerButtons } from '../exercises/answer_buttons';
import { ExercisePanel, type PanelValueView } from '../exercises/panel';
import type { EventT } from '../protocol';
import { h, setText, setAttribute } from './dom';
import { texts } from './i18n';
import type { ConsoleModel, Panel } from './model';

interface Row { readonly element: HTMLElement; readonly value: HTMLElement; readonly track: HTMLElement; readonly fill: HTMLElement; readonly band: HTMLElement }

/** Shows the panel of an exercise: instruction, values with range and goal band, the last event. */
export class ExercisePanelView implements Panel {
  readonly element: HTMLElement;
  private readonly t = texts();
  private readonly panel: ExercisePanel | null;
  private readonly rows: Row[] = [];
  private readonly instruction = h('h2', { 'data-testid': 'exercise-instruction' });
  private readonly event = h('span', { class: 'aside', 'data-testid': 'exercise-event' });

  /** None in a replay. */
  private readonly answers: AnswerButtons | undefined;

  constructor(private readonly model: Pick<ConsoleModel, 'scene' | 'state'> & Partial<Pick<ConsoleModel, 'command' | 'connection'>>) {
    this.panel = ExercisePanel.of(model.scene);
    const { panel, t } = this;
    const values = panel && model.state ? panel.values(model.state) : [];
    this.rows = values.map((value) => makeRow(value));
    const { command, connection } = model;
    this.answers = command && connection && new AnswerButtons('b', (chosen) => void command.call(model, t.exercise.answer, () => connection.choose(chosen)));
    this.element = h('section', { class: 'panel exercise', 'aria-label': panel?.title || t.exercise.title, hidden: panel === null },
      h('div', { class: 'hd' }, this.instruction, this.event), this.answers?.element ?? null, ...this.rows.map(({ element }) => element));
    this.refresh();
  }

  refresh(): void {
    const { panel, model: { state } } = this;
    if (!panel) return;
    setText(this.instruction, (state && panel.instruction(state)) || panel.title);
    if (!state) return;
    this.answers?.show(panel, state, true);
    const values = panel.values(state);
    if (this.rows.length === 0) this.grow(values);
    values.forEach((value, i) => update(this.rows[i], value));
  }

  /** Takes events, and shows the last one that has words. */
  take(events: readonly EventT[]): void {
    for (const event of events) {
      const words = this.panel?.event(event.type);
      if (words) setText(this.event, words);
    }
  }

  /** Adds the values that the first state brings; it may come after the scene. */
  private grow(values: readonly PanelValueView[]): void {
    this.rows.push(...values.map((value) => makeRow(value)));
    this.element.append(...this.rows.map(({ element }) => element));
  }
}

function makeRow({ name, label }: PanelValueView): Row {
  const value = h('span', { class: 'num' }), fill = h('i'), band = h('u');
  const track = h('span', { class: 'tr', role: 'meter', 'aria-label': label, 'aria-valuemin': 0, 'aria-valuemax': 100 }, band, fill);
  return { element: h('div', { class: 'lim', 'data-value': name }, h('span', {}, label), track, value), value, track, fill, band };
}

function update({ element, value, track, fill, band }: Row, view: PanelValueView): void {
  setText(value, view.shown);
  setAttribute(element, 'data-zone', view.zone);
  setAttribute(track, 'aria-valuenow', String(Math.round(100 * view.share)));
  setAttribute(track, 'aria-valuetext', view.shown);
  fill.style.width = `${(100 * view.share).toFixed(1)}%`;
  if (band.hidden !== (view.goal === null)) band.hidden = view.goal === null;
  if (!view.goal) return;
  band.style.left = `${(100 * view.goal.low).toFixed(1)}%`;
  band.style.width = `${(100 * (view.goal.high - view.goal.low)).toFixed(1)}%`;
}
