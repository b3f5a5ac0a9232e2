// The two bottles that this exercise compares.
import { ShapeType, type SceneT } from '../../protocol';

/** The value `instruction` (src/exercises/tell_apart/comparing.hpp). */
export const Instruction = { First: 0, Second: 1, Hold: 2, LetGo: 3, Answer: 4, Rest: 5, OneAtATime: 6, Done: 7 } as const;

/** Indices of the bottles' bodies, the lower one first. Undefined for another exercise. */
export function bottlesOf(scene: Pick<SceneT, 'exerciseJson' | 'bodies'>): readonly [number, number] | undefined {
  if (!isOfKind(String(scene.exerciseJson ?? ''))) return undefined;
  const bottles = scene.bodies.flatMap(({ fixed, shapes }, body) => (fixed && shapes.length === 1 && shapes[0]!.type === ShapeType.Cylinder ? [body] : []));
  return bottles.length === 2 ? [bottles[0]!, bottles[1]!] : undefined;
}

function isOfKind(json: string): boolean {
  try {
    return (JSON.parse(json) as { kind?: unknown } | null)?.kind === 'tell_apart';
  } catch {
    return false;
  }
}
