// A woven runner on the counter, under the handle: as flat as the collision shape of the counter.
import { Mesh, PlaneGeometry, RepeatWrapping, type Texture } from 'three';
import { surface } from '../../scene/materials';
import type { Quality } from '../../scene/quality';
import { picture } from '../../scene/textures';
import { WALL } from '../../scene/stage';

const TALL_M = 0.3;
const OVER_M = 0.0008;
/** Length of the pattern [m]. */
const PERIOD_M = 0.15;

function weave(): Texture {
  const w = 256, h = 512;
  const texture = picture(w, h, (pen) => {
    pen.fillStyle = '#8E2430';
    pen.fillRect(0, 0, w, h);
    pen.fillStyle = '#F3E6CE';
    for (const y of [22, 96, 404, 478]) pen.fillRect(0, y - 6, w, 12);
    for (const y of [59, 441]) {
      for (let x = 0; x < w; x += 64) {
        pen.beginPath();
        pen.moveTo(x + 4, y);
        pen.lineTo(x + 32, y - 18);
        pen.lineTo(x + 60, y);
        pen.lineTo(x + 32, y + 18);
        pen.fill();
      }
    }
    // An eight-pointed star in the middle.
    for (let i = 0; i < 8; i++) {
      const turn = i * Math.PI / 4, at = (r: number, more: number): [number, number] => [128 + r * Math.cos(turn + more), 250 + r * Math.sin(turn + more)];
      pen.beginPath();
      pen.moveTo(...at(8, 0));
      pen.lineTo(...at(52, -0.36));
      pen.lineTo(...at(92, 0));
      pen.lineTo(...at(52, 0.36));
      pen.fill();
    }
    pen.fillStyle = 'rgba(40,8,12,.10)';
    for (let y = 0; y < h; y += 4) pen.fillRect(0, y, w, 2);
  });
  texture.wrapS = RepeatWrapping;
  texture.repeat.x = WALL.width_m / PERIOD_M;
  return texture;
}

export function makeRunner(quality: Quality): Mesh {
  const mesh = new Mesh(new PlaneGeometry(WALL.width_m, TALL_M), surface(quality, { map: weave(), roughness: 0.95 }));
  mesh.rotation.x = -Math.PI / 2;
  mesh.position.set(0, OVER_M, -0.03);
  mesh.receiveShadow = true;
  return mesh;
}
