// Buttons that have just come are deaf: a press that was meant for what stood there before does nothing.

/** What changes under a finger is not pressed on purpose within this time [ms]. */
const DEAF_MS = 700;

/** Where buttons change. `dataset.fresh` is there while they are deaf (tokens.css). */
export type Changing = Pick<HTMLElement, 'addEventListener' | 'dataset'>;

/** Swallows every press on a part of the page that begins before its buttons have been there for DEAF_MS. No stop is in such a part. */
export class FreshButtons {
  private changed_ms = -Infinity;
  private heard = true;   // the press under way began when the buttons were no longer new

  /** @param tapped a key that is tapped in play, and so may be on its way down or up: `Space` squeezes */
  constructor(private readonly part: Changing, private readonly tapped = '') {
    for (const press of ['pointerdown', 'keydown', 'keyup', 'click', 'submit']) part.addEventListener(press, (event) => this.take(event), true);
  }

  /** Other buttons are there now. */
  changed(): void {
    this.changed_ms = performance.now();
    this.heard = false;
    this.part.dataset.fresh = '';
    setTimeout(() => { if (!this.deaf) delete this.part.dataset.fresh; }, DEAF_MS);
  }

  private get deaf(): boolean { return performance.now() - this.changed_ms < DEAF_MS; }

  private take(event: Event): void {
    const { code = '', repeat = false, detail = 0 } = event as Partial<KeyboardEvent & MouseEvent>;
    const typed = (event.target as Partial<Element> | null)?.closest?.('input, select, textarea');
    if (event.type !== 'submit' && typed) return;
    if (event.type.startsWith('key') && code !== 'Enter' && code !== 'Space') return;
    if (event.type === 'pointerdown' || (event.type === 'keydown' && !repeat)) this.heard = !this.deaf;
    // A click without a count comes from a key, whose keydown was judged, or from a screen reader.
    const counts = event.type === 'submit' || (event.type === 'click' && detail === 0) || this.heard;
    if (!this.deaf && counts) return;
    event.preventDefault();
    // What a key held down is let go of, whatever is new.
    if (event.type !== 'keyup') event.stopImmediatePropagation();
    // Who goes on tapping it, or lets go of it only now, means what was there before.
    if (code !== '' && code === this.tapped && !repeat) this.changed();
  }
}
