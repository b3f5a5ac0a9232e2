import { expect, test, vi } from 'vitest';
import { changeLoaded, letProgramPlay, Press, takeOver, type PlayContext } from '../src/game/takeover';
import type { Connection } from '../src/net/connection';
import type { Answer } from '../src/net/pending_answers';
import { RunState, Steering } from '../src/protocol';

const YES: Answer = { accepted: true, reason: '' };
const known = (): PlayContext => ({ play: null, hardware: false });
const wishes = { way: 'mouse', level: 2, fresh: true };

/** A waiting program; a load takes until the test ends it. */
function waitingProgram() {
  const asked: string[] = [];
  let loaded: (answer: Answer) => void = () => {};
  const ask = (what: string) => async () => { asked.push(what); return YES; };
  const connection = {
    endings: 4, basis: 6, controls: { heldByYou: false, held: false, led: false }, scene: { level: 1, axes: [] }, latestState: { runState: RunState.Disarmed as RunState, rested: false },
    takeControls: ask('take'), releaseControls: ask('release'), steer: ask('steer'), act: ask('act'), aim: ask('aim'),
    arm: async (seen: number, basis: number) => { expect(basis).toBe(6); asked.push(`arm ${seen}`); return YES; },
    loadExercise: () => new Promise<Answer>((settle) => { asked.push('load'); loaded = settle; }),
  };
  return { asked, connection, asConnection: connection as unknown as Connection, finishLoading: () => loaded(YES) };
}

/** The page's orders after the level was loaded, if `happens` occurred during loading. */
async function startWhile(happens: (program: ReturnType<typeof waitingProgram>, press: Press) => void): Promise<{ asked: string[]; is: string }> {
  vi.useFakeTimers();
  try {
    const program = waitingProgram();
    const press = new Press(program.asConnection, program.connection.endings, 6);
    const outcome = takeOver(program.asConnection, known, press, wishes);
    await vi.advanceTimersByTimeAsync(10);
    happens(program, press);
    program.finishLoading();
    await vi.advanceTimersByTimeAsync(10_000);
    return { asked: program.asked, is: (await outcome).is };
  } finally {
    vi.useRealTimers();
  }
}

test('TakeOver_WithoutAStop_ArmsWithTheEndingShownAtThePress', async () => {
  const { asked } = await startWhile(() => {});
  expect(asked).toEqual(['take', 'load', 'arm 4', 'steer', 'aim', 'act']);
});

test('TakeOver_StopPressedWhileItLoads_SendsNothingMore', async () => {
  const { asked, is } = await startWhile((_, press) => press.cancel());
  expect(asked).toEqual(['take', 'load', 'release']);
  expect(is).toBe('stopped');
});

test('TakeOver_StopOfAnotherClientWhileItLoads_SendsNothingMore', async () => {
  const { asked, is } = await startWhile(({ connection }) => { connection.endings += 1; });
  expect(asked).toEqual(['take', 'load', 'release']);
  expect(is).toBe('stopped');
});

/** A program that loses the page while it arms, `times` times: the controls are gone, and the order is refused. */
async function startUnheard(times: number): Promise<{ asked: string[]; is: string }> {
  const { asked, connection, asConnection, finishLoading } = waitingProgram();
  const controls = connection.controls;
  Object.assign(connection, {
    takeControls: async () => { asked.push('take'); controls.heldByYou = true; return YES; },
    steer: async () => {
      asked.push('steer');
      if (times-- <= 0) return YES;
      controls.heldByYou = false;
      return { accepted: false, reason: 'not the holder' };
    },
  });
  connection.scene.level = wishes.level;
  connection.latestState.runState = RunState.Rendering;
  vi.useFakeTimers();
  try {
    const outcome = takeOver(asConnection, () => ({ play: { phase: () => 'reach' } as unknown as PlayContext['play'], hardware: false }), new Press(asConnection, connection.endings, 6), wishes);
    finishLoading();
    await vi.advanceTimersByTimeAsync(10_000);
    return { asked, is: (await outcome).is };
  } finally {
    vi.useRealTimers();
  }
}

