// The counter's far end, and the dark area behind it where the guest stands: it covers the room's counter, which extends to the wall.

import { BufferAttribute, Color, Mesh, PlaneGeometry, type Vector3 } from 'three';
import { flat } from '../../scene/materials';

/** Wider than every picture [m]. */
const WIDTH_M = 8.4;
/** Height over the wood, so that it covers the wood [m]. */
const OVER_M = 0.0008;
/** Colours by the share of the way to the wall: the wood's edge, the dark area, the wall's foot. */
const SHADES = [[0, '#4a3022'], [0.07, '#3a2519'], [0.1, '#101a1a'], [0.55, '#10201f'], [1, '#1b3236']] as const;

/** @param deep_m from the counter's end to the wall */
export function counterEnd(deep_m: number): Mesh {
  const geometry = new PlaneGeometry(WIDTH_M, deep_m, 1, SHADES.length - 1).rotateX(-Math.PI / 2), at = geometry.attributes.position;
  const colors = new Float32Array(3 * at.count);
  for (let i = 0; i < at.count; i++) {
    const [share, color] = SHADES[SHADES.length - 1 - Math.floor(i / 2)];
    at.setZ(i, -share * deep_m);
    new Color(color).toArray(colors, 3 * i);
  }
  geometry.setAttribute('color', new BufferAttribute(colors, 3));
  return new Mesh(geometry, flat('#ffffff', { vertexColors: true }));
}

/** @param middle middle of its edge on the counter */
export function placeCounterEnd(end: Mesh, middle: Vector3, turn_rad: number): void {
  end.position.copy(middle).y += OVER_M;
  end.rotation.y = turn_rad;
}
