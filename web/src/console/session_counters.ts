import { RunState, type WorldStateT } from '../protocol';
import { saveCounters, loadCounters } from './persisted_counters';

/** The counters are saved this often, in the session's time [s]. */
const SAVE_EVERY_S = 1;
/** The event that counts as a repetition: the first of these that the exercise has. */
const REPETITIONS = ['step_done', 'level_done'] as const;

/** Times of the person as the program counts them, and repetitions of a session as far as this page has seen it, also before a reload. */
export class SessionCounters {
  active_s = 0;
  led_s = 0;
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
  onState({ session, timeS, runState, activeS, ledS }: Pick<WorldStateT, 'session' | 'timeS' | 'runState' | 'activeS' | 'ledS'>, now: Date, recording = ''): void {
    const renders = runState === RunState.Rendering;
    if (this.session < 0) this.restore(session, renders ? timeS : Infinity, recording);
    if (session !== this.session && renders) {
      this.session = session;
      this.recording = '';
      this.repetitions = 0;
      this.from = now;
      this.ended = undefined;
      this.saved_s = -Infinity;
    }
    const ends = this.rendered && !renders;
    if (ends) this.ended = now;
    this.rendered = renders;
    if (!renders && !ends) return;
    this.time_s = timeS;
    this.active_s = activeS;
    this.led_s = ledS;
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
    Object.assign(this, { session, recording: kept.recording, time_s: kept.time_s, active_s: kept.active_s, led_s: kept.led_s, repetitions: kept.repetitions });
    this.from = new Date(kept.from_ms);
    this.ended = kept.ended_ms === null ? undefined : new Date(kept.ended_ms);
    this.rendered = this.ended === undefined;
  }

  private save(): void {
    const { session, recording, time_s, active_s, led_s, repetitions, from, ended } = this;
    if (!from) return;
    saveCounters({ session, recording, time_s, active_s, led_s, repetitions, from_ms: from.getTime(), ended_ms: ended?.getTime() ?? null });
    this.saved_s = time_s;
  }
}
