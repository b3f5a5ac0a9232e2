// The pages' display of whether the running session is recorded.
import { expect, test } from 'vitest';
import { RunState } from '../src/protocol';
import { isRecorded } from '../src/shared/recorded';

test.each([
  ['a file is named, and nothing is written yet', 'a.h5', 0n, RunState.Rendering, true],
  ['a program before the name', '', 4096n, RunState.Rendering, true],
  ['neither', '', 0n, RunState.Rendering, false],
  ['nothing runs', '', 0n, RunState.Stopped, undefined],
  ['nothing runs any more', 'a.h5', 4096n, RunState.Stopping, undefined],
])('%s', (_, recording, recordingBytes, runState, expected) => {
  expect(isRecorded({ recording }, { runState, recordingBytes })).toBe(expected);
});

test('is undefined without a scene or a state', () => {
  expect(isRecorded(null, null)).toBeUndefined();
  expect(isRecorded(null, { runState: RunState.Rendering, recordingBytes: 0n })).toBe(false);
});
