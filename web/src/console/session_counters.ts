import { RunState, type WorldStateT } from '../protocol';
import { saveCounters, loadCounters } from './persisted_counters';

/** A longer gap between two states is not counted as active time [s]. */
const LONGEST_GAP_S = 10;
/** The counters are saved this often, in the session's time [s]. */
const SAVE_EVERY_S = 1;
/** The event that counts as a repetition: the first of these that the exercise has. */
const REPETITIONS = ['step_done', 'level_done'] as const;

/** Active time and repetitions of a session, as far as this page has seen it, also before a reload. */
export class SessionCounters {
  active_s = 0;
  repetitions = 0;
  from: Date | undefined;
  /** When rendering ended; undefined while it continues, and before the first time. */
  ended: Date | undefined;
  private session = -1;
  private recording = '';
  private time_s = 0;
  private saved_s = 0;
  private rendered = false;

  /** @param recording name of the file that is written; empty: none */
  onState({ session, timeS, runState }: Pick<WorldStateT, 'session' | 'timeS' | 'runState'>, paused: boolean, now: Date, recording = ''): void {
    const renders = runState === RunState.Rendering;
    if (this.session < 0) this.restore(session, renders ? timeS : Infinity, recording);
    if (session !== this.session && renders) {
      this.session = session;
      this.recording = '';
      this.active_s = this.repetitions = 0;
      this.from = now;
      this.ended = undefined;
      this.saved_s = -Infinity;
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
    if (ends || timeS - this.saved_s >= SAVE_EVERY_S) this.save();
  }

  /** @param all names of the exercise's events */
  count(event: string, all: readonly string[]): void {
    if (event !== REPETITIONS.find((name) => all.includes(name))) return;
    this.repetitions += 1;
    this.save();
  }

  /** Restores the counters from before a reload. The recording is compared too, since a restarted program counts sessions from 1 again. */
  private restore(session: number, now_s: number, recording: string): void {
    const kept = loadCounters();
    if (kept?.session !== session || kept.time_s > now_s) return;
    // No recording is written between sessions.
    const between = now_s === Infinity && recording === '';
    if (kept.recording !== recording && !between) return;
    Object.assign(this, { session, recording: kept.recording, time_s: kept.time_s, kept_s: kept.time_s, active_s: kept.active_s, repetitions: kept.repetitions });
    this.from = new Date(kept.from_ms);
    this.ended = kept.ended_ms === null ? undefined : new Date(kept.ended_ms);
    this.rendered = this.ended === undefined;
  }

  private save(): void {
    const { session, recording, time_s, active_s, repetitions, from, ended } = this;
    if (!from) return;
    saveCounters({ session, recording, time_s, active_s, repetitions, from_ms: from.getTime(), ended_ms: ended?.getTime() ?? null });
    this.saved_s = time_s;
  }
}
