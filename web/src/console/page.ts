import type { Connection } from '../net/connection';
import { PacedView, PICTURES_HZ, type HandLook } from '../scene/paced_view';
import type { Quality } from '../scene/quality';
import { store, stored } from '../shared/i18n';
import { answerPresses } from '../shared/pressed';
import { BigControls } from './big_controls';
import { panelKey } from './panel_key';
import { h, setAttribute } from './dom';
import { ExercisePanelView } from './panel_view';
import { Header } from './header';
import { texts } from './i18n';
import { listenForKeys } from './keys';
import { ConsoleModel, type Panel } from './model';
import { NoticesPanel } from './notices';
import { ParametersPanel } from './parameters';
import { PlotsPanel } from './plots_panel';
import { RecordingsPanel, SavedWatch } from './recordings';
import { SafetyPanel } from './safety';
import { SessionLine } from './session_line';
import { SetupPanel } from './setup';
import { TimingPanel } from './timing';
import { ScenePanel } from './scene_panel';

/** Texts and numbers are refreshed this often [ms]; a faster rate is unreadable. */
const REFRESH_MS = 200;

const STORED_VIEW = 'wholehand.view';

/** A frame that is early by this much counts as on time [ms]. */
const EARLY_MS = 2;

/** The therapist's page: panels around one model, rebuilt for a language, a theme or a scene. */
export class ConsolePage {
  private readonly model: ConsoleModel;
  private panels: Panel[] = [];
  private header: Header | undefined;
  private notices: NoticesPanel | undefined;
  private plots: PlotsPanel | undefined;
  private parameters: ParametersPanel | undefined;
  private viewPanel: ScenePanel | undefined;
  private exercise: ExercisePanelView | undefined;
  private view: PacedView | undefined;
  private viewTried = false;
  private look: HandLook = 'skin';
  private readonly watch = new SavedWatch();
  /** The same condition as in console.css. */
  private readonly narrow = matchMedia('(max-width: 1199px), (max-height: 639px)');
  private refreshed_ms = -Infinity;
  private drawn_ms = -Infinity;
  private shownPanelKey = '';
  /** Plots, tables and timing are the engineer's view; the therapist's view is the default. */
  private engineer = (new URLSearchParams(location.search).get('view') ?? stored(STORED_VIEW)) === 'engineer';

  constructor(private readonly root: HTMLElement, private readonly connection: Connection) {
    this.model = new ConsoleModel(connection);
    this.model.onScene = () => {
      // A new recording or session rebuilds nothing, so that half-typed text is kept.
      const built = panelKey(this.model.scene);
      if (built !== this.shownPanelKey) this.build();
      this.shownPanelKey = built;
      if (this.model.scene) this.view?.setScene(this.model.scene);
    };
    connection.on('events', (events) => this.exercise?.take(events));
    connection.on('bodies', (bodies) => this.view?.setBodies(bodies));
    this.model.onRefused = (what, reason) => this.notices?.refuse(what, reason);
    listenForKeys(this.model, () => this.header);
    answerPresses(document);
    this.narrow.addEventListener('change', () => this.build());
    this.build();
  }

  /** Quality of the 3D view: "high", "low", or "none" without one. */
  get quality(): Quality | 'none' {
    return this.view?.drawnIn ?? 'none';
  }

  /** Builds every panel; the therapist's choices are kept. */
  build(): void {
    const axis = this.plots?.axisName ?? 'finger_flexion';
    const group = this.parameters?.openGroup ?? 0;
    const focused = document.activeElement?.getAttribute('data-testid');
    const parameters = this.parameters?.keep();
    for (const panel of this.panels) panel.close?.();
    document.title = texts().title;
    const { model } = this;
    const { engineer } = this;
    this.root.classList.add('live-page');
    this.root.dataset.view = engineer ? 'engineer' : 'therapy';
    this.header = new Header(model, () => this.build(), engineer);
    const line = new SessionLine(model);
    this.notices = new NoticesPanel(model);
    this.plots = new PlotsPanel(model, axis);
    this.viewPanel = new ScenePanel(model, this.look, (look) => { this.look = look; });
    this.exercise = new ExercisePanelView(model);
    const safety = new SafetyPanel(model, this.engineer);
    const timing = new TimingPanel(model);
    const setup = new SetupPanel(model, engineer);
    const big = new BigControls(model);
    this.parameters = new ParametersPanel(model, group, parameters);
    const recordings = new RecordingsPanel(model, this.watch);
    this.panels = [this.header, line, this.notices, this.viewPanel, this.exercise, safety, setup, this.parameters, recordings, ...(engineer ? [this.plots, timing] : [big])];
    const seen = h('div', { class: 'col' }, this.viewPanel.element, this.exercise.element, safety.element);
    const done = h('div', { class: 'col' }, setup.element, ...(engineer ? [this.parameters.element] : []), recordings.element);
    let parts: HTMLElement[];
    if (engineer) {
      // On a tablet or telephone the plots come last, below the panels that must be at hand.
      (this.narrow.matches ? this.plots.element : seen).append(timing.element);
      parts = this.narrow.matches ? [seen, done, this.plots.element] : [this.plots.element, seen, done];
    } else parts = [seen, h('div', { class: 'col' }, big.element, this.parameters.element), done];
    this.root.replaceChildren(this.header.element, h('div', { class: 'below' }, line.element, this.notices.element, this.viewButton()), h('main', {}, ...parts));
    if (this.viewTried) this.viewPanel.setView(this.view);
    if (focused) this.root.querySelector<HTMLElement>(`[data-testid="${focused}"]`)?.focus();
    this.model.fresh = true;
    this.refreshed_ms = -Infinity;
  }

  /** Loads the 3D view; without WebGL the page shows a text instead. */
  async loadView(): Promise<void> {
    try {
      this.view = await PacedView.load();
      if (this.model.scene) this.view.setScene(this.model.scene);
      this.view.setBodies(this.connection.bodies);
    } catch (problem) {
      console.warn('The 3D view cannot be drawn here:', problem);
    }
    this.viewTried = true;
    this.viewPanel?.setView(this.view);
  }

  /**
   * Time between two drawings of plots and picture [ms]. A machine without high quality draws both on its processor,
   * usually beside the patient's game.
   */
  private get pace_ms(): number {
    return this.quality === 'high' ? 0 : 1000 / PICTURES_HZ.low;
  }

  /** Draws the due parts of the page. @returns whether plots and picture were drawn */
  frame(now_ms: number): boolean {
    if (now_ms - this.refreshed_ms >= REFRESH_MS) {
      this.refreshed_ms = now_ms;
      setAttribute(document.body, 'data-state', this.model.status.name);
      for (const panel of this.panels) panel.refresh?.();
    }
    if (!this.model.fresh || now_ms - this.drawn_ms < this.pace_ms - EARLY_MS) return false;
    this.model.fresh = false;
    this.drawn_ms = now_ms;
    for (const panel of this.panels) panel.draw?.();
    return true;
  }

  private viewButton(): HTMLElement {
    const toggle = (): void => {
      this.engineer = !this.engineer;
      store(STORED_VIEW, this.engineer ? 'engineer' : 'therapy');
      this.build();
    };
    return h('button', { type: 'button', class: 'b', 'data-testid': 'view', onclick: toggle }, this.engineer ? texts().therapy : texts().engineer);
  }
}
