// Messages of positions and shapes, for the stand-in program.
import { PoseT, QuatXyzwT, ShapeT, ShapeType, Vec3T } from '../src/protocol';
import type { Quad, Triple } from './fake_hand';

export const vec = (v: Triple): Vec3T => new Vec3T(v[0], v[1], v[2]);
export const pose = (p: Triple, q: Quad = [0, 0, 0, 1]): PoseT => new PoseT(vec(p), new QuatXyzwT(q[0], q[1], q[2], q[3]));
export const box = (half: Triple): ShapeT => new ShapeT(ShapeType.Box, vec(half), 0, 0, [], [], pose([0, 0, 0]));
export const cylinder = (radius_m: number, length_m: number, q?: Quad): ShapeT =>
  new ShapeT(ShapeType.Cylinder, vec([0, 0, 0]), radius_m, length_m, [], [], pose([0, 0, 0], q));
