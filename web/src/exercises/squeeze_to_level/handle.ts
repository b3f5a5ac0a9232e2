// The soft handle to squeeze: leather with a wave, brass rings, and the rod that it hangs on.
import { Color, CylinderGeometry, Group, Mesh, RepeatWrapping, type BufferGeometry, type Texture } from 'three';
import { surface } from '../../scene/materials';
import type { Quality } from '../../scene/quality';
import { softBody } from '../../scene/soft_body';
import { brass } from '../../scene/stage';
import { numbers, picture } from '../../scene/textures';
import type { Grip } from './grip';

/** Length of the rod, which ends above the picture [m]. */
const ROD_M = 0.6;

/** Blue leather: its grain, and pale stitches around it. */
function leather(): Texture {
  const random = numbers(29), w = 512, h = 1024;
  const texture = picture(w, h, (pen) => {
    pen.fillStyle = '#3B6FD1';
    pen.fillRect(0, 0, w, h);
    for (let i = 0; i < 5200; i++) {
      pen.fillStyle = random() < 0.5 ? 'rgba(20,40,96,.14)' : 'rgba(170,200,255,.12)';
      pen.beginPath();
      pen.ellipse(random() * w, random() * h, 2 + 4 * random(), 1 + 2.5 * random(), 3 * random(), 0, 2 * Math.PI);
      pen.fill();
    }
    pen.lineCap = 'round';
    for (let row = 0; row < 9; row++) {
      const y = (row + 0.5) * h / 9;
      pen.strokeStyle = 'rgba(18,34,84,.5)';
      pen.lineWidth = 7;
      pen.beginPath();
      for (let x = -8; x <= w + 8; x += 8) pen.lineTo(x, y + 12 * Math.sin(x / w * 4 * Math.PI));
      pen.stroke();
      pen.strokeStyle = '#CFE0FF';
      pen.setLineDash([26, 25.2]);
      pen.stroke();
      pen.setLineDash([]);
    }
  });
  texture.wrapS = RepeatWrapping;
  return texture;
}

/** y along its axis, the origin in its middle. */
export function makeHandle(grip: Grip, quality: Quality): { root: Group; side: BufferGeometry } {
  const root = new Group(), leathern = softBody(grip, [[0.72, 0], [0.9, 0.003], [0.975, 0.007]], 0.012, quality, surface(quality, { map: leather(), roughness: 0.55, clearcoat: 0.25, clearcoatRoughness: 0.45 })), metal = brass(quality), half = grip.height_m / 2;
  const part = (radius_m: number, tall_m: number, y_m: number, material = metal) => {
    const mesh = new Mesh(new CylinderGeometry(radius_m, radius_m, tall_m, quality === 'high' ? 48 : 20), material);
    mesh.position.y = y_m;
    mesh.castShadow = true;
    root.add(mesh);
  };
  root.add(leathern);
  // No part exceeds the collision cylinder.
  part(0.8 * grip.radius_m, 0.012, half + 0.006);
  part(0.4 * grip.radius_m, 0.012, half + 0.018);
  part(0.0042, ROD_M, half + 0.024 + ROD_M / 2);
  part(0.55 * grip.radius_m, 0.006, -half - 0.003);
  part(0.35 * grip.radius_m, 0.02, -half - 0.016, surface(quality, { color: new Color('#A31D38'), roughness: 0.7 }));
  return { root, side: leathern.geometry };
}
