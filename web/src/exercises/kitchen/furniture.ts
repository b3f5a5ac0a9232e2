// The bodies of a task as kitchen furniture, by their shapes: boxes are wooden fronts with round edges, thin bars are metal.
// The program's frame, z up.
import { Color, Group, LatheGeometry, Mesh, Vector2, type Material, type Texture } from 'three';
import { RoundedBoxGeometry } from 'three/examples/jsm/geometries/RoundedBoxGeometry.js';
import { BodyT, ShapeType, type ShapeT } from '../../protocol';
import { surface } from '../../scene/materials';
import { makeBody } from '../../scene/plain_bodies';
import type { Quality } from '../../scene/quality';
import { numbers, tiling } from '../../scene/textures';

/** Boxes with no side longer than this, and thinner bars, are metal [m]. */
const SMALL_M = 0.06;
const THIN_M = 0.022;
const EDGE_M = 0.005;

export type Size = readonly [x: number, y: number, z: number];

/** A pale wood grain, to be tinted. */
export function grain(): Texture {
  const random = numbers(41), w = 512, h = 512;
  return tiling(w, h, (pen) => {
    pen.fillStyle = '#f1ece4';
    pen.fillRect(0, 0, w, h);
    for (let i = 0; i < 260; i++) {
      const y = random() * h, phase = 6 * random(), swing = 2 + 5 * random();
      pen.strokeStyle = random() < 0.6 ? '#8d7357' : '#ffffff';
      pen.globalAlpha = 0.03 + 0.07 * random();
      pen.lineWidth = 0.8 + 2.4 * random();
      pen.beginPath();
      for (let x = 0; x <= w; x += 16) pen.lineTo(x, y + swing * Math.sin(x / 95 + phase));
      pen.stroke();
    }
  });
}

export class Workshop {
  readonly metal: Material;
  private readonly map: Texture = grain();
  private readonly woods = new Map<string, Material>();

  constructor(readonly quality: Quality) {
    this.metal = surface(quality, { color: new Color('#565d63'), metalness: quality === 'high' ? 0.75 : 0, roughness: 0.36, envMapIntensity: 1.4 });   // darker than every skin tone
  }

  wood(color: string): Material {
    const made = this.woods.get(color) ?? surface(this.quality, { map: this.map, color: new Color(color), roughness: 0.52, clearcoat: 0.25, clearcoatRoughness: 0.4 });
    this.woods.set(color, made);
    return made;
  }

  /** Smooth paint for bodies that are pushed or lifted. */
  paint(color: string): Material {
    return surface(this.quality, { color: new Color(color), roughness: 0.4, clearcoat: 0.35, clearcoatRoughness: 0.3 });
  }

  board([x, y, z]: Size, at: Size, material: Material, edge_m = EDGE_M): Mesh {
    return put(new Mesh(new RoundedBoxGeometry(x, y, z, this.quality === 'high' ? 4 : 2, Math.min(edge_m, 0.45 * Math.min(x, y, z))), material), at);
  }

  /** A bar with round ends, along z. */
  bar(radius_m: number, length_m: number, material: Material): Mesh {
    const round = Math.min(0.35 * radius_m, 0.2 * length_m), half = length_m / 2;
    const end = [1, 0.6, 0.3, 0].map((t) => { const a = t * Math.PI / 2; return [radius_m - round + round * Math.sin(a), half - round + round * Math.cos(a)] as const; });
    const outline = [[1e-5, -half], ...[...end].reverse().map(([r, y]) => [r, -y] as const), ...end, [1e-5, half]] as const;
    const geometry = new LatheGeometry(outline.map(([r, y]) => new Vector2(r, y)), this.quality === 'high' ? 48 : 24).rotateX(Math.PI / 2);
    return put(new Mesh(geometry, material), [0, 0, 0]);
  }
}

function put<M extends Mesh>(mesh: M, [x, y, z]: Size): M {
  mesh.position.set(x, y, z);
  mesh.castShadow = mesh.receiveShadow = true;
  return mesh;
}

