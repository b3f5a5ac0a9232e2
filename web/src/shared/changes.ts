/** Whether something differs from what was shown: an unchanged part of a screen is not drawn again, so that its focus and its announcements stay. */
export class Changes {
  private shown = '';

  of(...now: readonly unknown[]): boolean {
    const before = this.shown;
    this.shown = JSON.stringify(now);
    return this.shown !== before;
  }
}
