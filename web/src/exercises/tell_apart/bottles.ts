// The bodies of this exercise's scene: the two bottles that are compared, and the counter below them.
import { ShapeType, type SceneT } from '../../protocol';
import { isOfKind } from '../exercise_kind';

export interface Bottle {
  readonly body: number;
  readonly radius_m: number;
  readonly height_m: number;
}

export interface Pair {
  /** The lower one first. */
  readonly bottles: readonly [Bottle, Bottle];
  /** Index of the counter's body; -1: none. */
  readonly counter: number;
}

/** The value `instruction` (src/exercises/tell_apart/comparing.hpp). */
export const Instruction = { First: 0, Second: 1, Hold: 2, LetGo: 3, Answer: 4, Rest: 5, OneAtATime: 6, Done: 7 } as const;

/** The bottles of a scene: its two fixed cylinders. Undefined for another exercise. */
export function pairOf(scene: Pick<SceneT, 'exerciseJson' | 'bodies'>): Pair | undefined {
  if (!isOfKind(scene, 'tell_apart')) return undefined;
  const fixed = (type: ShapeType) => scene.bodies.flatMap(({ fixed, shapes }, body) => (fixed && shapes.length === 1 && shapes[0]!.type === type ? [{ body, radius_m: shapes[0]!.radiusM, height_m: shapes[0]!.lengthM }] : []));
  const [lower, upper, ...more] = fixed(ShapeType.Cylinder);
  return lower && upper && more.length === 0 ? { bottles: [lower, upper], counter: fixed(ShapeType.Box)[0]?.body ?? -1 } : undefined;
}
