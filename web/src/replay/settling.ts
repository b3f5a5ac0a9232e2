/** So long after the last change the glow of a contact has settled [ms]. */
const SETTLES_MS = 600;

/** Whether another picture is due although the state is the same: contacts fade in, and room and hand are made beside the page's own work. */
export class Settling {
  private since_ms = -Infinity;
  private whole = false;

  /** Something else is shown. */
  begin(now_ms: number): void {
    this.since_ms = now_ms;
  }

  /** @param whole all of it can be drawn; it may have become so between two pictures, of which none was drawn */
  isDue(now_ms: number, whole: boolean): boolean {
    if (whole && !this.whole) this.begin(now_ms);
    this.whole = whole;
    return !whole || now_ms - this.since_ms < SETTLES_MS;
  }
}
