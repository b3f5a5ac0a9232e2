// Rounded figures from parametric surfaces: a surface maps two parameters to a point. Surfaces of one material are merged into one geometry.

import { BufferAttribute, BufferGeometry, CatmullRomCurve3, Color, Matrix4, Vector3 } from 'three';

/** Parameters across and along, both 0 .. 1. */
export type Surface = (u: number, v: number, to: Vector3) => Vector3;
export type Paint = Color | ((u: number, v: number, to: Color) => Color);
/** Number of segments across and along. */
export type Mesh2 = readonly [across: number, along: number];

/** Parameter step for the slope of a surface. */
const NEAR = 1e-3;

export class ParametricMesh {
  private readonly at: number[] = [];
  private readonly normals: number[] = [];
  private readonly colors: number[] = [];
  private readonly index: number[] = [];

  /** @param fineness scale of the number of segments: 1 is full, less is coarser */
  constructor(private readonly fineness: number) {}

  get vertices(): number { return this.at.length / 3; }

  /** Adds a surface; its outside is the direction of u × v. */
  put(surface: Surface, paint: Paint, [wide, high]: Mesh2): this {
    const across = Math.max(5, Math.round(wide * this.fineness)), along = Math.max(2, Math.round(high * this.fineness));
    const first = this.vertices, p = new Vector3(), a = new Vector3(), b = new Vector3(), color = new Color();
    for (let j = 0; j <= along; j++) {
      for (let i = 0; i <= across; i++) {
        const u = i / across, v = Math.min(1 - NEAR, Math.max(NEAR, j / along));
        surface(u, v, p);
        surface(u + NEAR, v, a).sub(p);
        surface(u, v + NEAR, b).sub(p);
        a.cross(b).normalize();
        const shown = paint instanceof Color ? paint : paint(u, v, color);
        this.at.push(p.x, p.y, p.z);
        this.normals.push(a.x, a.y, a.z);
        this.colors.push(shown.r, shown.g, shown.b);
      }
    }
    for (let j = 0; j < along; j++) {
      for (let i = 0; i < across; i++) {
        const q = first + j * (across + 1) + i, over = q + across + 1;
        this.index.push(q, q + 1, over + 1, q, over + 1, over);
      }
    }
    return this;
  }

  /** Adds an ellipsoid. @param frame its middle and semi-axes */
  ball(frame: Matrix4, paint: Paint, mesh: Mesh2): this {
    return this.put((u, v, to) => {
      const turn = 2 * Math.PI * u, up = Math.PI * v;
      return to.set(Math.sin(turn) * Math.sin(up), -Math.cos(up), Math.cos(turn) * Math.sin(up)).applyMatrix4(frame);
    }, paint, mesh);
  }

  /** Adds a tube along a line. @param radius radius along it; 0 at its ends closes it */
  tube(line: (t: number, to: Vector3) => Vector3, radius: (t: number, turn: number) => number, paint: Paint, mesh: Mesh2): this {
    const ring = remembered((t) => {
      const at = line(t, new Vector3()), ahead = line(t + NEAR, new Vector3()).sub(line(t - NEAR, new Vector3())).normalize();
      // The cross-section starts in a direction that is parallel to no line of a figure.
      const side = new Vector3(0.31, 0.2, -0.93).cross(ahead).normalize();
      return { at, side, up: new Vector3().crossVectors(ahead, side) };
    });
    return this.put((u, v, to) => {
      const { at, side, up } = ring(v), turn = 2 * Math.PI * u, r = radius(v, turn);
      return to.copy(at).addScaledVector(side, r * Math.cos(turn)).addScaledVector(up, r * Math.sin(turn));
    }, paint, mesh);
  }

  /** Writes the transformed vertices. @param frame rotation and translation */
  write({ position, normal }: Shape, first: number, frame: Matrix4): void {
    const p = new Vector3();
    for (let i = 0; i < this.at.length; i += 3) {
      p.fromArray(this.at, i).applyMatrix4(frame).toArray(position, 3 * first + i);
      p.fromArray(this.normals, i).transformDirection(frame).toArray(normal, 3 * first + i);
    }
  }

  paint(color: Float32Array, index: number[], first: number): void {
    color.set(this.colors, 3 * first);
    for (const i of this.index) index.push(first + i);
  }
}

/** Positions and normals of a geometry's vertices. */
export interface Shape { readonly position: Float32Array; readonly normal: Float32Array }
/** Meshes with their frames. */
export type Lumps = readonly (readonly [clay: ParametricMesh, frame: Matrix4])[];

const count = (lumps: Lumps): number => lumps.reduce((sum, [{ vertices }]) => sum + vertices, 0);

export function shapeOf(lumps: Lumps): Shape {
  const n = 3 * count(lumps), shape = { position: new Float32Array(n), normal: new Float32Array(n) };
  let first = 0;
  for (const [clay, frame] of lumps) {
    clay.write(shape, first, frame);
    first += clay.vertices;
  }
  return shape;
}

/** Merges meshes into one geometry. */
export function geometryOf(lumps: Lumps): BufferGeometry {
  const geometry = new BufferGeometry(), { position, normal } = shapeOf(lumps), color = new Float32Array(position.length), index: number[] = [];
  let first = 0;
  for (const [clay] of lumps) {
    clay.paint(color, index, first);
    first += clay.vertices;
  }
  geometry.setAttribute('position', new BufferAttribute(position, 3));
  geometry.setAttribute('normal', new BufferAttribute(normal, 3));
  geometry.setAttribute('color', new BufferAttribute(color, 3));
  geometry.setIndex(new BufferAttribute(new Uint16Array(index), 1));
  return geometry;
}

/** A frame for ball(): centre, and radii along the axes. */
export const ballAt = (at: Vector3, x: number, y: number, z: number): Matrix4 => new Matrix4().makeScale(x, y, z).setPosition(at);

/** Caches the last results of a function, which is called repeatedly with the rows of a surface. */
export function remembered<T>(make: (at: number) => T): (at: number) => T {
  const known = new Map<number, T>();
  return (at) => {
    let value = known.get(at);
    if (value === undefined) known.set(at, value = make(at));
    return value;
  };
}

/** A smooth line through points; constant beyond its ends. */
export function through(points: readonly Vector3[]): (t: number, to: Vector3) => Vector3 {
  const curve = new CatmullRomCurve3([...points], false, 'catmullrom');
  return (t, to) => curve.getPoint(Math.min(1, Math.max(0, t)), to);
}

/** A smooth function through given values. @param keys argument and value */
export function profile(keys: readonly (readonly [at: number, value: number])[]): (at: number) => number {
  const line = through(keys.map(([at, value]) => new Vector3(at, value, 0))), last = keys.length - 1, p = new Vector3();
  return remembered((at) => {
    const above = keys.findIndex(([from]) => from > at), k = above < 0 ? last - 1 : Math.max(0, above - 1);
    return line((k + (at - keys[k][0]) / (keys[k + 1][0] - keys[k][0])) / last, p).y;
  });
}

export const smooth = (from: number, to: number, x: number): number => {
  const t = Math.min(1, Math.max(0, (x - from) / (to - from)));
  return t * t * (3 - 2 * t);
};