export const colorOf = (body: BodyT): string => String(body.color ?? '') || '#c99a66';
const sizeOf = ({ halfExtentsM: h }: ShapeT): Size => [2 * (h?.x ?? 0), 2 * (h?.y ?? 0), 2 * (h?.z ?? 0)];

function partOf(shape: ShapeT, body: BodyT, shop: Workshop, painted: boolean): Mesh | undefined {
  const wood = painted ? shop.paint(colorOf(body)) : shop.wood(colorOf(body));
  if (shape.type === ShapeType.Box) return shop.board(sizeOf(shape), [0, 0, 0], Math.max(...sizeOf(shape)) <= SMALL_M ? shop.metal : wood);
  if (shape.type === ShapeType.Cylinder || shape.type === ShapeType.Capsule) {
    const long = shape.lengthM + (shape.type === ShapeType.Capsule ? 2 * shape.radiusM : 0);
    return shop.bar(shape.radiusM, long, shape.radiusM < THIN_M ? shop.metal : wood);
  }
  return undefined;
}

/** Models a body from its shapes, in its own frame. @param painted without grain */
export function makePiece(body: BodyT, shop: Workshop, painted = false): Group {
  const root = new Group();
  for (const shape of body.shapes) {
    const mesh = partOf(shape, body, shop, painted) ?? makeBody(new BodyT('', body.fixed, body.color, [shape]), shop.quality).children[0] as Mesh;
    const p = shape.inBody?.positionM, q = shape.inBody?.orientationXyzw;
    if (p) mesh.position.set(p.x, p.y, p.z);
    if (q) mesh.quaternion.set(q.x, q.y, q.z, q.w);
    root.add(mesh);
  }
  return root;
}

/** The largest box of a body that is a front: thin along x. Undefined: none. */
export function frontOf(body: BodyT): ShapeT | undefined {
  const area = (shape: ShapeT): number => sizeOf(shape)[1] * sizeOf(shape)[2];
  return body.shapes.filter((shape) => {
    const [x, y, z] = sizeOf(shape);
    return shape.type === ShapeType.Box && x < 0.5 * Math.min(y, z) && Math.max(y, z) > SMALL_M;
  }).sort((a, b) => area(b) - area(a))[0];
}

/** Tableware on a drawer's floor, in the body's frame; empty if a body has no floor. */
export function makeContents(body: BodyT, shop: Workshop): Group {
  const root = new Group(), floor = body.shapes.find((shape) => shape.type === ShapeType.Box && sizeOf(shape)[2] < 0.2 * Math.min(sizeOf(shape)[0], sizeOf(shape)[1]));
  const at = floor?.inBody?.positionM;
  if (!floor || !at) return root;
  const [long, wide, thick] = sizeOf(floor), z = at.z + thick / 2;
  const cloth = (color: string) => surface(shop.quality, { color: new Color(color), roughness: 0.95 });
  ['#3f7f86', '#f6ead2', '#d98f4e', '#f6ead2', '#3f7f86', '#f6ead2'].forEach((color, k) => {
    root.add(shop.board([0.6 * long, 0.3 * wide, 0.013], [at.x - 0.08 * long, at.y + 0.3 * wide, z + 0.0075 + 0.0125 * k], cloth(color), 0.006));
  });
  ['#d08a4a', '#8f4a3c', '#6f8f4a', '#e0b84a'].forEach((color, k) => {   // jars of spice
    const x = at.x - (0.26 - 0.24 * (k % 2)) * long, y = at.y - (0.06 + 0.22 * Math.floor(k / 2)) * wide;
    for (const [r, tall, up, tone] of [[0.022, 0.062, 0.031, color], [0.0235, 0.016, 0.07, '#e9dcc2']] as const) {
      const part = shop.bar(r, tall, shop.wood(tone));
      part.position.set(x, y, z + up);
      root.add(part);
    }
  });
  return root;
}
