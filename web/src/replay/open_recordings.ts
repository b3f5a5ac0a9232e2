import { asProblem, type Problem } from './problem';
import type { RecordingSource } from './recording_source';
import { ReplaySide } from './side';

/** A requested recording that cannot be shown. */
export interface OpenFailure { readonly name: string; readonly problem: Problem }

/** The opened recordings, and the failures. */
export interface OpenResult { readonly sides: readonly ReplaySide[]; readonly failed: readonly OpenFailure[] }

/** Opens each recording independently: a failure of one does not hide the others. */
export async function openRecordings(sources: readonly RecordingSource[]): Promise<OpenResult> {
  const tried = await Promise.allSettled(sources.map((source) => ReplaySide.open(source)));
  return {
    sides: tried.flatMap((one) => (one.status === 'fulfilled' ? [one.value] : [])),
    failed: tried.flatMap((one, i) => (one.status === 'rejected' ? [{ name: sources[i].name, problem: asProblem(one.reason) }] : [])),
  };
}
