// Hints that become stronger while nothing happens: text, then a ring and a shadow, then the hand shows the task.
export type HintLevel = 0 | 1 | 2 | 3;

/** Times after which the hints are given, while the task stays the same [s]. */
const RISE_S = [6, 12, 20] as const;

export class Hints {
  private task = '';
  private waited_s = 0;

  /** @param task the current task; '' while a person cannot act, or acts */
  look(task: string, dt_s: number): HintLevel {
    this.waited_s = task === this.task && task !== '' ? this.waited_s + dt_s : 0;
    this.task = task;
    return RISE_S.filter((rise_s) => this.waited_s >= rise_s).length as HintLevel;
  }
}
