// New buttons ignore presses for a moment: a press that was meant for the earlier buttons does nothing.

/** Presses within this time after a change of the buttons are ignored [ms]. */
const DEAF_MS = 700;

/** The part of an element that is used. `dataset.fresh` is set while its buttons ignore presses (tokens.css). */
export type ButtonContainer = Pick<HTMLElement, 'addEventListener' | 'dataset'>;

/** Ignores every press on a part of the page that begins less than DEAF_MS after its buttons appeared. No stop button is in such a part. */
export class FreshButtons {
  private changed_ms = -Infinity;
  private pressCounts = true;   // the current press began after DEAF_MS

  /** @param tapped a key that is tapped in play and may still be down: `Space` squeezes */
  constructor(private readonly part: ButtonContainer, private readonly tapped = '') {
    for (const press of ['pointerdown', 'keydown', 'keyup', 'click', 'submit']) part.addEventListener(press, (event) => this.take(event), true);
  }

  /** Call when other buttons were shown. */
  changed(): void {
    this.changed_ms = performance.now();
    this.pressCounts = false;
    this.part.dataset.fresh = '';
    setTimeout(() => { if (!this.deaf) delete this.part.dataset.fresh; }, DEAF_MS);
  }

  private get deaf(): boolean { return performance.now() - this.changed_ms < DEAF_MS; }

  private take(event: Event): void {
    const { code = '', repeat = false, detail = 0 } = event as Partial<KeyboardEvent & MouseEvent>;
    const typed = (event.target as Partial<Element> | null)?.closest?.('input, select, textarea');
    if (event.type !== 'submit' && typed) return;
    if (event.type.startsWith('key') && code !== 'Enter' && code !== 'Space') return;
    if (event.type === 'pointerdown' || (event.type === 'keydown' && !repeat)) this.pressCounts = !this.deaf;
    // A click without a count comes from a key, whose keydown was checked, or from a screen reader.
    const counts = event.type === 'submit' || (event.type === 'click' && detail === 0) || this.pressCounts;
    if (!this.deaf && counts) return;
    event.preventDefault();
    // A keyup is never stopped, so that held keys are released.
    if (event.type !== 'keyup') event.stopImmediatePropagation();
    // Tapping the key further, or releasing it only now, is meant for the earlier screen.
    if (code !== '' && code === this.tapped && !repeat) this.changed();
  }
}
