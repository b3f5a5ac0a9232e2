// Shows the camera's picture: large on a card until a hand was kept in its frame, then small in a corner during play.
import type { InputTexts } from '../input/i18n/en';
import type { WebcamView } from '../input/webcam';
import { h, setText } from '../shared/dom';

export interface CameraActions { again(): void; otherWay(): void }

/** Title and sentence of each step before the play. */
function wordsOf({ step, seen }: WebcamView, texts: InputTexts['camera']): [string, string] {
  if (step === 'ask') return [texts.ask, texts.askMore];
  if (step === 'load') return [texts.load, texts.loadMore];
  return seen ? [texts.frame, texts.frameMore] : [texts.noHand, texts.noHandMore];
}

export class CameraView {
  /** Card of the steps before the camera steers, for the overlay. */
  readonly card: HTMLElement;
  readonly otherWay: HTMLButtonElement;
  /** The small picture in the corner; hidden while the camera is off. */
  readonly mirror: HTMLElement;
  private readonly title = h('h1', { id: 'camera-title', class: 't-l' });
  private readonly more = h('p', { class: 't-m soft' });
  private readonly count = h('b', { class: 'count', role: 'timer', 'data-testid': 'camera-count' });
  private readonly frame = h('div', { class: 'frame' }, this.count);
  private readonly problem = h('p', { class: 't-s', role: 'status' });
  private readonly again: HTMLButtonElement;

  constructor(actions: CameraActions) {
    this.otherWay = h('button', { type: 'button', class: 'button plain t-m', 'data-testid': 'camera-other', onclick: () => actions.otherWay() });
    this.again = h('button', { type: 'button', class: 'button go t-s', 'data-testid': 'camera-again', hidden: true, onclick: () => actions.again() });
    this.card = h('section', { class: 'card framing', role: 'dialog', 'aria-labelledby': 'camera-title', tabindex: -1, 'data-testid': 'framing' },
      this.frame, h('div', { role: 'status', 'aria-live': 'polite' }, this.title, this.more), this.otherWay);
    this.mirror = h('div', { class: 'camera card', hidden: true, 'data-testid': 'camera' }, this.problem, this.again);
  }

  /** @param view undefined: the camera is off @param reason why it is off; '': the person turned it off */
  show(view: WebcamView | undefined, reason: string, texts: InputTexts['camera']): void {
    const { card, mirror } = this;
    const plays = view?.step === 'play';
    const place = plays ? mirror : this.frame;
    if (view?.video && view.video.parentElement !== place) place.prepend(view.video);
    if (!view) mirror.querySelector('video')?.remove();
    if (view?.step !== 'frame' && view?.step !== 'load') this.frame.querySelector('video')?.remove();
    mirror.hidden = !plays && (view !== undefined || reason === '');
    setText(this.problem, plays ? (view.seen ? '' : texts.noHandMore) : reason);
    this.again.hidden = plays;
    setText(this.again, texts.again);
    if (!view || plays) return;
    const [title, more] = wordsOf(view, texts);
    setText(this.title, title);
    setText(this.more, more);
    setText(this.otherWay, texts.otherWay);
    setText(this.count, view.step === 'frame' ? String(Math.ceil(view.left_s)) : '');
    card.dataset.step = view.step;
    card.classList.toggle('seen', view.seen);
  }
}
