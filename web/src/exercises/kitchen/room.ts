// The surroundings: a tiled wall, a beech worktop, the row of fronts around a task's cabinet, objects on the worktop.
import { Color, Group, LatheGeometry, Matrix4, Mesh, PlaneGeometry, SphereGeometry, Vector2, Vector3, type BufferGeometry, type Material, type Texture } from 'three';
import { surface } from '../../scene/materials';
import { turnOf } from '../../scene/camera';
import type { Quality } from '../../scene/quality';
import { WALL, type Setting } from '../../scene/stage';
import { graded, numbers, tiling } from '../../scene/textures';
import type { Size, Workshop } from './furniture';

const WALL_Z = -0.62;
const TILE = { wide_m: 0.15, tall_m: 0.075, across: 6, down: 8 } as const;
/** Gap between fronts, width of neighbouring ones, and offset of the plinth behind them [m]. */
const GAP_M = 0.005;
const NEIGHBOUR_M = 0.42;
const PLINTH_M = 0.05;
/** Fronts under a worktop that carries everything: its overhang, their height [m], and their number on each side. */
const OVERHANG_M = 0.02;
const BASE_M = 0.3;
/** Depth of the plinth, below every picture [m]. */
const FLOOR_M = 0.9;
const BASE_FRONTS = 4;
/** A shelf begins this far behind a door [m]. */
const INSIDE_M = 0.02;

/** Glazed tiles in a running bond with slightly different tones. */
function tileTexture(): Texture {
  const random = numbers(23), px = 128, w = TILE.across * 2 * px, h = TILE.down * px;
  const texture = tiling(w, h, (pen) => {
    pen.fillStyle = '#c9bfae';
    pen.fillRect(0, 0, w, h);
    for (let row = 0; row < TILE.down; row++) {
      for (let i = -1; i < TILE.across; i++) {
        const x = i * 2 * px + (row % 2 ? px : 0) + 3, y = row * px + 3, wide = 2 * px - 6, tall = px - 6;
        const tone = i < 0 || i === TILE.across - 1 ? 0.5 : random(), light = 91 + 4 * tone, paint = (color: string): void => {
          pen.fillStyle = color;
          pen.beginPath();
          pen.roundRect(x, y, wide, tall, 7);
          pen.fill();
        };
        paint(`hsl(${38 + 12 * tone} 38% ${light}%)`);
        pen.fillStyle = graded(pen.createLinearGradient(x, y, x + 0.3 * wide, y + tall),
          [[0, 'rgba(255,255,255,.6)'], [0.35, 'rgba(255,255,255,0)'], [1, 'rgba(120,96,66,.08)']]);
        pen.fill();
      }
    }
  });
  texture.repeat.set(WALL.width_m / (TILE.across * TILE.wide_m), 2 * WALL.height_m / (TILE.down * TILE.tall_m));
  return texture;
}

/** A texture of beech staves. */
function beech(): Texture {
  const random = numbers(31), w = 1024, h = 512, rows = 8;
  return tiling(w, h, (pen) => {
    for (let row = 0; row < rows; row++) {
      let x = -random() * 300;
      while (x < w) {
        const long = 220 + 240 * random(), top = row * h / rows;
        pen.fillStyle = `hsl(${34 + 4 * random()} 40% ${86 + 8 * random()}%)`;
        pen.fillRect(x, top, long, h / rows);
        pen.fillStyle = 'rgba(110,70,34,.10)';
        for (let i = 0; i < 40; i++) pen.fillRect(x + random() * long, top + random() * h / rows, 8 + 34 * random(), 1.4);
        pen.fillStyle = 'rgba(92,58,30,.4)';
        pen.fillRect(x, top, 2, h / rows);
        x += long;
      }
      pen.fillStyle = 'rgba(92,58,30,.32)';
      pen.fillRect(0, row * h / rows, w, 2);
    }
  });
}

function tiles(quality: Quality): Mesh {
  const mesh = new Mesh(new PlaneGeometry(WALL.width_m, 2 * WALL.height_m), surface(quality, { map: tileTexture(), roughness: 0.24, clearcoat: 0.4, clearcoatRoughness: 0.2, envMapIntensity: 0.7 }));
  mesh.position.z = WALL_Z;
  mesh.receiveShadow = true;
  return mesh;
}

/** The wall stands along the row of fronts and does not turn with the camera. @param right whether the hand is a right one */
export const kitchen = (right: boolean): Setting => ({
  mood: { key: '#fff3df', rim: '#d8ecf2', lamps: '#ffe9c8', sky: '#fffaf0', ground: '#a08260', groundLow: '#b39c80' },
  wall(quality) {
    const root = new Group();
    root.add(tiles(quality));
    root.rotation.y = -turnOf(right);
    return root;
  },
  counter: undefined,
});

/** x of the stage's wall in the program's frame. @param row_x x of the stage */
export const wallBehind = (row_x: number): number => row_x - WALL_Z;

