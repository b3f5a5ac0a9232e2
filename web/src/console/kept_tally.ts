// A session's counters over a reload of the page: in the tab's own storage, one session at a time.

/** What a tally has seen of the session and recording. */
export interface KeptTally {
  readonly session: number;
  readonly recording: string;   // empty: none
  readonly time_s: number;
  readonly active_s: number;
  readonly repetitions: number;
  readonly from_ms: number;
  readonly ended_ms: number | null;
}

const STORED = 'wholehand.tally';
/** Longer is nothing that this page wrote [characters]. */
const LONGEST = 1000;
/** Dates reach so far [ms]. */
const LAST_MS = 8.64e15;

const isTime = (x: unknown, most: number): x is number => typeof x === 'number' && x >= 0 && x <= most;
const isCount = (x: unknown): x is number => typeof x === 'number' && Number.isSafeInteger(x) && x >= 0;

/** @return null where the text is damaged */
export function readKeptTally(text: string | null): KeptTally | null {
  if (text === null || text.length > LONGEST) return null;
  let read: Partial<Record<keyof KeptTally, unknown>> | null;
  try { read = JSON.parse(text) as typeof read; } catch { return null; }
  if (typeof read !== 'object' || read === null) return null;
  const { session, recording, time_s, active_s, repetitions, from_ms, ended_ms } = read;
  if (!isCount(session) || typeof recording !== 'string' || !isCount(repetitions)) return null;
  // Nobody is active for longer than the session lasts.
  if (!isTime(time_s, LAST_MS / 1000) || !isTime(active_s, time_s)) return null;
  if (!isTime(from_ms, LAST_MS) || !(ended_ms === null || (isTime(ended_ms, LAST_MS) && ended_ms >= from_ms))) return null;
  return { session, recording, time_s, active_s, repetitions, from_ms, ended_ms };
}

export function keptTally(): KeptTally | null {
  try { return readKeptTally(sessionStorage.getItem(STORED)); } catch { return null; }
}

export function keepTally(tally: KeptTally): void {
  try { sessionStorage.setItem(STORED, JSON.stringify(tally)); } catch { /* a reload begins anew */ }
}
