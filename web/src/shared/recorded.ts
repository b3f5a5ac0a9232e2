import { RunState, type SceneT, type WorldStateT } from '../protocol';

/** Whether the running session is recorded; undefined while none runs. */
export function isRecorded(scene: Pick<SceneT, 'recording'> | null, state: Pick<WorldStateT, 'runState' | 'recordingBytes'> | null): boolean | undefined {
  if (state?.runState !== RunState.Rendering) return undefined;
  return String(scene?.recording ?? '') !== '' || state.recordingBytes > 0n;
}
