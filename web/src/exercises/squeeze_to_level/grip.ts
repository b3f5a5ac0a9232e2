// The bodies of this exercise's scene: the grip, and the counter below it.
import { ShapeType, type SceneT } from '../../protocol';
import { isOfKind } from '../exercise_kind';

export interface Grip {
  readonly body: number;
  readonly radius_m: number;
  readonly height_m: number;
  /** Index of the counter's body; -1: none. */
  readonly counter: number;
}

/** The value `instruction` (src/exercises/squeeze_to_level/squeeze_task.hpp). */
export const Instruction = { Reach: 0, More: 1, Hold: 2, Less: 3, LetGo: 4, Done: 5 } as const;

/** The grip of a scene: its fixed cylinder. Undefined for another exercise. */
export function gripOf(scene: Pick<SceneT, 'exerciseJson' | 'bodies'> | null | undefined): Grip | undefined {
  if (!scene || !isOfKind(scene, 'squeeze_to_level')) return undefined;
  const find = (type: ShapeType) => scene.bodies.findIndex(({ fixed, shapes }) => fixed && shapes.length === 1 && shapes[0]!.type === type);
  const body = find(ShapeType.Cylinder), shape = scene.bodies[body]?.shapes[0];
  return shape && { body, radius_m: shape.radiusM, height_m: shape.lengthM, counter: find(ShapeType.Box) };
}
