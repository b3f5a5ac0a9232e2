// A cabin in weightlessness: a quilted wall with a wide window, a handrail, daylight from below. The frame is the stage's.
import {
  CapsuleGeometry, Color, CylinderGeometry, ExtrudeGeometry, Group, Mesh, MeshBasicMaterial, Path, PlaneGeometry, Shape, ShapeGeometry,
  type Texture,
} from 'three';
import { surface } from '../../scene/materials';
import type { Quality } from '../../scene/quality';
import { WALL, type Setting } from '../../scene/stage';
import { graded, numbers, tiling } from '../../scene/textures';
import { orbitTexture } from './orbit';

const WALL_Z = -0.62;
/** The window: offset of its middle from the stage's and height over its floor, half sizes and corner radius [m]. */
export const WINDOW = { x: 0.12, y: 0.12, half_x: 0.385, half_y: 0.25, corner: 0.17 } as const;
const FRAME_M = 0.034;
const QUILT_M = 0.16;

function quiltTexture(): Texture {
  const random = numbers(17), px = 512;
  return tiling(px, px, (pen) => {
    pen.fillStyle = '#d9d0bf';
    pen.fillRect(0, 0, px, px);
    pen.fillStyle = graded(pen.createRadialGradient(px * 0.45, px * 0.4, 20, px / 2, px / 2, px * 0.68),
      [[0, 'rgba(255,252,242,.95)'], [0.6, 'rgba(240,230,212,.4)'], [1, 'rgba(150,132,108,.5)']]);
    pen.fillRect(0, 0, px, px);
    for (let i = 0; i < 5000; i++) {
      pen.fillStyle = random() < 0.5 ? 'rgba(90,76,60,.05)' : 'rgba(255,255,255,.06)';
      pen.fillRect(random() * px, random() * px, 2, 2);
    }
    pen.strokeStyle = 'rgba(110,94,74,.75)';
    pen.lineWidth = 10;
    pen.strokeRect(0, 0, px, px);
    pen.strokeStyle = 'rgba(150,130,104,.9)';
    pen.lineWidth = 3;
    pen.setLineDash([16, 12]);
    pen.strokeRect(17, 17, px - 34, px - 34);
  });
}

function rounded<Outline extends Path>(path: Outline, grow: number): Outline {
  const { x, y, half_x, half_y, corner } = WINDOW, a = half_x + grow, b = half_y + grow, r = corner + grow;
  path.moveTo(x - a + r, y - b);
  path.lineTo(x + a - r, y - b);
  path.absarc(x + a - r, y - b + r, r, -Math.PI / 2, 0, false);
  path.lineTo(x + a, y + b - r);
  path.absarc(x + a - r, y + b - r, r, 0, Math.PI / 2, false);
  path.lineTo(x - a + r, y + b);
  path.absarc(x - a + r, y + b - r, r, Math.PI / 2, Math.PI, false);
  path.lineTo(x - a, y - b + r);
  path.absarc(x - a + r, y - b + r, r, Math.PI, 1.5 * Math.PI, false);
  return path;
}

function quilted(quality: Quality): Mesh {
  const half_x = WALL.width_m / 2, half_y = WALL.height_m / 2, shape = new Shape();
  shape.moveTo(-half_x, -half_y);
  shape.lineTo(half_x, -half_y);
  shape.lineTo(half_x, half_y);
  shape.lineTo(-half_x, half_y);
  shape.holes.push(rounded(new Path(), 0));
  const map = quiltTexture();
  map.repeat.set(1 / QUILT_M, 1 / QUILT_M);   // the texture coordinates of a Shape are in metres
  const mesh = new Mesh(new ShapeGeometry(shape, 24), surface(quality, { map, color: new Color('#fff8ee'), roughness: 0.9 }));
  mesh.position.z = WALL_Z;
  mesh.receiveShadow = true;
  return mesh;
}

function frame(quality: Quality, from: number, to: number, depth_m: number, color: string, metal: number): Mesh {
  const shape = rounded(new Shape(), to);
  shape.holes.push(rounded(new Path(), from));
  const geometry = new ExtrudeGeometry(shape, { depth: depth_m, bevelEnabled: true, bevelSize: 0.004, bevelThickness: 0.004, bevelSegments: 3, curveSegments: 24 });
  const mesh = new Mesh(geometry, surface(quality, { color: new Color(color), metalness: quality === 'high' ? metal : 0, roughness: 0.38, envMapIntensity: 1.2 }));
  mesh.position.z = WALL_Z;
  mesh.castShadow = mesh.receiveShadow = true;
  return mesh;
}

function bolts(quality: Quality): Group {
  const root = new Group(), steel = surface(quality, { color: new Color('#6d7478'), metalness: quality === 'high' ? 0.8 : 0, roughness: 0.4 });
  rounded(new Path(), FRAME_M / 2).getSpacedPoints(28).forEach(({ x, y }) => {
    const bolt = new Mesh(new CylinderGeometry(0.0048, 0.0055, 0.008, 6), steel);
    bolt.rotation.x = Math.PI / 2;
    bolt.position.set(x, y, WALL_Z + 0.026);
    root.add(bolt);
  });
  return root;
}

/** A handrail under the window, out of reach. */
function handrail(quality: Quality): Group {
  const root = new Group(), y = WINDOW.y - WINDOW.half_y - 0.105, cloth = surface(quality, { color: new Color('#d98a2b'), roughness: 0.6 });
  const steel = surface(quality, { color: new Color('#c9ced1'), metalness: quality === 'high' ? 0.9 : 0, roughness: 0.3 });
  const bar = new Mesh(new CapsuleGeometry(0.011, 0.56, 8, 20), cloth);
  bar.rotation.z = Math.PI / 2;
  bar.position.set(WINDOW.x, y, WALL_Z + 0.06);
  bar.castShadow = true;
  root.add(bar);
  for (const x of [-0.24, 0.24]) {
    const foot = new Mesh(new CylinderGeometry(0.009, 0.013, 0.06, 16), steel);
    foot.rotation.x = Math.PI / 2;
    foot.position.set(WINDOW.x + x, y, WALL_Z + 0.03);
    foot.castShadow = true;
    root.add(foot);
  }
  return root;
}

function view(): Mesh {
  const mesh = new Mesh(new PlaneGeometry(2 * WINDOW.half_x + 0.06, 2 * WINDOW.half_y + 0.06), new MeshBasicMaterial({ map: orbitTexture(), toneMapped: false }));
  mesh.position.set(WINDOW.x, WINDOW.y, WALL_Z - 0.02);
  return mesh;
}

function wall(quality: Quality, right: boolean): Group {
  const root = new Group();
  root.add(view(), quilted(quality), frame(quality, 0, FRAME_M, 0.018, '#b9c0c2', 0.75), frame(quality, -0.008, 0.004, 0.03, '#2b3136', 0.2), bolts(quality), handrail(quality));
  if (!right) root.position.x = -2 * WINDOW.x;   // the window is mirrored for a left hand, away from the arm
  return root;
}

/** @param right whether the hand is a right one */
export const cabin = (right: boolean): Setting => ({
  mood: { key: '#f4f6ff', rim: '#9fd0ff', lamps: '#fff1dc', sky: '#fbf6ee', ground: '#4f7fb8', groundLow: '#8fa3bd' },
  wall: (quality) => wall(quality, right),
  counter: undefined,
});
