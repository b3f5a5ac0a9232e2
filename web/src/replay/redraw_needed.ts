/** The glow of a contact has settled this long after the last change [ms]. */
const SETTLES_MS = 600;

/** Decides whether an unchanged state must be drawn again: contacts fade in, and room and hand are made in parallel to the page's work. */
export class RedrawTimer {
  private since_ms = -Infinity;
  private whole = false;

  /** Call when another state or view is shown. */
  begin(now_ms: number): void {
    this.since_ms = now_ms;
  }

  /** @param whole everything can be drawn; if it became true since the last call, drawing continues for SETTLES_MS */
  isDue(now_ms: number, whole: boolean): boolean {
    if (whole && !this.whole) this.begin(now_ms);
    this.whole = whole;
    return !whole || now_ms - this.since_ms < SETTLES_MS;
  }
}
