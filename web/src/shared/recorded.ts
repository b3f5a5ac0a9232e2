import { RunState, type SceneT, type WorldStateT } from '../protocol';

/** Whether the running session is recorded; undefined while none runs, or while its loop does not answer. */
export function isRecorded(scene: Pick<SceneT, 'recording'> | null, state: Pick<WorldStateT, 'runState' | 'recordingBytes'> & Partial<Pick<WorldStateT, 'silent'>> | null): boolean | undefined {
  if (state?.runState !== RunState.Rendering || state.silent) return undefined;
  return String(scene?.recording ?? '') !== '' || state.recordingBytes > 0n;
}
