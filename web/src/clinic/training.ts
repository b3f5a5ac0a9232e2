import { BigControls } from '../console/big_controls';
import { builtFrom } from '../console/built_from';
import { h, say } from '../console/dom';
import type { Panel } from '../console/model';
import { ExercisePanelView } from '../console/panel_view';
import { ScenePanel } from '../console/scene_panel';
import type { EventT } from '../protocol';
import type { HandLook, PacedView } from '../scene/paced_view';
import { fill } from '../shared/i18n';
import { texts } from './i18n';
import type { Room } from './page';
import type { OneSide } from './records';
import { button } from './ui';
import { sideWords } from './words';

/** A gentle stop is over by then, or something is wrong [ms]. */
const STOPPED_WITHIN_MS = 5000;

/** Something is rendered, or would be at once. */
export const running = ({ model }: Room): boolean => ['rendering', 'paused'].includes(model.status.name);

/** Stops gently and waits until nothing pushes; false where it does not end. */
export async function gently(room: Room, words: string): Promise<boolean> {
  const { model } = room;
  const pushes = (): boolean => running(room) || model.status.name === 'stopping';
  if (running(room) && !(await model.command(words, () => model.connection.stop())).accepted) return false;
  const end_ms = performance.now() + STOPPED_WITHIN_MS;
  while (pushes() && performance.now() < end_ms) await new Promise((resolve) => setTimeout(resolve, 50));
  return !pushes();
}

/** The picture, the exercise's panel and what is set most, of what the station renders. */
export class Training {
  readonly picture = h('div', { class: 'picture' });
  readonly controls = h('div', { class: 'controls' });
  private panels: Panel[] = [];
  private exercise: ExercisePanelView | undefined;
  private scenePanel: ScenePanel | undefined;
  private look: HandLook = 'skin';
  /** null: it cannot be drawn here; undefined: it was not tried yet. */
  private view: PacedView | null | undefined;
  private builtFrom = '';
  private closed = false;

  constructor(private readonly room: Room) {}

  begin(): void {
    const { room } = this;
    this.sceneChanged();
    void room.picture().then((view) => {
      if (this.closed) return;
      this.view = view ?? null;
      if (view && room.model.scene) view.setScene(room.model.scene);
      view?.setBodies(room.connection.bodies);
      this.scenePanel?.setView(view);
    });
  }

  /** The program loaded another exercise or hand: what shows it is built anew. */
  sceneChanged(): void {
    const { model } = this.room;
    if (model.scene) this.view?.setScene(model.scene);
    const built = builtFrom(model.scene);
    if (built === this.builtFrom) return;
    this.builtFrom = built;
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

/** Asked once before the first start: a wrong side is the mistake that nobody sees. */
export class SideQuestion {
  readonly element = h('div', {});
  private here = false;

  /** @param of what it is asked once in this tab; `wrong`: what is said of the other side */
  constructor(private readonly of: string, private readonly side: () => OneSide | undefined, private readonly wrong: string, private readonly answered: () => void) {}

  get said(): boolean {
    try { return this.here || sessionStorage.getItem(this.key) === this.side(); } catch { return this.here; }
  }
  private get key(): string { return `wholehand.clinic.side.${this.of}`; }

  refresh(): void {
    const t = texts().visit, side = this.side(), due = side !== undefined && !this.said;
    this.element.hidden = !due;
    if (!due) return this.element.replaceChildren();
    if (this.element.childElementCount > 0) return;
    const wrong = h('p', { class: 'said', role: 'alert' });
    const answer = (named: OneSide): HTMLElement => button(sideWords(named), `side-${named}`, () => {
      const now = this.side();
      if (now === undefined || named !== now) return say(wrong, now ? fill(this.wrong, { side: sideWords(now) }) : '');
      this.here = true;
      try { sessionStorage.setItem(this.key, named); } catch { /* this page knows it */ }
      this.answered();
      document.querySelector<HTMLElement>('[data-testid=arm]')?.focus();
    }, 'large');
    this.element.replaceChildren(h('section', { class: 'panel ask', 'aria-label': t.whichHand }, h('h2', {}, t.whichHand), h('p', {}, t.whichHandMore), h('div', { class: 'pair' }, answer('left'), answer('right')), wrong));
  }
}
