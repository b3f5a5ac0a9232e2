import { afterEach, beforeEach, expect, test, vi } from 'vitest';
import { Connection } from '../src/net/connection';
import { FakeProgram } from '../fake/fake_program';
import { Stage } from '../src/exercises/cocktail_bar/bar';
import { FakeBar } from '../fake/fake_bar';
import { Steering } from '../src/protocol';

beforeEach(() => { vi.useFakeTimers(); });
afterEach(() => { vi.useRealTimers(); });

test('StandIn_State_HasAValueForEveryNameOfItsScene', async () => {
  const program = new FakeProgram(new URLSearchParams('level=4'));
  const connection = new Connection({ url: 'ws://nowhere/ws', open: () => program.connect() });
  await vi.advanceTimersByTimeAsync(100);
  const { scene, latestState: state } = connection;
  expect(state!.values).toHaveLength(scene!.valueNames.length);
  expect(state!.links).toHaveLength(scene!.linkNames.length);
  expect(state!.bodies).toHaveLength(scene!.bodies.length);
  expect(state!.parameters).toHaveLength(scene!.parameters.length);
  expect(state!.qM).toHaveLength(scene!.axes.length);
  expect(scene!.capsules).toHaveLength(41);
  expect(state!.steering).toBe(Steering.VirtualPatient);
  connection.close();
});

test.each([1, 2, 3, 4])('StandIn_VirtualPatientOnLevel%i_FinishesTheLevel', (level) => {
  const bar = new FakeBar(level);
  let seconds = 0;
  for (; bar.stage !== Stage.LevelDone && seconds < 400; seconds += 1 / 60) bar.advance(1 / 60, true, true);
  expect(bar.stage).toBe(Stage.LevelDone);
  // The poured liquid is in the glass or spilt: here for the last drink.
  expect(bar.spilt_l).toBeLessThan(0.01);
});
