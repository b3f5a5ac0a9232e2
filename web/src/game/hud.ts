// The recipe card, the amount at the glass, and the strip with instruction, meter and buttons.
import { h, setAttribute, setText } from '../shared/dom';
import { nameOf, text } from '../shared/i18n';
import { PanelCard } from './panel_card';
import { helpPicture, restPicture, stopPicture, swatch, tickPicture } from './pictures';
import type { CallOut, Meter, RecipeRow, RecipeView } from './view';

export interface HudActions { help(): void; rest(): void; stop(): void; play(): void }
export interface Point { readonly x_px: number; readonly y_px: number }

/** Puts an element's anchor to a point of the screen. */
function moveTo(element: HTMLElement, point: Point | null): void {
  element.hidden = point === null;
  if (point) element.style.transform = `translate(${point.x_px.toFixed(1)}px, ${point.y_px.toFixed(1)}px)`;
}

class RecipeCard {
  readonly element = h('section', { class: 'card recipe', 'data-testid': 'recipe', hidden: true });
  private shape = '';
  private rows: { row: HTMLElement; ml: HTMLElement; bar: HTMLElement; fill: HTMLElement; tick: HTMLElement }[] = [];
  private readonly count = h('p', { class: 't-s' });
  private readonly name = h('h1', { class: 't-l' });
  private readonly list = h('ol', { class: 'rows' });

  constructor() { this.element.append(h('header', {}, this.count, this.name), this.list); }

  /** The words change with the language, the rows with the drink. */
  show(view: RecipeView | null): void {
    this.element.hidden = view === null;
    if (!view) return;
    setAttribute(this.element, 'aria-label', text('game.recipe'));
    setText(this.count, text('game.drinkOf', { n: view.drink, m: view.drinks }));
    setText(this.name, nameOf('drink', view.name));
    const shape = view.rows.map((row) => row.liquid).join();
    if (shape !== this.shape) this.build(view.rows);
    this.shape = shape;
    view.rows.forEach((row, i) => this.update(i, row));
  }

  private build(rows: readonly RecipeRow[]): void {
    this.rows = rows.map((row) => {
      const fill = h('i');
      const bar = h('div', { class: 'bar', role: 'progressbar', 'aria-valuemin': 0 }, fill);
      const ml = h('span', { class: 'ml t-s' });
      const tick = h('span', { class: 'tick', role: 'img' }, tickPicture());
      const line = h('li', { class: 'row' }, swatch(row.liquid), h('span', { class: 'name t-m' }), tick, ml, bar);
      return { row: line, ml, bar, fill, tick };
    });
    this.list.replaceChildren(...this.rows.map(({ row }) => row));
    this.list.classList.toggle('many', rows.length > 3);
  }

  private update(i: number, row: RecipeRow): void {
    const { row: line, ml, bar, fill, tick } = this.rows[i];
    const name = nameOf('liquid', row.liquid);
    setText(line.querySelector('.name')!, name);
    line.classList.toggle('now', row.is === 'now');
    if (row.is === 'now') setAttribute(line, 'aria-current', 'step'); else line.removeAttribute('aria-current');
    tick.hidden = row.is !== 'done';
    setAttribute(tick, 'aria-label', text('game.done'));
    const pouring = row.is === 'now' && row.got_ml > 0;
    bar.hidden = !pouring;
    ml.hidden = pouring;
    setText(ml, text('game.ml', { a: row.asked_ml }));
    setAttribute(bar, 'aria-label', name);
    setAttribute(bar, 'aria-valuenow', String(Math.min(row.got_ml, row.asked_ml)));
    setAttribute(bar, 'aria-valuemax', String(row.asked_ml));
    setAttribute(bar, 'aria-valuetext', text('game.amountOf', { a: row.got_ml, b: row.asked_ml }));
    fill.style.transform = `scaleX(${Math.min(1, row.got_ml / Math.max(1, row.asked_ml))})`;
  }
}

class SqueezeMeter {
  readonly element = h('div', { class: 'meter', 'data-testid': 'meter', hidden: true });
  private readonly label = h('span', { class: 't-s' });
  private readonly word = h('b', { class: 't-read', 'aria-hidden': 'true' });
  private readonly zone = h('div', { class: 'zone' });
  private readonly mark = h('div', { class: 'mark' });
  private readonly track = h('div', { class: 'track', role: 'meter', 'aria-valuemin': 0, 'aria-valuemax': 100 }, this.zone, h('div', { class: 'slide' }, this.mark));

  constructor() { this.element.append(h('div', { class: 'labels' }, this.label, this.word), this.track); }

