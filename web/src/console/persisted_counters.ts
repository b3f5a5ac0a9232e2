// Counters of a session that survive a reload of the page. They are in the tab's session storage, for one session at a time.

/** The counters of one session, and its recording. */
export interface PersistedCounters {
  readonly session: number;
  readonly recording: string;   // empty: none
  readonly time_s: number;
  readonly active_s: number;
  readonly led_s: number;
  readonly repetitions: number;
  readonly from_ms: number;
  readonly ended_ms: number | null;
}

const STORED = 'wholehand.tally';
/** A longer text was not written by this page [characters]. */
const LONGEST = 1000;
/** Largest time that a Date represents [ms]. */
const LAST_MS = 8.64e15;

const isTime = (x: unknown, most: number): x is number => typeof x === 'number' && x >= 0 && x <= most;
const isCount = (x: unknown): x is number => typeof x === 'number' && Number.isSafeInteger(x) && x >= 0;

/** @return null where the text is damaged */
export function parseCounters(text: string | null): PersistedCounters | null {
  if (text === null || text.length > LONGEST) return null;
  let read: Partial<Record<keyof PersistedCounters, unknown>> | null;
  try { read = JSON.parse(text) as typeof read; } catch { return null; }
  if (typeof read !== 'object' || read === null) return null;
  const { session, recording, time_s, active_s, led_s, repetitions, from_ms, ended_ms } = read;
  if (!isCount(session) || typeof recording !== 'string' || !isCount(repetitions)) return null;
  if (![time_s, active_s, led_s].every((x) => isTime(x, LAST_MS / 1000))) return null;
  if (!isTime(from_ms, LAST_MS) || !(ended_ms === null || (isTime(ended_ms, LAST_MS) && ended_ms >= from_ms))) return null;
  return { session, recording, time_s: time_s as number, active_s: active_s as number, led_s: led_s as number, repetitions, from_ms, ended_ms };
}

export function loadCounters(): PersistedCounters | null {
  try { return parseCounters(sessionStorage.getItem(STORED)); } catch { return null; }
}

export function saveCounters(counters: PersistedCounters): void {
  try { sessionStorage.setItem(STORED, JSON.stringify(counters)); } catch { /* without storage a reload starts at zero */ }
}
