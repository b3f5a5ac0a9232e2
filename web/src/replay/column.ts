import { sessionWords } from '../console/title_words';
import type { GameBodyShown } from '../net/game_bodies';
import { PacedView, type HandLook } from '../scene/paced_view';
import { h } from '../console/dom';
import { ExercisePanelView } from '../console/panel_view';
import { ScenePanel } from '../console/scene_panel';
import type { Span } from '../console/plot_source';
import type { PlotHands } from '../console/time_plot';
import { factsPanel } from './facts_panel';
import { texts } from './i18n';
import { MomentsPanel } from './moments_panel';
import { ReplayPlots, type PlotMaker } from './plots';
import { RedrawTimer } from './redraw_needed';
import type { ReplaySide } from './side';

export interface ColumnHands extends PlotHands {
  look(look: HandLook): void;
  /** Called when another axis or value was chosen: all columns show it. */
  choice(): void;
}

/** All panels of one recording. */
export class Column {
  readonly view: ScenePanel;
  readonly plots: ReplayPlots;
  readonly exercise: ExercisePanelView;
  readonly facts: HTMLElement;
  readonly moments: MomentsPanel;
  private readonly redraw = new RedrawTimer();
  private picture: PacedView | undefined;
  private drawnBodies: readonly GameBodyShown[] | undefined;

  constructor(readonly side: ReplaySide, maker: PlotMaker, look: HandLook, hands: ColumnHands) {
    this.view = new ScenePanel(side, look, (chosen) => { hands.look(chosen); this.redraw.begin(performance.now()); });
    this.plots = new ReplayPlots(side, maker, hands, () => hands.choice());
    this.exercise = new ExercisePanelView({ get scene() { return side.hasScene ? side.scene : null; }, get state() { return side.state; } });
    this.facts = factsPanel(side.about, side.about.ticks_missing, side.scene);
    this.moments = new MomentsPanel(side, (time_s) => hands.seek(time_s));
  }

  setView(view: PacedView | undefined): void {
    this.picture = view;
    this.drawnBodies = undefined;
    if (this.side.hasScene) this.view.setView(view);
    else this.view.element.hidden = true;
  }

  /** Draws after the window, or the known data in it, has changed. */
  drawWindow(window: Span): void {
    this.side.look(window);
    this.plots.draw();
    this.plots.refresh();
    this.moments.show(window);
  }

  /** Draws after another state was chosen. */
  drawState(now_ms: number, playing: boolean): void {
    this.redraw.begin(now_ms);
    const { bodies } = this.side;
    if (bodies !== this.drawnBodies) this.picture?.setBodies(bodies);
    this.drawnBodies = bodies;
    this.view.draw(!playing);
  }

  /** Continues to draw for a moment while contacts fade in and the hand is still being made. @param whole everything can be drawn */
  settle(now_ms: number, whole: boolean): void {
    if (this.redraw.isDue(now_ms, whole)) this.view.draw();
  }

  refresh(): void {
    this.view.refresh();
    this.exercise.refresh();
    this.plots.refresh();
  }

  close(): void {
    this.view.close();
    this.plots.close();
  }
}

/** The columns of a page side by side; a single column has its panels at its side. */
export function arranged(columns: readonly Column[]): HTMLElement {
  const [only] = columns;
  if (columns.length === 1) {
    return h('main', { class: 'replay' }, h('div', { class: 'col scrolls', tabindex: 0, role: 'group', 'aria-label': texts().plots.title }, only.plots.element, hint()),
      h('div', { class: 'col scrolls aside-col' }, only.view.element, only.exercise.element, only.moments.element, only.facts));
  }
  const t = texts().sides;
  return h('main', { class: 'replay beside' }, ...columns.map(({ side, view, exercise, plots, moments, facts }, i) => {
    const letter = i === 0 ? t.a : t.b;
    const called = sessionWords({ ...side.about, name: side.about.name || side.source.name });
    return h('div', { class: 'col' }, h('h2', { class: 'called' }, h('b', {}, letter), h('bdi', { title: called }, called)),
      view.element, plots.element, hint(), exercise.element, moments.element, facts);   // plots of both columns at the same height
  }));
}

/** Help on the input that a plot accepts. */
function hint(): HTMLElement {
  return h('p', { class: 'hint' }, texts().plots.hint);
}