/** A tiled wall in the program's frame, nearer than the stage's. */
export function makeWall(x: number, shop: Workshop): Mesh {
  const mesh = tiles(shop.quality);
  mesh.quaternion.setFromRotationMatrix(new Matrix4().makeBasis(new Vector3(0, -1, 0), new Vector3(0, 0, 1), new Vector3(-1, 0, 0)));
  mesh.position.set(x, 0, 0);
  return mesh;
}

/** A slab along the whole wall, in the program's frame. */
export function makeWorktop(near_x: number, top_z: number, thick_m: number, far_x: number, color: string, shop: Workshop): Mesh {
  const map = beech(), deep = far_x - near_x, mesh = shop.board([deep, WALL.width_m, thick_m], [(near_x + far_x) / 2, 0, top_z - thick_m / 2], surface(shop.quality, { map, color: new Color(color), roughness: 0.42, clearcoat: 0.35, clearcoatRoughness: 0.35 }), 0.006);
  // Texture coordinates in metres, staves along y.
  const { position, uv } = mesh.geometry.attributes;
  for (let i = 0; i < uv!.count; i++) uv!.setXY(i, position!.getY(i) / 1.1, (position!.getX(i) + position!.getZ(i)) / 0.5);
  return mesh;
}

function vase(shop: Workshop, outline: readonly (readonly [number, number])[], color: string): Mesh {
  const geometry: BufferGeometry = new LatheGeometry(outline.map(([r, y]) => new Vector2(r, y)), shop.quality === 'high' ? 48 : 24).rotateX(Math.PI / 2);
  const mesh = new Mesh(geometry, surface(shop.quality, { color: new Color(color), roughness: 0.38, clearcoat: 0.5, clearcoatRoughness: 0.25 }));
  mesh.castShadow = mesh.receiveShadow = true;
  return mesh;
}

/** Objects at the back of the worktop: jars, a board, a bowl of fruit, herbs. @param free_m width in the worktop's middle that stays free */
export function makeThings(wall_x: number, z: number, side: number, free_m: number, shop: Workshop): Group {
  const root = new Group(), x = wall_x - 0.1;
  const stand = (mesh: Mesh, y: number, dx = 0, up = 0): void => {
    mesh.position.set(x + dx, side * (y + Math.sign(y) * free_m), z + up);
    root.add(mesh);
  };
  for (const [y, tall, color] of [[0.36, 0.15, '#4f8f95'], [0.25, 0.115, '#e8dcc4'], [0.155, 0.085, '#d08a4a']] as const) {
    stand(vase(shop, [[1e-4, 0], [0.044, 0], [0.048, 0.01], [0.048, tall - 0.012], [0.043, tall], [1e-4, tall]], color), y);
    stand(shop.bar(0.044, 0.014, shop.wood('#c79a62')), y, 0, tall + 0.007);
    stand(shop.bar(0.009, 0.014, shop.wood('#c79a62')), y, 0, tall + 0.02);
  }
  const board = shop.board([0.016, 0.2, 0.26], [0, 0, 0], shop.wood('#b98350'), 0.007);
  board.rotation.y = 0.16;
  stand(board, -0.06, 0.05, 0.13);
  stand(vase(shop, [[0.03, 0], [0.07, 0.022], [0.088, 0.055], [0.083, 0.055], [0.062, 0.026], [1e-4, 0.012]], '#efe6d6'), -0.29);
  for (const [dx, dy, up, color] of [[-0.02, 0.03, 0.058, '#e0762f'], [0.03, -0.02, 0.06, '#e5852f'], [-0.035, -0.03, 0.062, '#c9402f'], [0.02, 0.035, 0.062, '#7f9a3c']] as const) {
    const fruit = new Mesh(new SphereGeometry(0.032, 28, 18), surface(shop.quality, { color: new Color(color), roughness: 0.55 }));
    fruit.castShadow = true;
    stand(fruit, -0.29 + side * dy, dx, up);
  }
  stand(vase(shop, [[1e-4, 0], [0.036, 0], [0.05, 0.075], [0.045, 0.075], [1e-4, 0.068]], '#c8643c'), -0.52);
  const random = numbers(5), leaf = surface(shop.quality, { color: new Color('#5f8f4a'), roughness: 0.7 }), pale = surface(shop.quality, { color: new Color('#7faa58'), roughness: 0.7 });
  for (let i = 0; i < 34; i++) {
    const a = 6.28 * random(), r = 0.052 * Math.sqrt(random()), up = 0.085 + 0.075 * random() * (1 - r / 0.09), one = new Mesh(new SphereGeometry(0.015 + 0.007 * random(), 10, 8), i % 3 ? leaf : pale);
    one.scale.set(1, 0.75, 0.5);
    one.rotation.set(random() - 0.5, random() - 0.5, a);
    stand(one, -0.52 + r * Math.cos(a), r * Math.sin(a), up);
  }
  return root;
}

/** An axis-aligned box of the world [m]. */
export interface Extent { readonly low: Size; readonly high: Size }

