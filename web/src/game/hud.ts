// The task card, the amount at the goal, and the strip with instruction, meter and buttons.
import type { GoalWords, Meter, TaskCard, TaskStep } from '../exercises/exercise';
import { h, setAttribute, setText } from '../shared/dom';
import { text } from '../shared/i18n';
import { fitWords } from './fit_words';
import type { Chosen } from '../exercises/answer_buttons';
import { PanelCard } from './panel_card';
import { helpPicture, restPicture, stopPicture, tickPicture } from './pictures';

export interface HudActions { help(): void; rest(): void; stop(): void; play(): void; answer(chosen: Chosen): void }
export interface Point { readonly x_px: number; readonly y_px: number }

/** Moves an element's anchor to a point of the screen. */
function moveTo(element: HTMLElement, point: Point | null): void {
  element.hidden = point === null;
  if (point) element.style.transform = `translate(${point.x_px.toFixed(1)}px, ${point.y_px.toFixed(1)}px)`;
}

class StepsCard {
  readonly element = h('section', { class: 'card task', 'data-testid': 'task', hidden: true });
  private shape = '';
  private rows: { row: HTMLElement; name: HTMLElement; amount: HTMLElement; bar: HTMLElement; fill: HTMLElement; tick: HTMLElement }[] = [];
  private readonly count = h('p', { class: 't-s' });
  private readonly title = h('h1', { class: 't-l' });
  private readonly list = h('ol', { class: 'rows' });

  constructor() { this.element.append(h('header', {}, this.count, this.title), this.list); }

  /** Text is rebuilt when the language changes, rows when the task changes. */
  show(card: TaskCard | null): void {
    this.element.hidden = card === null;
    if (!card) return;
    setAttribute(this.element, 'aria-label', card.label);
    setText(this.count, card.count);
    setText(this.title, card.title);
    const shape = card.steps.map(({ key }) => key).join();
    if (shape !== this.shape) this.build(card.steps);
    this.shape = shape;
    card.steps.forEach((step, i) => this.update(i, step));
  }

  private build(steps: readonly TaskStep[]): void {
    this.rows = steps.map((step) => {
      const fill = h('i');
      const bar = h('div', { class: 'bar', role: 'progressbar', 'aria-valuemin': 0 }, fill);
      const amount = h('span', { class: 'ml t-s' }), name = h('span', { class: 'name t-m' });
      const tick = h('span', { class: 'tick', role: 'img' }, tickPicture());
      const row = h('li', { class: 'row' }, step.picture(), name, tick, amount, bar);
      return { row, name, amount, bar, fill, tick };
    });
    this.list.replaceChildren(...this.rows.map(({ row }) => row));
    this.list.classList.toggle('many', steps.length > 3);
  }

  private update(i: number, step: TaskStep): void {
    const { row, name, amount, bar, fill, tick } = this.rows[i];
    setText(name, step.name);
    row.classList.toggle('now', step.is === 'now');
    if (step.is === 'now') setAttribute(row, 'aria-current', 'step'); else row.removeAttribute('aria-current');
    tick.hidden = step.is !== 'done';
    setAttribute(tick, 'aria-label', text('game.done'));
    const begun = step.is === 'now' && step.done > 0;
    bar.hidden = !begun;
    amount.hidden = begun;
    setText(amount, step.askedWords);
    setAttribute(bar, 'aria-label', step.name);
    setAttribute(bar, 'aria-valuenow', String(Math.min(step.done, step.asked)));
    setAttribute(bar, 'aria-valuemax', String(step.asked));
    setAttribute(bar, 'aria-valuetext', step.doneWords);
    fill.style.transform = `scaleX(${Math.min(1, step.done / Math.max(1, step.asked))})`;
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
    // The slide is as wide as the track: moving it causes no layout.
    this.mark.parentElement!.style.transform = `translateX(${(100 * meter.value).toFixed(1)}%)`;
  }
}

