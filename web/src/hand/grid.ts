import { BufferAttribute, BufferGeometry } from 'three';

/** A surface through points in rows of equal length, with smooth normals. @param at x, y, z of each point, row by row @param cells number of cells of a row, one less than its points */
export function gridGeometry(at: readonly number[], cells: number): BufferGeometry {
  const points = cells + 1, rows = at.length / 3 / points, index: number[] = [];
  for (let row = 0; row + 1 < rows; row++)
    for (let i = 0; i < cells; i++) {
      const q = row * points + i;
      index.push(q, q + 1, q + points, q + 1, q + points + 1, q + points);
    }
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(new Float32Array(at), 3));
  geometry.setIndex(index);
  geometry.computeVertexNormals();
  return geometry;
}
