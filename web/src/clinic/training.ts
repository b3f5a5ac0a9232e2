import { BigControls } from '../console/big_controls';
import { panelKey } from '../console/panel_key';
import { h, setText } from '../console/dom';
import type { Panel } from '../console/model';
import { ExercisePanelView } from '../console/panel_view';
import { ScenePanel } from '../console/scene_panel';
import { RunState, type EventT } from '../protocol';
import type { HandLook, PacedView } from '../scene/paced_view';
import { Changes } from '../shared/changes';
import { fill } from '../shared/i18n';
import { texts } from './i18n';
import type { ClinicContext } from './clinic_context';
import type { OneSide } from './records';
import { button } from './ui';
import { sideWords } from './words';

/** A gentle stop that takes longer than this has failed [ms]. */
const STOPPED_WITHIN_MS = 5000;

/** Whether something is rendered, or is paused. A loop that does not answer has not ended. */
export const running = ({ model: { status: { name }, state } }: ClinicContext): boolean =>
  ['rendering', 'paused'].includes(name) || (name === 'silent' && state?.runState === RunState.Rendering);

/** Stops gently and waits until no effort is rendered; false if it does not end. */
export async function gently(context: ClinicContext, words: string): Promise<boolean> {
  const { model } = context;
  const pushes = (): boolean => running(context) || model.state?.runState === RunState.Stopping;
  if (running(context) && !(await model.command(words, () => model.connection.stop())).accepted) return false;
  const end_ms = performance.now() + STOPPED_WITHIN_MS;
  while (pushes() && performance.now() < end_ms) await new Promise((resolve) => setTimeout(resolve, 50));
  return !pushes();
}

/** The picture, the exercise's panel and the most used controls, of the station's current scene. */
export class Training {
  readonly picture = h('div', { class: 'picture' });
  readonly controls = h('div', { class: 'controls' });
  private panels: Panel[] = [];
  private exercise: ExercisePanelView | undefined;
  private scenePanel: ScenePanel | undefined;
  private look: HandLook = 'skin';
  /** null: it cannot be drawn here; undefined: it was not tried yet. */
  private view: PacedView | null | undefined;
  private readonly changes = new Changes();
  private closed = false;

  constructor(private readonly context: ClinicContext) {}

  begin(): void {
    const { context } = this;
    this.sceneChanged();
    void context.picture().then((view) => {
      if (this.closed) return;
      this.view = view ?? null;
      if (view && context.model.scene) view.setScene(context.model.scene);
      view?.setBodies(context.connection.bodies);
      this.scenePanel?.setView(view);
    });
  }

  /** Rebuilds the panels after the program loaded another exercise or hand. */
  sceneChanged(): void {
    const { model } = this.context;
    if (model.scene) this.view?.setScene(model.scene);
    if (!this.changes.of(panelKey(model.scene))) return;
    this.closePanels();
    this.scenePanel = new ScenePanel(model, this.look, (look) => { this.look = look; });
    this.exercise = new ExercisePanelView(model);
    const big = new BigControls(model);
    this.panels = [this.scenePanel, this.exercise, big];
    this.picture.replaceChildren(this.scenePanel.element, this.exercise.element);
    this.controls.replaceChildren(big.element);
    if (this.view !== undefined) this.scenePanel.setView(this.view ?? undefined);
  }

  refresh(): void { for (const each of this.panels) each.refresh?.(); }
  draw(): void { this.scenePanel?.draw(); }
  take(events: readonly EventT[]): void { this.exercise?.take(events); }

  close(): void {
    this.closed = true;
    this.closePanels();
  }

  private closePanels(): void { for (const each of this.panels) each.close?.(); }
}

/** Asks once before the first start which hand is in the device, since a wrong side is hard to notice. */
export class SideQuestion {
  readonly element = h('div', {});
  private here = false;

  /** @param of the name of the question, which is asked once in this tab @param wrong the message for the other side */
  constructor(private readonly of: string, private readonly side: () => OneSide | undefined, private readonly wrong: string, private readonly answered: () => void) {}

  get confirmed(): boolean {
    try { return this.here || sessionStorage.getItem(this.key) === this.side(); } catch { return this.here; }
  }
  private get key(): string { return `wholehand.clinic.side.${this.of}`; }

  refresh(): void {
    const t = texts().visit, side = this.side(), due = side !== undefined && !this.confirmed;
    this.element.hidden = !due;
    if (!due) return this.element.replaceChildren();
    if (this.element.childElementCount > 0) return;
    const wrong = h('p', { class: 'said', role: 'alert' });
    const answer = (named: OneSide): HTMLElement => button(sideWords(named), `side-${named}`, () => {
      const now = this.side();
      if (now === undefined || named !== now) return setText(wrong, now ? fill(this.wrong, { side: sideWords(now) }) : '');
      this.here = true;
      try { sessionStorage.setItem(this.key, named); } catch { /* the answer stays in this page */ }
      this.answered();
      document.querySelector<HTMLElement>('[data-testid=arm]')?.focus();
    }, 'large');
    this.element.replaceChildren(h('section', { class: 'panel ask', 'aria-label': t.whichHand }, h('h2', {}, t.whichHand), h('p', {}, t.whichHandMore), h('div', { class: 'pair' }, answer('left'), answer('right')), wrong));
  }
}
