// The weightless objects of this exercise: cube, cylinder, sphere, disk.
import { ShapeType, type SceneT, type ShapeT } from '../../protocol';
import { isOfKind } from '../exercise_kind';

export type ThingKind = 'cube' | 'cylinder' | 'sphere' | 'disk';

export interface Thing { readonly body: number; readonly name: string; readonly kind: ThingKind; readonly shape: ShapeT; readonly color: string }

function kindOf({ type, radiusM, lengthM }: ShapeT): ThingKind | undefined {
  if (type === ShapeType.Box) return 'cube';
  if (type === ShapeType.Sphere) return 'sphere';
  return type !== ShapeType.Cylinder ? undefined : lengthM < radiusM ? 'disk' : 'cylinder';
}

/** The objects of a scene; undefined for another exercise, or a scene without floating objects. */
export function thingsOf(scene: Pick<SceneT, 'exerciseJson' | 'bodies'> | null | undefined): Thing[] | undefined {
  if (!scene || scene.bodies.length === 0 || !isOfKind(scene, 'free_grasping')) return undefined;
  const things = scene.bodies.flatMap(({ name, fixed, shapes, color }, body): Thing[] => {
    const shape = shapes[0], kind = shape && kindOf(shape);
    return fixed || shapes.length !== 1 || !kind ? [] : [{ body, name: String(name), kind, shape: shape!, color: String(color ?? '') || '#b9a98f' }];
  });
  return things.length === scene.bodies.length && new Set(things.map(({ kind }) => kind)).size === things.length ? things : undefined;
}
