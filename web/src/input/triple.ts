// Sums and products of triples.
import type { Triple } from './wish';

export const minus = (a: Triple, b: Triple): Triple => ({ x: a.x - b.x, y: a.y - b.y, z: a.z - b.z });
export const times = (a: Triple, by: number): Triple => ({ x: by * a.x, y: by * a.y, z: by * a.z });
export const plus = (a: Triple, b: Triple): Triple => minus(a, times(b, -1));
export const dot = (a: Triple, b: Triple): number => a.x * b.x + a.y * b.y + a.z * b.z;
export const length = (a: Triple): number => Math.sqrt(dot(a, a));