test('TakeOver_ControlsLostBySilence_AreTakenAgainByTheSamePress_ThreeTimesAtMost', async () => {
  expect(await startUnheard(2)).toEqual({ asked: ['take', 'steer', 'take', 'steer', 'take', 'steer', 'aim', 'act'], is: 'playing' });
  const never = await startUnheard(99);
  expect(never.asked).toEqual(['take', 'steer', 'take', 'steer', 'take', 'steer', 'release']);
  expect(never.is).toBe('refused');
});

/** A program that refuses `times` starts, since the page drew and was not heard in time. A stop of somebody else may come with the first one. */
async function armUnheard(times: number, stopped = false): Promise<{ asked: string[]; is: string }> {
  const { asked, connection, asConnection } = waitingProgram();
  connection.scene.level = wishes.level;
  Object.assign(connection, {
    arm: async () => {
      asked.push('arm');
      if (stopped) connection.endings += 1;
      if (times-- > 0) return { accepted: false, reason: 'not heard', unheard: true };
      connection.latestState.runState = RunState.Rendering;
      return YES;
    },
  });
  vi.useFakeTimers();
  try {
    const outcome = takeOver(asConnection, () => ({ play: { phase: () => 'reach' } as unknown as PlayContext['play'], hardware: false }), new Press(asConnection, connection.endings, 6), wishes);
    await vi.advanceTimersByTimeAsync(20_000);
    return { asked, is: (await outcome).is };
  } finally {
    vi.useRealTimers();
  }
}

test('TakeOver_PageNotHeardWhenItWasToBegin_AsksAgainByTheSamePress_ThreeTimesAtMost', async () => {
  expect(await armUnheard(2)).toEqual({ asked: ['take', 'arm', 'take', 'arm', 'take', 'arm', 'steer', 'aim', 'act'], is: 'playing' });
  expect(await armUnheard(99)).toEqual({ asked: ['take', 'arm', 'take', 'arm', 'take', 'arm', 'release'], is: 'refused' });
  expect(await armUnheard(99, true), 'a stop voids the press').toEqual({ asked: ['take', 'arm', 'release'], is: 'stopped' });
});

test('Press_OnAScreenFromBeforeAStop_NoLongerHolds', async () => {
  const { asked, connection, asConnection } = waitingProgram();
  const press = new Press(asConnection, connection.endings - 1, 6);
  expect(press.holds).toBe(false);
  await letProgramPlay(asConnection, known, press);
  expect(asked).toEqual(['take', 'release']);
});

test('LetProgramPlay_UntilItHasBegun_HoldsTheControls', async () => {
  const { asked, connection, asConnection } = waitingProgram();
  let begun: (answer: Answer) => void = () => {};
  Object.assign(connection, { arm: () => new Promise<Answer>((settle) => { asked.push('arm'); begun = settle; }) });
  const shown = letProgramPlay(asConnection, known, new Press(asConnection, 4, 6));
  await Promise.resolve();
  expect(asked, 'what their holder asked for begins nothing once they are given back').toEqual(['take', 'arm']);
  begun(YES);
  await shown;
  expect(asked).toEqual(['take', 'arm', 'release']);
});

test('LetProgramPlay_AfterAPlayerPausedAndLeft_Continues', async () => {
  const { asked, connection, asConnection } = waitingProgram();
  Object.assign(connection.latestState, { runState: RunState.Rendering, faults: 0, qM: [0], intention: [0] });
  const paused = (): PlayContext => ({ play: { isPaused: () => true } as unknown as PlayContext['play'], hardware: false });
  await letProgramPlay(asConnection, paused, new Press(asConnection, 4, 6));
  expect(asked).toEqual(['take', 'act', 'release']);
  Object.assign(connection.controls, { held: true });
  await letProgramPlay(asConnection, paused, new Press(asConnection, 4, 6));
  expect(asked, 'somebody rests here').toHaveLength(3);
});

