// A hut over a valley: a wall of planks with a wide window. Its frame is the stage's: y up from the counter.
import { BoxGeometry, Color, Group, Mesh, MeshBasicMaterial, PlaneGeometry, type Material, type Texture } from 'three';
import { surface } from '../../scene/materials';
import type { Quality } from '../../scene/quality';
import { WALL, type Setting } from '../../scene/stage';
import { numbers, tiling } from '../../scene/textures';
import { valleyTexture } from './landscape';
import { makeRunner } from './runner';

const WALL_Z = -0.62;
const VALLEY_Z = -0.72;
/** Size of the valley's painting [m]. */
const VALLEY = { width_m: 1.1, height_m: 0.55, low_m: -0.02 } as const;
/** The window, and the distance of its posts. Within one pane nothing hides the balloon. */
export const WINDOW = { low_m: 0.035, high_m: 0.52, pane_m: 0.38, post_m: 0.022 } as const;
/** Position of a post relative to the stage's middle [m]; the balloon's pane is on the side of the fingers. */
export const POST_X_M = 0.03;
const PLANK_M = 0.09;

/** Horizontal planks with grain and seams. */
function plankTexture(): Texture {
  const random = numbers(19), w = 1024, h = 512, rows = 4;
  const texture = tiling(w, h, (pen) => {
    for (let row = 0; row < rows; row++) {
      const top = row * h / rows, tall = h / rows, light = 44 + 7 * random();
      pen.fillStyle = `hsl(28 38% ${light}%)`;
      pen.fillRect(0, top, w, tall);
      for (let i = 0; i < 60; i++) {
        const y = top + random() * tall, phase = 6 * random(), swing = 1 + 3 * random();
        pen.strokeStyle = random() < 0.6 ? '#5a3a20' : '#d8ac78';
        pen.globalAlpha = 0.05 + 0.1 * random();
        pen.lineWidth = 0.5 + 1.6 * random();
        pen.beginPath();
        for (let x = 0; x <= w; x += 32) pen.lineTo(x, y + Math.sin(x * 2 * Math.PI / w * 3 + phase) * swing);
        pen.stroke();
      }
      pen.globalAlpha = 1;
      pen.fillStyle = 'rgba(40,22,10,.6)';
      pen.fillRect(0, top, w, 4);
      pen.fillStyle = 'rgba(255,225,180,.25)';
      pen.fillRect(0, top + 4, w, 3);
    }
  });
  texture.repeat.set(WALL.width_m / 1.2, 1);
  return texture;
}

function box(material: Material, size: readonly [number, number, number], at: readonly [number, number, number]): Mesh {
  const mesh = new Mesh(new BoxGeometry(...size), material);
  mesh.position.set(...at);
  mesh.castShadow = mesh.receiveShadow = true;
  return mesh;
}

function planks(quality: Quality, low_m: number, high_m: number): Mesh {
  const map = plankTexture();
  map.repeat.y = (high_m - low_m) / (4 * PLANK_M);
  const mesh = new Mesh(new PlaneGeometry(WALL.width_m, high_m - low_m), surface(quality, { map, roughness: 0.75 }));
  mesh.position.set(0, (low_m + high_m) / 2, WALL_Z);
  mesh.receiveShadow = true;
  return mesh;
}

function valley(): Mesh {
  const geometry = new PlaneGeometry(WALL.width_m * 1.2, VALLEY.height_m), uv = geometry.attributes.uv!;
  for (let i = 0; i < uv.count; i++) uv.setX(i, 0.5 + (uv.getX(i) - 0.5) * WALL.width_m * 1.2 / VALLEY.width_m);
  const mesh = new Mesh(geometry, new MeshBasicMaterial({ map: valleyTexture(), toneMapped: false }));
  mesh.position.set(0.15, VALLEY.low_m + VALLEY.height_m / 2, VALLEY_Z);
  return mesh;
}

function wall(quality: Quality, right: boolean): Group {
  const root = new Group(), { low_m, high_m, pane_m, post_m } = WINDOW, middle = (low_m + high_m) / 2;
  const painted = surface(quality, { color: new Color('#efe3cf'), roughness: 0.55, clearcoat: 0.2 });
  root.add(valley(), makeRunner(quality), planks(quality, -0.1, low_m), planks(quality, high_m, WALL.height_m));
  const first = Math.ceil(-WALL.width_m / 2 / pane_m);
  for (let i = first; i < -first; i++) root.add(box(painted, [post_m, high_m - low_m, 0.05], [(right ? 1 : -1) * POST_X_M + i * pane_m, middle, WALL_Z]));
  root.add(box(painted, [WALL.width_m, 0.03, 0.06], [0, high_m + 0.015, WALL_Z]));
  root.add(box(painted, [WALL.width_m, 0.02, 0.11], [0, low_m - 0.01, WALL_Z + 0.035]));   // the sill
  return root;
}

/** The hut in the morning. @param right whether the hand is a right one */
export const hut = (right: boolean): Setting => ({
  mood: { key: '#fff2dc', rim: '#bfe0f2', lamps: undefined, sky: '#eaf4fb', ground: '#8a6a48', groundLow: '#96795c' },
  wall: (quality) => wall(quality, right),
  counter: new Color(1.28, 1.12, 0.9),
});