  show(meter: Meter | null): void {
    this.element.hidden = !meter?.shown;
    if (!meter?.shown) return;
    const word = text(`game.zone.${meter.zone}`);
    const label = meter.label ?? text('game.yourSqueeze');
    setText(this.label, label);
    setText(this.word, word);
    setAttribute(this.word, 'data-zone', meter.zone);
    this.element.classList.toggle('grey', meter.zone === 'wrong');
    setAttribute(this.track, 'aria-label', label);
    setAttribute(this.track, 'aria-valuenow', String(Math.round(100 * meter.value)));
    setAttribute(this.track, 'aria-valuetext', word);
    this.zone.style.left = `${(100 * meter.low).toFixed(1)}%`;
    this.zone.style.width = `${(100 * (meter.high - meter.low)).toFixed(1)}%`;
    // The slide is as wide as the track: moving it costs no layout.
    this.mark.parentElement!.style.transform = `translateX(${(100 * meter.value).toFixed(1)}%)`;
  }
}

export class Hud {
  readonly strip: HTMLElement;
  readonly stop: HTMLButtonElement;
  readonly rest: HTMLButtonElement;
  readonly play: HTMLButtonElement;
  private readonly recipe = new RecipeCard();
  private readonly meter = new SqueezeMeter();
  readonly panel = new PanelCard();
  private readonly title = h('b', { class: 't-l', 'data-testid': 'instruction' });
  private readonly more = h('span', { class: 't-read' });
  private readonly unconfirmed = h('div', { class: 'say alarm', role: 'alert', 'data-testid': 'stop-unconfirmed' });
  private readonly stopWord = h('span');
  private readonly restWord = h('span');
  private readonly help: HTMLButtonElement;
  private readonly amount = h('b', { class: 't-read' });
  private readonly amountMore = h('span', { class: 't-s' });
  private readonly callOut = h('div', { class: 'callout', hidden: true }, h('div', {}, this.amount, this.amountMore));
  private readonly ring = h('div', { class: 'depth ring', hidden: true, 'aria-hidden': 'true' }, h('i'));
  private readonly shadow = h('div', { class: 'depth shadow', hidden: true, 'aria-hidden': 'true' }, h('i'));
  private readonly chevrons = h('div', { class: 'chevrons', hidden: true, 'aria-hidden': 'true' });

  constructor(root: HTMLElement, actions: HudActions) {
    this.help = h('button', { class: 'button quiet', type: 'button', 'data-testid': 'help', onclick: () => actions.help() }, helpPicture());
    this.rest = h('button', { class: 'button rest t-read', type: 'button', 'data-testid': 'rest-now', onclick: () => actions.rest() }, restPicture(), this.restWord);
    this.stop = h('button', { class: 'button stop t-read', type: 'button', 'data-testid': 'stop', onclick: () => actions.stop() }, stopPicture(), this.stopWord);
    this.play = h('button', { class: 'button go playself t-m', type: 'button', 'data-testid': 'play', hidden: true, onclick: () => actions.play() });
    this.strip = h('footer', { class: 'strip' },
      h('div', { class: 'say', role: 'status', 'aria-live': 'polite' }, this.title, this.more),
      this.unconfirmed, this.meter.element, this.play, this.help, this.rest, this.stop);
    this.chevrons.append(...[0, 1, 2].map(() => h('i')));
    root.append(this.ring, this.shadow, this.recipe.element, this.panel.element, this.chevrons, this.callOut, this.strip);
  }

  words(): void {
    setAttribute(this.help, 'aria-label', text('game.help'));
    setText(this.stopWord, text('game.stop'));
    setText(this.restWord, text('game.rest'));
    setAttribute(this.rest, 'aria-label', text('game.rest'));   // upright, its word is not shown
    setText(this.play, text('watch.play'));
  }

  /** A stop was pressed, and the program has not said that it has it. */
  alarm(on: boolean): void {
    if (this.unconfirmed.hasChildNodes() === on) return;
    this.strip.classList.toggle('alarmed', on);
    this.unconfirmed.replaceChildren(...(on ? [h('b', { class: 't-read' }, text('stop.unconfirmed')), h('span', { class: 't-s' }, text('stop.unconfirmedMore'))] : []));
  }

  say(title: string, more: string): void {
    setText(this.title, title);
    setText(this.more, more);
  }

  /** The parts of the play; null: there is nothing to show of it. */
  show(recipe: RecipeView | null, meter: Meter | null, callOut: CallOut | null): void {
    this.recipe.show(recipe);
    this.meter.show(meter);
    this.callOut.dataset.shown = String(callOut?.shown ?? false);
    if (!callOut?.shown) return;
    setText(this.amount, text('game.amountOf', { a: callOut.got_ml, b: callOut.asked_ml }));
    setText(this.amountMore, text('game.fillToHere'));
  }

  /** A ring where the bottle stands on the counter, and the hand's shadow; null: no such hint. */
  depth(marks: { ring: Point; shadow: Point } | null): void {
    moveTo(this.ring, marks?.ring ?? null);
    moveTo(this.shadow, marks?.shadow ?? null);
  }

  /** Where the scene has the line on the glass and the target; null: it shows none. */
  place(line: Point | null, soft: { at: Point; left: boolean } | null): void {
    moveTo(this.callOut, this.callOut.dataset.shown === 'true' ? line : null);
    moveTo(this.chevrons, soft?.at ?? null);
    this.chevrons.classList.toggle('left', soft?.left ?? false);
  }
}
