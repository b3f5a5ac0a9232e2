import { asProblem, type Problem } from './problem';
import type { RecordingSource } from './recording_source';
import { ReplaySide } from './side';

/** A recording that was asked for and cannot be shown. */
export interface Failed { readonly name: string; readonly problem: Problem }

/** What opens of the recordings that were asked for. */
export interface Opened { readonly sides: readonly ReplaySide[]; readonly failed: readonly Failed[] }

/** Opens each recording for itself: one that cannot be shown hides no other. */
export async function openSides(sources: readonly RecordingSource[]): Promise<Opened> {
  const tried = await Promise.allSettled(sources.map((source) => ReplaySide.open(source)));
  return {
    sides: tried.flatMap((one) => (one.status === 'fulfilled' ? [one.value] : [])),
    failed: tried.flatMap((one, i) => (one.status === 'rejected' ? [{ name: sources[i].name, problem: asProblem(one.reason) }] : [])),
  };
}
