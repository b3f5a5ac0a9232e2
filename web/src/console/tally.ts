import { RunState, type WorldStateT } from '../protocol';
import { keepTally, keptTally } from './kept_tally';

/** Nothing is known of a longer gap between two states [s]. */
const LONGEST_GAP_S = 10;
/** The counters are kept this often, of the session's time [s]. */
const KEPT_EVERY_S = 1;
/** What counts as one repetition, the first of these that the exercise has. */
const REPETITIONS = ['step_done', 'level_done'] as const;

/** How long a session has been active and how often something was done in it, as far as this page has seen, also before a reload. */
export class Tally {
  active_s = 0;
  repetitions = 0;
  from: Date | undefined;
  /** When rendering ended; undefined while it goes on, and before the first time. */
  ended: Date | undefined;
  private session = -1;
  private recording = '';
  private time_s = 0;
  private kept_s = 0;
  private rendered = false;

  /** @param recording name of the file that is written; empty: none */
  look({ session, timeS, runState }: Pick<WorldStateT, 'session' | 'timeS' | 'runState'>, paused: boolean, now: Date, recording = ''): void {
    const renders = runState === RunState.Rendering;
    if (this.session < 0) this.takeKept(session, renders ? timeS : Infinity, recording);
    if (session !== this.session && renders) {
      this.session = session;
      this.recording = '';
      this.active_s = this.repetitions = 0;
      this.from = now;
      this.ended = undefined;
      this.kept_s = -Infinity;
    } else if (renders && this.rendered && !paused) {
      const dt_s = timeS - this.time_s;
      if (dt_s > 0 && dt_s < LONGEST_GAP_S) this.active_s += dt_s;
    }
    const ends = this.rendered && !renders;
    if (ends) this.ended = now;
    this.rendered = renders;
    if (!renders && !ends) return;
    this.time_s = timeS;
    this.recording = recording || this.recording;
    if (ends || timeS - this.kept_s >= KEPT_EVERY_S) this.keep();
  }

  /** @param all names of the exercise's events */
  count(event: string, all: readonly string[]): void {
    if (event !== REPETITIONS.find((name) => all.includes(name))) return;
    this.repetitions += 1;
    this.keep();
  }

  /** Goes on with what this page kept before it was loaded again. A program that began anew counts sessions from 1, too. */
  private takeKept(session: number, now_s: number, recording: string): void {
    const kept = keptTally();
    if (kept?.session !== session || kept.time_s > now_s) return;
    // Between sessions no recording is written.
    const between = now_s === Infinity && recording === '';
    if (kept.recording !== recording && !between) return;
    Object.assign(this, { session, recording: kept.recording, time_s: kept.time_s, kept_s: kept.time_s, active_s: kept.active_s, repetitions: kept.repetitions });
    this.from = new Date(kept.from_ms);
    this.ended = kept.ended_ms === null ? undefined : new Date(kept.ended_ms);
    this.rendered = this.ended === undefined;
  }

  private keep(): void {
    const { session, recording, time_s, active_s, repetitions, from, ended } = this;
    if (!from) return;
    keepTally({ session, recording, time_s, active_s, repetitions, from_ms: from.getTime(), ended_ms: ended?.getTime() ?? null });
    this.kept_s = time_s;
  }
}
