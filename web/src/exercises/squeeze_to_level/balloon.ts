// A hot-air balloon: gores in two colours, a skirt, ropes, a basket.
import { BufferAttribute, Color, ConeGeometry, CylinderGeometry, Group, LatheGeometry, Mesh, TorusGeometry, Vector2 } from 'three';
import { flat, surface } from '../../scene/materials';
import type { Quality } from '../../scene/quality';

export interface BalloonColors { readonly main: string; readonly stripe: string }

const GORES = 12;
/** Height of the basket's middle relative to the envelope's, for a balloon of radius 1. */
export const BASKET_Y = -1.86;
/** Height of the burner, over the basket. */
const FLAME_Y = -1.68;
/** Half profile of a balloon of radius 1, from the mouth to the crown. */
const OUTLINE = [[0.2, -1.28], [0.36, -1.12], [0.62, -0.78], [0.86, -0.38], [0.98, 0], [0.99, 0.22], [0.9, 0.52], [0.7, 0.78], [0.4, 0.95], [0, 1]] as const;

/** @param radius_m radius of the envelope; the origin is its middle */
export function makeBalloon(radius_m: number, { main, stripe }: BalloonColors, quality: Quality): Group {
  const root = new Group(), around = quality === 'high' ? 4 * GORES : 2 * GORES;
  const geometry = new LatheGeometry(OUTLINE.map(([r, y]) => new Vector2(r, y)), around).toNonIndexed();
  geometry.computeVertexNormals();
  const at = geometry.attributes.position!, colors = new Float32Array(3 * at.count), tones = [new Color(main), new Color(stripe)];
  for (let i = 0; i < at.count; i += 3) {
    const x = at.getX(i) + at.getX(i + 1) + at.getX(i + 2), z = at.getZ(i) + at.getZ(i + 1) + at.getZ(i + 2);
    const gore = Math.floor((Math.atan2(z, x) / (2 * Math.PI) + 1) * GORES), low = at.getY(i) < -1.1;
    const tone = tones[low ? 0 : gore % 2]!;
    for (let k = 0; k < 3; k++) tone.toArray(colors, 3 * (i + k));
  }
  geometry.setAttribute('color', new BufferAttribute(colors, 3));
  const cloth = surface(quality, { roughness: 0.6, sheen: 0.4, emissive: new Color(main), emissiveIntensity: 0.12 });
  Object.assign(cloth, { vertexColors: true });
  const wicker = surface(quality, { color: new Color('#8a5a34'), roughness: 0.8 });
  const basket = new Mesh(new CylinderGeometry(0.27, 0.22, 0.36, 16), wicker), rim = new Mesh(new TorusGeometry(0.27, 0.05, 8, 24), surface(quality, { color: new Color('#FFD15C'), roughness: 0.5 }));
  rim.rotation.x = Math.PI / 2;
  rim.position.y = BASKET_Y + 0.18;
  basket.position.y = BASKET_Y;
  root.add(new Mesh(geometry, cloth), basket, rim);
  for (let i = 0; i < 4; i++) {
    const turn = (i + 0.5) * Math.PI / 2, rope = new Mesh(new CylinderGeometry(0.012, 0.012, 0.46, 5), wicker);
    rope.position.set(0.19 * Math.cos(turn), -1.5, 0.19 * Math.sin(turn));
    root.add(rope);
  }
  root.scale.setScalar(radius_m);
  return root;
}

/** The burner's flame under the mouth, for a balloon of radius 1; its origin is its foot. */
export function makeFlame(): Group {
  const root = new Group();
  for (const [radius, tall, color] of [[0.2, 0.66, '#FF9A2E'], [0.11, 0.44, '#FFF0B0']] as const) {
    const tongue = new Mesh(new ConeGeometry(radius, tall, 16), flat(color, { transparent: true, opacity: 0.92 }));
    tongue.position.y = tall / 2;
    root.add(tongue);
  }
  root.position.y = FLAME_Y;
  return root;
}