export class Hud {
  readonly strip: HTMLElement;
  readonly stop: HTMLButtonElement;
  readonly rest: HTMLButtonElement;
  readonly play: HTMLButtonElement;
  private readonly task = new StepsCard();
  private readonly meter = new SqueezeMeter();
  readonly panel: PanelCard;
  private readonly title = h('b', { class: 't-l', 'data-testid': 'instruction' });
  private readonly more = h('span', { class: 't-read' });
  private readonly unconfirmed = h('div', { class: 'say alarm', role: 'alert', 'data-testid': 'stop-unconfirmed' });
  private readonly recorded = h('p', { class: 'recorded t-s', 'data-testid': 'recorded', hidden: true });
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
    this.panel = new PanelCard((chosen) => actions.answer(chosen));
    this.help = h('button', { class: 'button quiet', type: 'button', 'data-testid': 'help', onclick: () => actions.help() }, helpPicture());
    this.rest = h('button', { class: 'button rest t-read', type: 'button', 'data-testid': 'rest-now', onclick: () => actions.rest() }, restPicture(), this.restWord);
    this.stop = h('button', { class: 'button stop t-read', type: 'button', 'data-testid': 'stop', onclick: () => actions.stop() }, stopPicture(), this.stopWord);
    this.play = h('button', { class: 'button go playself t-m', type: 'button', 'data-testid': 'play', hidden: true, onclick: () => actions.play() });
    this.strip = h('footer', { class: 'strip' },
      h('div', { class: 'say', role: 'status', 'aria-live': 'polite' }, this.title, this.more),
      this.unconfirmed, this.meter.element, this.play, this.help, this.rest, this.stop);
    this.chevrons.append(...[0, 1, 2].map(() => h('i')));
    addEventListener('resize', this.refit);
    void document.fonts?.ready.then(this.refit);
    root.append(this.ring, this.shadow, this.task.element, this.panel.element, this.chevrons, this.callOut, this.recorded, this.strip);
  }

  words(): void {
    setAttribute(this.help, 'aria-label', text('game.help'));
    setText(this.stopWord, text('game.stop'));
    setText(this.restWord, text('game.rest'));
    setAttribute(this.rest, 'aria-label', text('game.rest'));   // on an upright screen its text is hidden
    setText(this.play, text('watch.play'));
  }

  /** Shows the alarm: a stop was pressed, and the program has not confirmed it. */
  alarm(on: boolean): void {
    if (this.unconfirmed.hasChildNodes() === on) return;
    this.strip.classList.toggle('alarmed', on);
    this.unconfirmed.replaceChildren(...(on ? [h('b', { class: 't-read' }, text('stop.unconfirmed')), h('span', { class: 't-s' }, text('stop.unconfirmedMore'))] : []));
  }

  writeInstruction(title: string, more: string): void {
    for (const [line, words] of [[this.title, title], [this.more, more]] as const) {
      if (line.textContent === words) continue;
      setText(line, words);
      fitWords(line);
    }
  }

  /** Fits the instruction to a strip of another size. */
  private readonly refit = (): void => { for (const line of [this.title, this.more]) fitWords(line); };

  /** Shows the parts of the play; null hides a part. */
  show(card: TaskCard | null, meter: Meter | null, goal: GoalWords | null): void {
    this.task.show(card);
    this.meter.show(meter);
    this.callOut.dataset.shown = String(goal !== null);
    if (!goal) return;
    setText(this.amount, goal.amount);
    setText(this.amountMore, goal.more);
  }

  /** Shows whether the session is recorded; undefined: there is no session. */
  record(on: boolean | undefined): void {
    this.recorded.hidden = on === undefined;
    if (on !== undefined) setText(this.recorded, text(on ? 'game.recorded' : 'game.unrecorded'));
  }

  /** Shows a ring where the target stands on the counter, and the hand's shadow; null hides both. */
  depth(marks: { ring: Point; shadow: Point } | null): void {
    moveTo(this.ring, marks?.ring ?? null);
    moveTo(this.shadow, marks?.shadow ?? null);
  }

  /** Places the goal's text at its mark, and chevrons beside the target; null hides them. */
  place(goal: Point | null, cue: { at: Point; left: boolean } | null): void {
    moveTo(this.callOut, this.callOut.dataset.shown === 'true' ? goal : null);
    moveTo(this.chevrons, cue?.at ?? null);
    this.chevrons.classList.toggle('left', cue?.left ?? false);
  }
}
