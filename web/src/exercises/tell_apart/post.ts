// Two soft bottles on a brass post: one plain band on the lower one, two on the upper one.
import { Color, CylinderGeometry, Group, Mesh, SphereGeometry, type BufferGeometry, type Texture } from 'three';
import { surface } from '../../scene/materials';
import type { Quality } from '../../scene/quality';
import { softBody } from '../../scene/soft_body';
import { brass } from '../../scene/stage';
import { picture } from '../../scene/textures';
import type { Bottle } from './bottles';

const LOOKS = [{ color: '#3B6FD1', deep: '#1F4593', bands: 1 }, { color: '#E9B22C', deep: '#9A6A08', bands: 2 }] as const;
const POST_RADIUS_M = 0.006;
/** The post with its knob ends this far above the upper bottle [m]. */
export const ABOVE_M = 0.045;
/** Radius and height of the foot [m]. */
export const FOOT_M = 0.05;
const FOOT_TALL_M = 0.012;

/** Rubber with fine ribs and pale bands around its middle. */
function rubber({ color, deep, bands }: (typeof LOOKS)[number]): Texture {
  const w = 64, h = 1024;
  return picture(w, h, (pen) => {
    pen.fillStyle = color;
    pen.fillRect(0, 0, w, h);
    pen.globalAlpha = 0.28;
    pen.fillStyle = deep;
    for (let y = 0; y < h; y += 32) pen.fillRect(0, y, w, 9);
    pen.globalAlpha = 1;
    for (let i = 0; i < bands; i++) {
      const y = h / 2 + (i - (bands - 1) / 2) * 130 - 42;
      pen.fillStyle = deep;
      pen.fillRect(0, y - 8, w, 100);
      pen.fillStyle = '#FFF4DC';
      pen.fillRect(0, y, w, 84);
    }
  });
}

/** A bottle with its collars, the origin in its middle, y along its axis. No part exceeds the collision cylinder sideways. @param which 0: the lower one */
export function makeBottle(bottle: Bottle, which: 0 | 1, quality: Quality): { root: Group; side: BufferGeometry } {
  const root = new Group(), side = softBody(bottle, [[0.5, 0], [0.86, 0.003], [0.965, 0.008]], 0.014, quality, surface(quality, { map: rubber(LOOKS[which]), roughness: 0.5, clearcoat: 0.3, clearcoatRoughness: 0.4 })), metal = brass(quality);
  root.add(side);
  for (const end of [-1, 1]) {
    const collar = new Mesh(new CylinderGeometry(0.42 * bottle.radius_m, 0.42 * bottle.radius_m, 0.006, quality === 'high' ? 40 : 20), metal);
    collar.position.y = end * (bottle.height_m / 2 + 0.003);
    collar.castShadow = true;
    root.add(collar);
  }
  return { root, side: side.geometry };
}

/** The post through both, with foot and knob; its origin stands on the counter. @param tall_m height over the counter, with the knob */
export function makePost(tall_m: number, quality: Quality): Group {
  const root = new Group(), metal = brass(quality), round = quality === 'high' ? 40 : 20;
  const knob_m = 1.9 * POST_RADIUS_M;
  const add = (mesh: Mesh, y_m: number) => {
    mesh.position.y = y_m;
    mesh.castShadow = true;
    root.add(mesh);
  };
  add(new Mesh(new CylinderGeometry(POST_RADIUS_M, POST_RADIUS_M, tall_m - knob_m, round), metal), (tall_m - knob_m) / 2);
  add(new Mesh(new CylinderGeometry(0.8 * FOOT_M, FOOT_M, FOOT_TALL_M, round), surface(quality, { color: new Color('#3A2A20'), roughness: 0.5 })), FOOT_TALL_M / 2);
  add(new Mesh(new SphereGeometry(knob_m, round, round / 2), metal), tall_m - knob_m);
  return root;
}