const boardIn = ({ low, high }: Extent, material: Material, edge_m: number, shop: Workshop): Mesh =>
  shop.board([high[0] - low[0], high[1] - low[1], high[2] - low[2]], [(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, (low[2] + high[2]) / 2], material, edge_m);

const shadeOf = (shop: Workshop): Material => surface(shop.quality, { color: new Color('#4a3829'), roughness: 0.95 });

/** The inside behind an opening door: a dark back, a shelf, bowls on it. @param around bounds of its cupboard */
export function makeInside(front: Extent, { low, high }: Extent, shop: Workshop): Group {
  const root = new Group(), from_x = front.high[0] + INSIDE_M, to_x = Math.max(high[0], from_x + 0.1) - 0.005, middle_y = (low[1] + high[1]) / 2, shelf_z = (low[2] + high[2]) / 2 - 0.03;
  const box = (x0: number, x1: number, z0: number, z1: number): Extent => ({ low: [x0, low[1] + 0.005, z0], high: [x1, high[1] - 0.005, z1] });
  root.add(boardIn(box(to_x - 0.01, to_x, low[2], high[2] - 0.005), shadeOf(shop), 0.001, shop), boardIn(box(from_x, to_x, shelf_z - 0.012, shelf_z), shop.wood('#e6d3b3'), 0.002, shop));
  for (const [k, color] of ['#e9e2d3', '#c8643c', '#4f8f95'].entries()) {
    const bowl = vase(shop, [[1e-4, 0], [0.026, 0], [0.05, 0.042], [0.046, 0.042], [0.024, 0.006], [1e-4, 0.006]], color);
    bowl.position.set(from_x + 0.06, middle_y, shelf_z + 0.02 * k);
    root.add(bowl);
  }
  return root;
}

/** The kitchen around a front that is built in under a worktop: fronts beside it, shade behind, a plinth. */
export function makeRow(front: Extent, around: Extent, worktop: Extent, color: string, shop: Workshop): Group {
  const root = new Group(), wood = shop.wood(color), shade = shadeOf(shop);
  const near_x = front.low[0], thick = front.high[0] - near_x, under_z = worktop.low[2], seam_z = front.low[2] - GAP_M / 2;
  const fill = (low: Size, high: Size, material: Material, edge_m: number): void => { root.add(boardIn({ low, high }, material, edge_m, shop)); };
  for (const side of [-1, 1]) {
    for (let i = 0; i < 5; i++) {
      const from = (side < 0 ? around.low[1] : around.high[1]) + side * i * NEIGHBOUR_M, y0 = Math.min(from, from + side * NEIGHBOUR_M) + GAP_M / 2, y1 = y0 + NEIGHBOUR_M - GAP_M;
      fill([near_x, y0, front.low[2]], [near_x + thick, y1, front.high[2]], wood, 0.005);
      fill([near_x, y0, around.low[2]], [near_x + thick, y1, seam_z - GAP_M / 2], wood, 0.005);
      fill([near_x + thick + 0.004, y0 - GAP_M, around.low[2]], [near_x + thick + 0.02, y1 + GAP_M, under_z], shade, 0.001);
    }
  }
  fill([front.high[0] + 0.3, around.low[1], around.low[2] - 0.5], [front.high[0] + 0.31, around.high[1], under_z], shade, 0.001);
  fill([near_x + PLINTH_M, -WALL.width_m / 2, around.low[2] - 0.6], [near_x + PLINTH_M + 0.02, WALL.width_m / 2, around.low[2] - GAP_M], shade, 0.001);
  return root;
}

/** Fronts under a worktop that carries everything: shade behind them, a bar on each, a plinth. */
export function makeBase({ low, high }: Extent, color: string, shop: Workshop): Group {
  const root = new Group(), wood = shop.wood(color), near_x = low[0] + OVERHANG_M, top_z = low[2] - GAP_M, low_z = top_z - BASE_M;
  const board = (from: Size, to: Size, material: Material, edge_m: number): void => { root.add(boardIn({ low: from, high: to }, material, edge_m, shop)); };
  for (let i = -BASE_FRONTS; i < BASE_FRONTS; i++) {
    const y0 = i * NEIGHBOUR_M + GAP_M / 2, bar = shop.bar(0.006, 0.14, shop.metal);
    board([near_x, y0, low_z], [near_x + 0.018, y0 + NEIGHBOUR_M - GAP_M, top_z], wood, 0.005);
    bar.rotation.x = Math.PI / 2;
    bar.position.set(near_x - 0.024, y0 + NEIGHBOUR_M / 2, top_z - 0.05);
    root.add(bar);
  }
  const half_m = BASE_FRONTS * NEIGHBOUR_M;
  board([near_x + 0.022, -half_m, low_z], [Math.min(high[0], near_x + 0.04), half_m, low[2]], shadeOf(shop), 0.001);
  board([near_x + PLINTH_M, -half_m, low_z - FLOOR_M], [near_x + PLINTH_M + 0.02, half_m, low_z - GAP_M], shadeOf(shop), 0.001);
  return root;
}
