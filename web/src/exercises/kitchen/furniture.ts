// The bodies of a task as kitchen furniture, by their shapes: boxes are fronts of wood with round edges, thin bars are metal.
// A front before a fixed box is built in: the box is drawn as a cabinet that is open behind it. The program's frame, z up.
import { Color, CylinderGeometry, Group, LatheGeometry, Mesh, RepeatWrapping, Vector2, type BufferGeometry, type Material, type Texture } from 'three';
import { RoundedBoxGeometry } from 'three/examples/jsm/geometries/RoundedBoxGeometry.js';
import { BodyT, ShapeType, type ShapeT } from '../../protocol';
import { surface } from '../../scene/materials';
import { makeBody } from '../../scene/plain_bodies';
import type { Quality } from '../../scene/quality';
import { numbers, picture } from '../../scene/textures';

/** Boxes with no side longer than this, and bars that are thinner, are metal [m]. */
const SMALL_M = 0.06;
const THIN_M = 0.022;
const EDGE_M = 0.005;
/** Thickness of a cabinet's boards and of a tray's [m]. */
const BOARD_M = 0.016;
const TRAY_M = 0.008;

export type Size = readonly [x: number, y: number, z: number];

/** Pale grain, to be coloured. */
export function grain(): Texture {
  const random = numbers(41), w = 512, h = 512;
  const texture = picture(w, h, (pen) => {
    pen.fillStyle = '#f1ece4';
    pen.fillRect(0, 0, w, h);
    for (let i = 0; i < 260; i++) {
      const y = random() * h, phase = 6 * random(), swing = 2 + 5 * random();
      pen.strokeStyle = random() < 0.6 ? '#8d7357' : '#ffffff';
      pen.globalAlpha = 0.04 + 0.1 * random();
      pen.lineWidth = 0.8 + 2.4 * random();
      pen.beginPath();
      for (let x = 0; x <= w; x += 16) pen.lineTo(x, y + swing * Math.sin(x / 95 + phase));
      pen.stroke();
    }
  });
  texture.wrapS = texture.wrapT = RepeatWrapping;
  return texture;
}

export class Workshop {
  readonly metal: Material;
  private readonly map: Texture = grain();
  private readonly woods = new Map<string, Material>();

  constructor(readonly quality: Quality) {
    const fine = quality === 'high';
    this.metal = surface(quality, { color: new Color(fine ? '#d9d3c6' : '#c4beb2'), metalness: fine ? 0.92 : 0, roughness: 0.3, envMapIntensity: 1.35 });
  }

  wood(color: string): Material {
    const made = this.woods.get(color) ?? surface(this.quality, { map: this.map, color: new Color(color), roughness: 0.52, clearcoat: 0.25, clearcoatRoughness: 0.4 });
    this.woods.set(color, made);
    return made;
  }

  board([x, y, z]: Size, at: Size, material: Material, edge_m = EDGE_M): Mesh {
    return put(new Mesh(new RoundedBoxGeometry(x, y, z, this.quality === 'high' ? 4 : 2, Math.min(edge_m, 0.45 * Math.min(x, y, z))), material), at);
  }

