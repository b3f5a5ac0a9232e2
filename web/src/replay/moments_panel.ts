import { h, setText, setClass } from '../console/dom';
import { texts as consoleTexts } from '../console/i18n';
import type { Span } from '../console/plot_source';
import { fill } from '../shared/i18n';
import { clockTime } from './clock';
import { texts } from './i18n';
import { isBad, lastAt, rowsAround, wordsOf, type Moment } from './moments';
import type { ReplaySide } from './side';

/** Number of rows that are shown at once. */
const MOST = 200;

/** The moments of the window in words; a line moves the play head to its moment. The last one before the play head is marked and visible. */
export class MomentsPanel {
  readonly element: HTMLElement;
  private readonly t = texts().moments;
  private readonly list = h('ul', { class: 'moments', 'data-testid': 'moments' });
  private readonly words = h('p', { class: 'none' });
  private found: readonly Moment[] | undefined;
  private first = 0;
  private time_s = NaN;
  private marked: number | undefined;

  constructor(private readonly side: ReplaySide, private readonly seek: (time_s: number) => void) {
    this.element = h('section', { class: 'panel', 'aria-label': this.t.title }, h('div', { class: 'hd' }, h('h2', {}, this.t.title)), this.words, this.list);
  }

  /** @param window in the page's time */
  show(window: Span): void {
    const { side, t } = this;
    const found = side.moments.within({ from_s: window.from_s - side.shift_s, to_s: window.to_s - side.shift_s });
    const before = this.found;
    if (before && before.length === found.length && before.every((moment, i) => moment === found[i])) return;
    this.found = found;
    setText(this.words, found.length === 0 ? t.none : found.length > MOST ? fill(t.more, { n: MOST, m: found.length }) : '');
    this.words.hidden = found.length > 0 && found.length <= MOST;
    this.fillRows(rowsAround(found.length, lastAt(found, this.time_s), MOST, 0));
  }

  /** @param time_s in the page's time */
  placeHead(time_s: number): void {
    this.time_s = time_s - this.side.shift_s;
    const found = this.found ?? [];
    const now = lastAt(found, this.time_s);
    if (now === this.marked) return;
    const first = rowsAround(found.length, now, MOST, this.first);
    if (first !== this.first) this.fillRows(first);
    else this.mark(now);
  }

  private fillRows(first: number): void {
    const found = this.found ?? [];
    const focused = this.list.contains(document.activeElement);
    this.first = first;
    this.list.replaceChildren(...found.slice(first, first + MOST).map((moment) => this.row(moment)));
    this.marked = undefined;
    this.mark(lastAt(found, this.time_s));
    if (focused) this.list.querySelector('button')?.focus();
  }

  private mark(now: number | undefined): void {
    this.list.querySelector('[aria-current]')?.removeAttribute('aria-current');
    this.marked = now;
    const row = now === undefined ? undefined : this.list.children[now - this.first] as HTMLElement | undefined;
    row?.querySelector('button')?.setAttribute('aria-current', 'time');
    // The list does not scroll while somebody reads or chooses in it.
    if (row && !this.list.matches(':hover, :focus-within')) this.bringIntoSight(row);
  }

  /** Scrolls the list, without scrolling the page. */
  private bringIntoSight(row: HTMLElement): void {
    const top = row.offsetTop - this.list.offsetTop;
    const { scrollTop, clientHeight } = this.list;
    if (top < scrollTop || top + row.offsetHeight > scrollTop + clientHeight) this.list.scrollTop = top - clientHeight / 2;
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