test('ChangeLevel_StopPressedWhileItLoads_DoesNotSteer', async () => {
  const { asked, connection, asConnection, finishLoading } = waitingProgram();
  const press = new Press(asConnection, connection.endings, 6);
  const changed = changeLoaded(asConnection, () => ({ play: { phase: () => 'reach' } as unknown as PlayContext['play'], hardware: false }), press, { level: 2 });
  press.cancel();
  connection.scene.level = 2;
  finishLoading();
  await changed;
  expect(asked).toEqual(['load']);
});

test('ChangeLoaded_ToTheOtherHand_KeepsTheLevelAndPlaysOn', async () => {
  const { asked, connection, asConnection } = waitingProgram();
  Object.assign(connection.scene, { level: 2, handName: 'adult-small-right' });
  Object.assign(connection, { loadExercise: async (...what: unknown[]) => {
    asked.push(`load ${what.join()}`);
    Object.assign(connection.scene, { handName: what[2] });
    return YES;
  } });
  Object.assign(connection.latestState, { runState: RunState.Rendering, steering: Steering.Person });
  const playing = (): PlayContext => ({ play: { phase: () => 'reach' } as unknown as PlayContext['play'], hardware: false });
  for (const hand of ['adult-small-left', 'adult-small-left', undefined])
    expect(await changeLoaded(asConnection, playing, new Press(asConnection, 4, 6), { level: 2, hand })).toEqual(YES);
  expect(asked).toEqual(['load ,2,adult-small-left', 'steer', 'steer', 'steer']);
});

test('TakeOver_AfterARefusal_GivesTheControlsBack', async () => {
  const { asked, asConnection } = waitingProgram();
  const refusing = Object.assign(asConnection, { loadExercise: async () => ({ accepted: false, reason: 'no such level' }) });
  const outcome = await takeOver(refusing, known, new Press(refusing, 4, 6), wishes);
  expect(outcome).toEqual({ is: 'refused', reason: 'no such level' });
  expect(asked).toEqual(['take', 'release']);
});

test('TakeOver_TherapistLeadsAndNothingRuns_IsRefusedWithTheReason', async () => {
  const { asked, connection, asConnection } = waitingProgram();
  connection.controls.led = true;
  const outcome = await takeOver(asConnection, known, new Press(asConnection, 4, 6), wishes);
  expect([outcome.is, asked]).toEqual(['refused', []]);
});

test('TakeOver_TherapistLeadsAndItRuns_PlaysTheTherapistsChoice', async () => {
  vi.useFakeTimers();
  const { asked, connection, asConnection } = waitingProgram();
  connection.controls.led = true;
  connection.latestState.runState = RunState.Rendering;
  const outcome = takeOver(asConnection, known, new Press(asConnection, 4, 6), wishes);
  await vi.advanceTimersByTimeAsync(10_000);
  vi.useRealTimers();
  expect((await outcome).is).toBe('playing');
  expect(asked).not.toContain('load');
  expect(asked.some((what) => what.startsWith('arm'))).toBe(false);
});

test('TakeOver_AfterOnesOwnRest_ArmsWithTheEndingThatWasShown', async () => {
  vi.useFakeTimers();
  const { asked, connection, asConnection } = waitingProgram();
  Object.assign(connection.controls, { led: true });
  Object.assign(connection.latestState, { runState: RunState.Stopped, rested: true });
  const outcome = takeOver(asConnection, known, new Press(asConnection, 4, 6), wishes);
  await vi.advanceTimersByTimeAsync(10_000);
  vi.useRealTimers();
  await outcome;
  expect(asked.slice(0, 2)).toEqual(['take', 'arm 4']);
});
