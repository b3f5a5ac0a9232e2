import { h, say, setClass } from '../console/dom';
import { texts as consoleTexts } from '../console/i18n';
import type { Span } from '../console/plot_source';
import { fill } from '../shared/i18n';
import { clockTime } from './clock';
import { texts } from './i18n';
import { isBad, wordsOf, type Moment } from './moments';
import type { ReplaySide } from './side';

/** Rows that are shown at once. */
const MOST = 200;

/** What happened in the window, in words; each line leads there. */
export class MomentsPanel {
  readonly element: HTMLElement;
  private readonly t = texts().moments;
  private readonly list = h('ul', { class: 'moments', 'data-testid': 'moments' });
  private readonly words = h('p', { class: 'none' });
  private shown: readonly Moment[] | undefined;

  constructor(private readonly side: ReplaySide, private readonly seek: (time_s: number) => void) {
    this.element = h('section', { class: 'panel', 'aria-label': this.t.title }, h('div', { class: 'hd' }, h('h2', {}, this.t.title)), this.words, this.list);
  }

  /** @param window of the page's time */
  show(window: Span): void {
    const { side, t } = this;
    const found = side.moments.within({ from_s: window.from_s - side.shift_s, to_s: window.to_s - side.shift_s });
    const before = this.shown;
    if (before && before.length === found.length && before.every((moment, i) => moment === found[i])) return;
    this.shown = found;
    say(this.words, found.length === 0 ? t.none : found.length > MOST ? fill(t.more, { n: MOST, m: found.length }) : '');
    this.words.hidden = found.length > 0 && found.length <= MOST;
    const focused = this.list.contains(document.activeElement);
    this.list.replaceChildren(...found.slice(0, MOST).map((moment) => this.row(moment)));
    if (focused) this.list.querySelector('button')?.focus();
  }

  private row(moment: Moment): HTMLElement {
    const { side } = this;
    const time_s = moment.time_s + side.shift_s;
    const row = h('li', {}, h('button', { type: 'button', onclick: () => this.seek(time_s) },
      h('span', { class: 'num' }, clockTime(time_s, 3)), h('bdi', {}, wordsOf(moment, side.names, texts(), consoleTexts()))));
    setClass(row, 'bad', isBad(moment));
    return row;
  }
}
