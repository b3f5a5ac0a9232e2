import { LatheGeometry, Mesh, Vector2, type BufferAttribute, type BufferGeometry, type Material } from 'three';
import type { Quality } from './quality';

/** A point of an end's outline: radius as a share of the body's, distance from the end [m]. */
type EndPoint = readonly [share: number, inside_m: number];

/** A soft body of revolution: y along its axis, the origin in its middle. Its straight side has so many segments that it can deform. @param end outline of both ends, from the axis on @param straight_m the straight side begins this far from the ends */
export function softBody({ radius_m: r, height_m }: { readonly radius_m: number; readonly height_m: number }, end: readonly EndPoint[], straight_m: number, quality: Quality, material: Material): Mesh<BufferGeometry> {
  const half = height_m / 2, rows = quality === 'high' ? 40 : 2, low = -half + straight_m, high = half - straight_m;
  const side = Array.from({ length: rows }, (_, i) => [r, low + (high - low) * i / (rows - 1)] as const);
  const lower = [[1e-4, -half] as const, ...end.map(([share, inside_m]) => [share * r, -half + inside_m] as const)];
  const profile = [...lower, ...side, ...lower.map(([x, y]) => [x, -y] as const).reverse()];
  const geometry = new LatheGeometry(profile.map(([x, y]) => new Vector2(x, y)), quality === 'high' ? 96 : 32, Math.PI);
  const uv = geometry.attributes.uv as BufferAttribute, at = geometry.attributes.position as BufferAttribute;
  for (let i = 0; i < uv.count; i++) uv.setY(i, at.getY(i) / height_m + 0.5);
  const mesh = new Mesh(geometry, material);
  mesh.castShadow = mesh.receiveShadow = true;
  return mesh;
}
