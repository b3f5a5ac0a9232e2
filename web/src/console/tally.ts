import { RunState, type WorldStateT } from '../protocol';

/** Nothing is known of a longer gap between two states [s]. */
const LONGEST_GAP_S = 10;
/** What counts as one repetition, the first of these that the exercise has. */
const REPETITIONS = ['step_done', 'level_done'] as const;

/** How long a session has been active and how often something was done in it, as far as this page has seen. */
export class Tally {
  active_s = 0;
  repetitions = 0;
  from: Date | undefined;
  /** When rendering ended; undefined while it goes on, and before the first time. */
  ended: Date | undefined;
  private session = -1;
  private time_s = 0;
  private rendered = false;

  look({ session, timeS, runState }: Pick<WorldStateT, 'session' | 'timeS' | 'runState'>, paused: boolean, now: Date): void {
    const renders = runState === RunState.Rendering;
    if (session !== this.session && renders) {
      this.session = session;
      this.active_s = this.repetitions = 0;
      this.from = now;
      this.ended = undefined;
    } else if (renders && this.rendered && !paused) {
      const dt_s = timeS - this.time_s;
      if (dt_s > 0 && dt_s < LONGEST_GAP_S) this.active_s += dt_s;
    }
    if (this.rendered && !renders) this.ended = now;
    this.rendered = renders;
    this.time_s = timeS;
  }

  /** @param all names of the exercise's events */
  count(event: string, all: readonly string[]): void {
    if (event === REPETITIONS.find((name) => all.includes(name))) this.repetitions += 1;
  }
}
