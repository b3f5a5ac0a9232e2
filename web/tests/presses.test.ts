// Start, after watching and after a stop: who goes on with what was begun.
import { afterEach, beforeEach, expect, test, vi } from 'vitest';
import { Presses } from '../src/game/presses';
import type { Memory } from '../src/game/memory';
import type { Sound } from '../src/game/sound';
import type { Controls } from '../src/input/controls';
import type { Connection } from '../src/net/connection';
import type { Answer } from '../src/net/pending_answers';
import { Act, RunState, Steering } from '../src/protocol';

const YES: Answer = { accepted: true, reason: '' };

beforeEach(() => { vi.useFakeTimers(); });
afterEach(() => { vi.useRealTimers(); });

/** A program that renders, and obeys at once. */
function playing() {
  const acts: Act[] = [];
  const state = { runState: RunState.Rendering, rested: false, steering: Steering.VirtualPatient, qM: [0], intention: [0], values: [], faults: 0 };
  const connection = {
    status: 'open', endings: 4, controls: { heldByYou: false, held: false, led: false }, scene: { level: 1, axes: [] }, latestState: state,
    takeControls: async () => YES, releaseControls: async () => YES, arm: async () => YES, aim: async () => YES,
    steer: async (to: Steering) => { state.steering = to; return YES; },
    act: async (what: Act) => { acts.push(what); return YES; },
  };
  const memory = { wish: 'undecided', isTheirs: true, way: 'mouse', level: 1, endingsShown: 4, press: null, notice: '', known: () => ({ play: { phase: () => 'reach' }, hardware: false }) };
  const controls = { stopWebcam: () => {} }, sound = { unlock: () => {} };
  const presses = new Presses(connection as unknown as Connection, controls as unknown as Controls, memory as unknown as Memory, sound as Sound);
  const start = async (): Promise<Act | undefined> => {
    presses.start();
    await vi.advanceTimersByTimeAsync(3000);
    return acts.at(-1);
  };
  return { presses, memory, start };
}

test('Start_OfANewPerson_BeginsAnew', async () => {
  const { memory, start } = playing();
  expect(await start()).toBe(Act.Restart);
  expect(memory.wish).toBe('play');
});

test('Start_AfterWatching_BeginsAnew', async () => {
  const { presses, start } = playing();
  await presses.watch();
  expect(await start()).toBe(Act.Restart);
});

test('Start_OfWhoeverPlayedBefore_GoesOn', async () => {
  const { memory, start } = playing();
  await start();
  memory.wish = 'watch';   // as a lost line leaves it
  expect(await start()).toBe(Act.Resume);
});
