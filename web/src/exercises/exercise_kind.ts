// The kind of a scene's exercise (Scene.exercise_json; docs/exercises.md).
import type { SceneT } from '../protocol';

/** Whether a scene's exercise is of a kind; false where its data cannot be read. */
export function isOfKind(scene: Pick<SceneT, 'exerciseJson'> | null | undefined, kind: string): boolean {
  try {
    return (JSON.parse(String(scene?.exerciseJson ?? '')) as { kind?: unknown } | null)?.kind === kind;
  } catch {
    return false;
  }
}
