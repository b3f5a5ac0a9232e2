// Start, after watching and after a stop: it depends on the person whether the exercise continues.
import { readFileSync } from 'node:fs';
import { markInputMethod } from '../src/shared/a11y';
import { afterEach, beforeEach, expect, test, vi } from 'vitest';
import { Presses } from '../src/game/presses';
import type { Memory } from '../src/game/memory';
import type { Sound } from '../src/game/sound';
import type { Controls } from '../src/input/controls';
import type { Connection } from '../src/net/connection';
import type { Answer } from '../src/net/pending_answers';
import { en } from '../src/shared/i18n/en';
import { Act, RunState, Steering } from '../src/protocol';

const YES: Answer = { accepted: true, reason: '' };

beforeEach(() => { vi.useFakeTimers(); });
afterEach(() => { vi.useRealTimers(); });

/** A program that renders, and executes orders at once. */
function playing() {
  const acts: Act[] = [];
  let leave = (): void => {};
  const state = { runState: RunState.Rendering, rested: false, steering: Steering.VirtualPatient, qM: [0], intention: [0], values: [], faults: 0 };
  const connection = {
    status: 'open', on: (name: string, callback: () => void) => { if (name === 'leaving') leave = callback; return () => {}; }, endings: 4, basis: 6, controls: { heldByYou: false, held: false, led: false }, scene: { level: 1, axes: [] }, latestState: state,
    takeControls: async () => YES, releaseControls: async () => YES, arm: async () => YES, aim: async () => YES,
    steer: async (to: Steering) => { state.steering = to; return YES; },
    act: async (what: Act) => { acts.push(what); return YES; },
  };
  const memory = { wish: 'undecided', isTheirs: true, credit: { own: true }, stars: { begin: () => {} }, way: 'mouse', level: 1, framing: false, remember: () => {}, endingsShown: 4, basisShown: 6, press: null, notice: '', known: () => ({ play: { phase: () => 'reach', isPaused: () => false }, hardware: false }) };
  const controls = { stopped: 0, stopWebcam() { this.stopped += 1; } }, sound = { unlock: () => {} };
  const presses = new Presses(connection as unknown as Connection, controls as unknown as Controls, memory as unknown as Memory, sound as Sound);
  const start = async (): Promise<Act | undefined> => {
    presses.start();
    await vi.advanceTimersByTimeAsync(3000);
    return acts.at(-1);
  };
  return { presses, memory, connection, controls, start, leave: () => leave() };
}

test('Start_AfterTheProgramDidAPart_BeginsItAnew', async () => {
  const { memory, start } = playing();
  memory.isTheirs = false;
  memory.credit.own = false;
  expect(await start()).toBe(Act.Restart);
});

test('Start_ByANewPerson_RestartsTheExercise', async () => {
  const { memory, start } = playing();
  expect(await start()).toBe(Act.Restart);
  expect(memory.wish).toBe('play');
});

test('Start_AfterWatching_RestartsTheExercise', async () => {
  const { presses, start } = playing();
  await presses.watch();
  expect(await start()).toBe(Act.Restart);
});

test('Start_ByTheEarlierPlayer_ContinuesTheExercise', async () => {
  const { memory, start } = playing();
  await start();
  memory.wish = 'watch';   // as after a lost connection
  expect(await start()).toBe(Act.Resume);
});

/** A person who rests before the device is on continues as a player, not as a watcher. */
test('Rest_WhileStartIsUnderWay_CountsAsAPlayersRest', async () => {
  const { presses, memory, connection } = playing();
  const resting = Object.assign(memory as unknown as Memory, { situation: () => ({ wish: 'undecided' }), beginRest: () => {}, playedBeforeRest: false });
  Object.assign(connection, { rest: async () => YES, takeControls: () => new Promise<Answer>(() => {}) });
  connection.latestState.runState = RunState.Disarmed;
  presses.start();
  await vi.advanceTimersByTimeAsync(0);
  await presses.rest();
  expect(resting.playedBeforeRest).toBe(true);
});

test('Leaving_WhileTheCameraStarts_StopsIt_AndAPressAfterAStopReportsWhyNothingBegan', async () => {
  const { memory, controls, connection, start, leave } = playing();
  leave();
  expect(controls.stopped).toBe(0);
  memory.framing = true;
  leave();
  expect(controls.stopped).toBe(1);
  connection.takeControls = async () => { connection.endings += 1; return YES; };
  await start();
  expect([memory.wish, memory.notice]).toEqual(['undecided', en['refusal.StopNotSeen']]);
});

test('the focus frame around the picture is shown for keys: a click hides it, and a typed key shows it again', () => {
  const page = Object.assign(new EventTarget(), { documentElement: { dataset: {} as Record<string, string> } });
  markInputMethod(page as unknown as Document);
  const after = (type: string): string | undefined => { page.dispatchEvent(new Event(type)); return page.documentElement.dataset.used; };
  expect([page.documentElement.dataset.used, after('pointerdown'), after('keydown')]).toEqual([undefined, 'pointer', 'keys']);
  const css = readFileSync(new URL('../src/game/game.css', import.meta.url), 'utf8');
  expect(css).toContain('[data-used=pointer] #play:focus-visible { box-shadow: none; }');
});
