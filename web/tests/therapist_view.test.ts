// A therapist's display of a session, and its one-press controls.
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { readFileSync } from 'node:fs';
import { stepped } from '../src/console/big_controls';
import { parseCounters } from '../src/console/persisted_counters';
import { SessionCounters } from '../src/console/session_counters';
import { RunState } from '../src/protocol';

describe('a session', () => {
  const at = (minute: number): Date => new Date(2026, 0, 1, 14, minute);
  const state = (timeS: number, session = 3, runState = RunState.Rendering) => ({ session, timeS, runState, activeS: timeS / 2, ledS: timeS / 4 });

  it('shows the times that the program counts; its end time is kept', () => {
    const counters = new SessionCounters();
    for (let s = 0; s <= 90; s += 1) counters.onState(state(s), at(0));
    for (const event of ['engaged', 'step_done', 'level_done', 'step_done']) counters.count(event, ['engaged', 'step_done', 'level_done']);
    expect([counters.active_s, counters.repetitions, counters.from, counters.ended]).toEqual([45, 2, at(0), undefined]);
    counters.onState(state(92, 3, RunState.Stopping), at(2));
    counters.onState(state(94, 3, RunState.Stopped), at(9));
    expect([counters.active_s, counters.led_s, counters.ended]).toEqual([46, 23, at(2)]);
    counters.onState(state(0, 4), at(10));
    expect([counters.active_s, counters.repetitions, counters.from, counters.ended]).toEqual([0, 0, at(10), undefined]);
  });

  it('counts whole levels if an exercise has no steps', () => {
    const counters = new SessionCounters();
    for (const event of ['touched', 'level_done']) counters.count(event, ['touched', 'level_done']);
    expect(counters.repetitions).toBe(1);
  });
});

describe('a reload of the page', () => {
  const at = (minute: number): Date => new Date(2026, 0, 1, 14, minute);
  const state = (timeS: number, session = 3, runState = RunState.Rendering) => ({ session, timeS, runState, activeS: timeS / 2, ledS: timeS / 4 });
  const figures = ({ active_s, repetitions, from, ended }: SessionCounters) => [active_s, repetitions, from, ended];
  let stored: Map<string, string>;

  /** A session of a minute with two repetitions, as the page has it before a reload. */
  function aMinute(recording: string): void {
    const counters = new SessionCounters();
    for (let s = 0; s <= 60; s += 1) counters.onState(state(s), at(0), recording);
    for (let k = 0; k < 2; k += 1) counters.count('step_done', ['step_done']);
  }

  beforeEach(() => {
    stored = new Map();
    vi.stubGlobal('sessionStorage', { getItem: (key: string) => stored.get(key) ?? null, setItem: (key: string, text: string) => { stored.set(key, text); } });
  });
  afterEach(() => vi.unstubAllGlobals());

  it.each(['a.h5', ''])('keeps the counters of a running session, recorded as "%s"', (recording) => {
    aMinute(recording);
    const again = new SessionCounters();
    again.onState(state(63), at(9), recording);
    expect(figures(again)).toEqual([31.5, 2, at(0), undefined]);
    again.count('step_done', ['step_done']);
    again.onState(state(64, 3, RunState.Stopping), at(10), recording);
    const afterTheEnd = new SessionCounters();
    afterTheEnd.onState(state(0, 3, RunState.Stopped), at(20), '');
    expect(figures(afterTheEnd)).toEqual([32, 3, at(0), at(10)]);
  });

  it.each([
    ['another session', state(70, 4), 'a.h5'], ['another recording, of a program that began anew', state(70), 'b.h5'],
    ['none, of a program that began anew', state(70), ''], ['an earlier time, of a program that began anew', state(2), 'a.h5'],
  ] as const)('starts new counters with %s', (_what, now, recording) => {
    aMinute('a.h5');
    const again = new SessionCounters();
    again.onState(now, at(9), recording);
    expect(figures(again).slice(1)).toEqual([0, at(9), undefined]);
  });

  it('keeps one session, and stores at most once a second', () => {
    const written = vi.spyOn(sessionStorage, 'setItem'), counters = new SessionCounters();
    for (let k = 0; k <= 600; k += 1) counters.onState(state(k / 60), at(0), 'a.h5');
    expect(written.mock.calls.length).toBeLessThanOrEqual(11);
    for (let session = 4; session < 20; session += 1) counters.onState(state(0, session), at(1), `${session}.h5`);
    expect(stored.size).toBe(1);
  });

  it('ignores damaged data', () => {
    aMinute('a.h5');
    const [whole] = stored.values(), kept = parseCounters(whole);
    expect(kept).toMatchObject({ session: 3, recording: 'a.h5', active_s: 30, led_s: 15, repetitions: 2 });
    const damaged = [
      null, '', 'null', '[]', '7', whole.slice(0, -1), `${whole}${' '.repeat(1000)}`,
      ...Object.entries({ session: [-1, 1.5, '3'], recording: [null, 7], time_s: [-1, null, '60'], active_s: [-1, null], led_s: ['1', null], repetitions: [-1, 0.5, 1e300], from_ms: [null, 1e300, '1'], ended_ms: [0, '1', 1e300] })
        .flatMap(([name, values]) => [undefined, ...values].map((value) => JSON.stringify({ ...kept, [name]: value }))),
    ];
    for (const text of damaged) expect(parseCounters(text), String(text)).toBeNull();
    stored.set([...stored.keys()][0], '{');
    const again = new SessionCounters();
    again.onState(state(63), at(9), 'a.h5');
    expect(figures(again).slice(1)).toEqual([0, at(9), undefined]);
  });

  it('starts new counters if the browser stores nothing', () => {
    vi.stubGlobal('sessionStorage', { getItem: () => { throw new Error('denied'); }, setItem: () => { throw new Error('denied'); } });
    const counters = new SessionCounters();
    for (let s = 0; s <= 60; s += 1) counters.onState(state(s), at(0), 'a.h5');
    expect(counters.active_s).toBe(30);
  });
});

describe('one press', () => {
  it.each([[10, 1, 10], [9.2, 1, 9.5], [9.5, 1, 10], [9.5, -1, 9], [9.2, -1, 9], [2, -1, 2], [2.3, -1, 2]] as const)('from %f by %i gives %f, within 2 to 10 in steps of 0.5', (shown, way, next) => {
    expect(stepped(shown, way, { lower: 2, upper: 10 }, 0.5)).toBe(next);
  });
});

describe('notices', () => {
  it('have their own place of constant height, and are shown one at a time', () => {
    const css = readFileSync(new URL('../src/console/console.css', import.meta.url), 'utf8');
    expect(css).toContain('#app.live-page { grid-template-rows: 72px 48px minmax(0, 1fr); }');
    expect(css).toContain('.below .notice:not([hidden]) ~ .notice { display: none; }');
    // In a narrow window, where the page scrolls, the layout does not move either.
    expect(css).toMatch(/max-width: 1199px[^]*#app\.live-page \{ grid-template-rows: auto \d+px auto; \}/);
  });
});
