// What a therapist reads of a session, and sets with one touch.
import { describe, expect, it } from 'vitest';
import { readFileSync } from 'node:fs';
import { stepped } from '../src/console/big_controls';
import { Tally } from '../src/console/tally';
import { RunState } from '../src/protocol';

describe('a session', () => {
  const at = (minute: number): Date => new Date(2026, 0, 1, 14, minute);
  const state = (timeS: number, session = 3, runState = RunState.Rendering) => ({ session, timeS, runState });

  it('is active while it renders and is not paused; who was called away reads when it ended', () => {
    const tally = new Tally();
    for (let s = 0; s <= 60; s += 1) tally.look(state(s), false, at(0));
    for (let s = 61; s <= 90; s += 1) tally.look(state(s), true, at(1));
    for (const event of ['engaged', 'step_done', 'level_done', 'step_done']) tally.count(event, ['engaged', 'step_done', 'level_done']);
    expect([tally.active_s, tally.repetitions, tally.from, tally.ended]).toEqual([60, 2, at(0), undefined]);
    tally.look(state(91, 3, RunState.Stopping), false, at(2));
    tally.look(state(92, 3, RunState.Stopped), false, at(9));
    expect([tally.active_s, tally.ended]).toEqual([60, at(2)]);
    tally.look(state(0, 4), false, at(10));
    expect([tally.active_s, tally.repetitions, tally.from, tally.ended]).toEqual([0, 0, at(10), undefined]);
  });

  it('counts whole levels where an exercise has no steps', () => {
    const tally = new Tally();
    for (const event of ['touched', 'level_done']) tally.count(event, ['touched', 'level_done']);
    expect(tally.repetitions).toBe(1);
  });
});

describe('one touch', () => {
  it.each([[10, 1, 10], [9.2, 1, 9.5], [9.5, 1, 10], [9.5, -1, 9], [9.2, -1, 9], [2, -1, 2], [2.3, -1, 2]] as const)('from %f by %i is %f, of 2 to 10 in steps of 0.5', (shown, way, next) => {
    expect(stepped(shown, way, { lower: 2, upper: 10 }, 0.5)).toBe(next);
  });
});

describe('notices', () => {
  it('have a place of their own, whose height never changes, and one is shown at a time', () => {
    const css = readFileSync(new URL('../src/console/console.css', import.meta.url), 'utf8');
    expect(css).toContain('#app.live-page { grid-template-rows: 72px 48px minmax(0, 1fr); }');
    expect(css).toContain('.below .notice:not([hidden]) ~ .notice { display: none; }');
    // Narrow, the page scrolls: it jumps as little.
    expect(css).toMatch(/max-width: 1199px[^]*#app\.live-page \{ grid-template-rows: auto \d+px auto; \}/);
  });
});
