// Hints that rise while nothing happens: words, then a ring and a shadow, then the hand shows what to do.
export type HintLevel = 0 | 1 | 2 | 3;

/** Times after which the hints are given, while what to do stays the same [s]. */
const RISE_S = [6, 12, 20] as const;

export class Hints {
  private task = '';
  private waited_s = 0;

  /** @param task what is to be done; '' while a person cannot do anything, or does it */
  look(task: string, dt_s: number): HintLevel {
    this.waited_s = task === this.task && task !== '' ? this.waited_s + dt_s : 0;
    this.task = task;
    return RISE_S.filter((rise_s) => this.waited_s >= rise_s).length as HintLevel;
  }
}
