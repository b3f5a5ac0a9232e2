import { infoOf } from '../exercises/info';
import type { ExerciseInfo } from '../exercises/exercise_info';
import type { HandLook, PacedView } from '../scene/paced_view';
import { choice, h, setText } from './dom';
import { texts } from './i18n';
import type { ConsoleModel, Panel } from './model';

/** The part of a model that the panel shows, live or of a recording. */
export type SceneSource = Pick<ConsoleModel, 'scene' | 'state' | 'value'>;

/** The present scene in a small view, with the hand as skin or as its collision capsules. */
export class ScenePanel implements Panel {
  readonly element: HTMLElement;
  private readonly t = texts();
  private readonly info: ExerciseInfo;
  private readonly caption = h('p', { class: 'cap' });
  private readonly words = h('p', { class: 'none', role: 'status' }, this.t.view.loading);
  private readonly look: ReturnType<typeof choice>;
  private view: PacedView | undefined;
  private readonly resized = new ResizeObserver(() => this.view?.resize());

  constructor(private readonly model: SceneSource, private shown: HandLook, private readonly onLook: (look: HandLook) => void) {
    const { t } = this;
    this.info = infoOf(model.scene);
    this.look = choice(t.view.choice, [{ key: 'skin', name: t.view.skin }, { key: 'colliders', name: t.view.colliders }], shown, (key) => this.showHand(key as HandLook));
    this.look.element.hidden = true;
    this.caption.hidden = true;
    this.element = h('section', { class: 'panel view', 'aria-label': t.view.title }, this.words, this.look.element, this.caption);
  }

  /** Sets the 3D view; undefined where it cannot be drawn. */
  setView(view: PacedView | undefined): void {
    this.view = view;
    setText(this.words, view ? this.t.view.loading : this.t.view.none);
    this.look.element.hidden = view === undefined;
    if (!view) return;
    this.element.prepend(view.canvas);
    this.resized.observe(this.element);
    view.show(this.shown);
    view.resize();
  }

  /** @param atOnce draws now, even when the next picture is not due */
  draw(atOnce = false): void {
    const { state } = this.model;
    if (state) this.view?.draw(state, performance.now(), atOnce);
  }

  refresh(): void {
    // A picture that is not complete yet is black.
    if (this.view) this.words.hidden = this.view.drawnIn !== 'none';
    const caption = this.info.caption((name) => this.model.value(name));
    if (this.caption.hidden !== (caption === '')) this.caption.hidden = caption === '';
    setText(this.caption, caption);
  }

  close(): void {
    this.resized.disconnect();
  }

  private showHand(look: HandLook): void {
    this.shown = look;
    this.look.choose(look);
    this.view?.show(look);
    this.onLook(look);
  }
}