  /** Its ends are round. Along z. */
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

const colorOf = (body: BodyT): string => String(body.color ?? '') || '#c99a66';
const sizeOf = ({ halfExtentsM: h }: ShapeT): Size => [2 * (h?.x ?? 0), 2 * (h?.y ?? 0), 2 * (h?.z ?? 0)];

function partOf(shape: ShapeT, body: BodyT, shop: Workshop): Mesh | undefined {
  const wood = shop.wood(colorOf(body));
  if (shape.type === ShapeType.Box) return shop.board(sizeOf(shape), [0, 0, 0], Math.max(...sizeOf(shape)) <= SMALL_M ? shop.metal : wood);
  if (shape.type === ShapeType.Cylinder || shape.type === ShapeType.Capsule) {
    const long = shape.lengthM + (shape.type === ShapeType.Capsule ? 2 * shape.radiusM : 0);
    return shop.bar(shape.radiusM, long, shape.radiusM < THIN_M ? shop.metal : wood);
  }
  return undefined;
}

/** A body by its shapes, in its own frame. */
export function makePiece(body: BodyT, shop: Workshop): Group {
  const root = new Group();
  for (const shape of body.shapes) {
    const mesh = partOf(shape, body, shop) ?? makeBody(new BodyT('', body.fixed, body.color, [shape]), shop.quality).children[0] as Mesh;
    const p = shape.inBody?.positionM, q = shape.inBody?.orientationXyzw;
    if (p) mesh.position.set(p.x, p.y, p.z);
    if (q) mesh.quaternion.set(q.x, q.y, q.z, q.w);
    root.add(mesh);
  }
  return root;
}

/** The largest box of a body that is a front: thin along x, its middle in the body's frame. Undefined: none. */
export function frontOf(body: BodyT): { readonly at: Size; readonly size: Size } | undefined {
  const fronts = body.shapes.filter((shape) => {
    const [x, y, z] = sizeOf(shape);
    return shape.type === ShapeType.Box && x < 0.5 * Math.min(y, z) && Math.max(y, z) > SMALL_M;
  });
  const area = (shape: ShapeT): number => sizeOf(shape)[1] * sizeOf(shape)[2];
  const best = fronts.sort((a, b) => area(b) - area(a))[0], p = best?.inBody?.positionM;
  return best && { at: [p?.x ?? 0, p?.y ?? 0, p?.z ?? 0], size: sizeOf(best) };
}

/** What a drawer has behind its front, in its body's frame: sides, a floor, and things for the table. */
export function makeTray({ at: [x, y, z], size: [deep, wide, tall] }: { readonly at: Size; readonly size: Size }, long_m: number, shop: Workshop): Group {
  const root = new Group(), wood = shop.wood('#e6cfa8'), w = wide - 2 * BOARD_M - 0.008, h = 0.62 * tall, from = x + deep / 2, middle = from + long_m / 2, floor = z - tall / 2 + 0.02;
  root.add(shop.board([long_m, w, TRAY_M], [middle, y, floor], shop.wood('#d9bd92'), 0.001));
  for (const side of [-1, 1]) root.add(shop.board([long_m, TRAY_M, h], [middle, y + side * (w - TRAY_M) / 2, floor + h / 2], wood, 0.002));
  root.add(shop.board([TRAY_M, w, h], [from + long_m - TRAY_M / 2, y, floor + h / 2], wood, 0.002));
  const cloth = surface(shop.quality, { color: new Color('#3f7f86'), roughness: 0.95 }), stripe = surface(shop.quality, { color: new Color('#f6ead2'), roughness: 0.95 });
  for (const [k, side] of [[0, 1], [1, 1]] as const) {
    root.add(shop.board([0.6 * long_m, 0.24 * w, 0.014], [middle, y + side * 0.3 * w, floor + 0.012 + 0.013 * k], k === 0 ? cloth : stripe, 0.006));
  }
  for (let i = 0; i < 4; i++) {   // spoons of wood
    const shaft = shop.bar(0.004, 0.7 * long_m, shop.wood('#b9824a')), bowl = shop.bar(0.013, 0.007, shop.wood('#b9824a'));
    shaft.rotation.y = Math.PI / 2;
    shaft.position.set(middle + 0.006, y - (0.36 - 0.15 * i) * w, floor + 0.014);
    bowl.position.set(from + 0.16 * long_m, shaft.position.y, floor + 0.015);
    root.add(shaft, bowl);
  }
  return root;
}

/** A box as a cabinet that is open towards the person: boards around, the back dark, a shelf with bowls where no drawer is. */
export function makeCabinet(size: Size, color: string, shelf: boolean, shop: Workshop): Group {
  const [x, y, z] = size, root = new Group(), wood = shop.wood(color), dark = surface(shop.quality, { color: new Color('#4a3829'), roughness: 0.9 }), b = BOARD_M;
  for (const side of [-1, 1]) {
    root.add(shop.board([x, b, z], [0, side * (y - b) / 2, 0], wood, 0.002), shop.board([x, y - 2 * b, b], [0, 0, side * (z - b) / 2], wood, 0.002));
  }
  root.add(shop.board([b, y - 2 * b, z - 2 * b], [Math.min(x / 2 - b / 2, -x / 2 + 0.22), 0, 0], dark, 0.001));
  if (!shelf) return root;
  root.add(shop.board([Math.min(x - b, 0.2), y - 2 * b, 0.012], [-x / 2 + 0.105, 0, -0.06 * z], wood, 0.002));
  for (const [side, r, tone] of [[-1, 0.04, '#e9e2d3'], [1, 0.036, '#c8643c']] as const) {
    const bowl = put(new Mesh(new CylinderGeometry(r, 0.55 * r, 0.045, 32).rotateX(Math.PI / 2) as BufferGeometry, surface(shop.quality, { color: new Color(tone), roughness: 0.4, clearcoat: 0.5 })), [-x / 2 + 0.09, side * 0.22 * y, -0.06 * z + 0.03]);
    root.add(bowl);
  }
  return root;
}
