import { fill, nameOf } from '../shared/i18n';
import type { HandLook, SmallBar } from './small_bar';
import { choice, h, say } from './dom';
import { fixed } from './format';
import { texts } from './i18n';
import type { ConsoleModel, Panel } from './model';

/** What is shown of a moment: live, or of a recording. */
export type Shown = Pick<ConsoleModel, 'scene' | 'state' | 'value'>;

/** The scene as it is now, small, with the hand as skin or as the capsules that collide. */
export class ViewPanel implements Panel {
  readonly element: HTMLElement;
  private readonly t = texts();
  private readonly caption = h('p', { class: 'cap' });
  private readonly words = h('p', { class: 'none', role: 'status' }, this.t.view.loading);
  private readonly look: ReturnType<typeof choice>;
  private view: SmallBar | undefined;
  private readonly resized = new ResizeObserver(() => this.view?.resize());

  constructor(private readonly model: Shown, private shown: HandLook, private readonly onLook: (look: HandLook) => void) {
    const { t } = this;
    this.look = choice(t.view.choice, [{ key: 'skin', name: t.view.skin }, { key: 'colliders', name: t.view.colliders }], shown, (key) => this.showHand(key as HandLook));
    this.look.element.hidden = true;
    this.caption.hidden = true;
    this.element = h('section', { class: 'panel view', 'aria-label': t.view.title }, this.words, this.look.element, this.caption);
  }

  /** The picture is ready; undefined: it cannot be here. */
  setView(view: SmallBar | undefined): void {
    this.view = view;
    say(this.words, view ? '' : this.t.view.none);
    this.words.hidden = view !== undefined;
    this.look.element.hidden = view === undefined;
    if (!view) return;
    this.element.prepend(view.canvas);
    this.resized.observe(this.element);
    view.show(this.shown);
    view.resize();
  }

  /** @param atOnce whether or not it is time for another picture */
  draw(atOnce = false): void {
    const { state } = this.model;
    if (state) this.view?.draw(state, performance.now(), atOnce);
  }

  refresh(): void {
    const { model } = this;
    const asked = model.value('asked_l');
    const dispenser = model.value('target_dispenser') ?? -1;
    const liquid = liquidOf(model.scene?.exerciseJson, dispenser);
    const known = asked !== undefined && liquid !== undefined;
    if (this.caption.hidden === known) this.caption.hidden = !known;
    if (!known) return;
    const ml = (litres: number | undefined): string => fixed(1000 * (litres ?? 0), 0);
    say(this.caption, fill(this.t.pouring, { liquid: nameOf('liquid', liquid), a: ml(model.value('poured_l')), b: ml(asked) }));
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

let parsedFrom: unknown;
let liquids: readonly string[] = [];

/** Which liquid a dispenser holds. */
function liquidOf(json: unknown, dispenser: number): string | undefined {
  if (json !== parsedFrom) {
    parsedFrom = json;
    try {
      const { dispensers } = JSON.parse(String(json ?? '')) as { dispensers?: { liquid: string }[] };
      liquids = (dispensers ?? []).map(({ liquid }) => String(liquid));
    } catch {
      liquids = [];
    }
  }
  return liquids[dispenser];
}
