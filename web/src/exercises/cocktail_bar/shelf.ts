// A shelf on the counter that bears bottles: a board of the counter's wood over boarded sides, with a brass edge. Frame: y up, z to the person [m].

import { BoxGeometry, Color, Group, Mesh, type Vector3 } from 'three';
import { surface } from '../../scene/materials';
import type { Quality } from '../../scene/quality';
import { brass } from '../../scene/stage';
import { woodTexture } from '../../scene/textures';

const BOARD_M = 0.022;
const BRASS_M = 0.005;
/** Offset of the sides from the board's edge, and gap between their boards [m]. */
const BACK_M = 0.012;
const GAP_M = 0.004;
const PLANK_M = 0.1;

/** @param half half of its width, height and depth */
export function makeShelf(half: Vector3, quality: Quality): Group {
  const root = new Group(), wood = woodTexture();
  wood.repeat.set(half.x, half.z);
  const board = surface(quality, { map: wood, color: quality === 'low' ? new Color(1.75, 1.42, 1.16) : new Color('#c4a48c'), roughness: 0.42, clearcoat: 0.4, clearcoatRoughness: 0.3 });
  const sides = surface(quality, { color: new Color('#3f2a1f'), roughness: 0.7 }), dark = surface(quality, { color: new Color('#241811'), roughness: 0.9 });
  const box = (x: number, y: number, z: number, size: [number, number, number], material: typeof board) => {
    const mesh = new Mesh(new BoxGeometry(...size), material);
    mesh.position.set(x, y, z);
    mesh.castShadow = mesh.receiveShadow = true;
    root.add(mesh);
  };
  const top = half.y - BOARD_M, high = 2 * half.y - BOARD_M, middle = -half.y + high / 2, deep = 2 * (half.z - BACK_M);
  box(0, half.y - BOARD_M / 2, 0, [2 * half.x, BOARD_M, 2 * half.z], board);
  box(0, top + BRASS_M / 2, half.z, [2 * half.x, BRASS_M, 0.003], brass(quality));
  const planks = Math.max(1, Math.round((2 * (half.x - BACK_M)) / PLANK_M)), wide = (2 * (half.x - BACK_M)) / planks;
  box(0, middle, 0, [2 * (half.x - BACK_M) - GAP_M, high, deep - GAP_M], dark);
  for (let i = 0; i < planks; i++) box((i + 0.5 - planks / 2) * wide, middle, 0, [wide - GAP_M, high, deep], sides);
  return root;
}
