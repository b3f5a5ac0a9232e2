// The glass, its content, and the fill line. Frame: y up from the glass's underside.

import {
  BufferAttribute, BufferGeometry, CircleGeometry, Color, CylinderGeometry, DoubleSide, Group, LatheGeometry, Mesh,
  MeshBasicMaterial, TorusGeometry, Vector2, type Material,
} from 'three';
import { liquidLook } from './liquids';
import type { BarGlass } from './bar';
import type { Layer } from './layers';
import { disposeTree, flat, surface } from '../../scene/materials';
import { picture } from '../../scene/textures';
import { patternTexture } from './liquid_textures';
import type { Quality } from '../../scene/quality';

/** Thickness of the floor [m]. */
export const FLOOR_M = 0.012;
const WALL_M = 0.0022;
const COASTER_M = 0.0015;
/** Height of the pattern's texture, which covers the whole glass; its width wraps around once [m]. */
const PATTERN_M = 0.114;
const PATTERN_PX = [1024, 640] as const;
const SEGMENTS = 56;

/** Inner radius at a height over the glass's underside [m]. */
export function innerRadius(glass: BarGlass, y: number): number {
  return glass.radius_m * (0.9 + 0.1 * (y - FLOOR_M) / (glass.height_m - FLOOR_M)) - WALL_M;
}

/** Largest visible fill height over the glass's floor [m]. */
export const rimHeight = (glass: BarGlass): number => glass.height_m - FLOOR_M - 0.003;

/** One liquid: a patterned side and a lid. */
class LayerView {
  readonly root = new Group();
  private readonly side: Mesh<BufferGeometry>;
  private readonly lid: Mesh;
  private bottom = -1;
  private top = -1;

  constructor(readonly liquid: string, private readonly glass: BarGlass, quality: Quality) {
    const look = liquidLook(liquid), geometry = new CylinderGeometry(1, 1, 1, SEGMENTS, 1, true);
    this.side = new Mesh(geometry, surface(quality, {
      map: patternTexture(liquid, ...PATTERN_PX, 0.9), roughness: 0.5, emissive: new Color(look.color), emissiveIntensity: 0.1 }));
    this.lid = new Mesh(new CircleGeometry(1, SEGMENTS), surface(quality, {
      color: new Color(look.color).lerp(new Color('#ffffff'), 0.22), roughness: 0.2 }));
    this.lid.rotation.x = -Math.PI / 2;
    this.root.add(this.side, this.lid);
  }

  place(bottom: number, top: number, isLast: boolean): void {
    this.lid.visible = isLast;
    if (bottom === this.bottom && top === this.top) return;
    this.bottom = bottom;
    this.top = top;
    const at = this.side.geometry.attributes.position as BufferAttribute, uv = this.side.geometry.attributes.uv as BufferAttribute;
    // Vertices of three.js's cylinder: the upper ring first, then the lower.
    for (let i = 0; i < at.count; i++) {
      const upper = i <= SEGMENTS, y = upper ? top : bottom, r = innerRadius(this.glass, y);
      const turn = 2 * Math.PI * (i % (SEGMENTS + 1)) / SEGMENTS;
      at.setXYZ(i, r * Math.sin(turn), y, r * Math.cos(turn));
      uv.setY(i, y / PATTERN_M);
    }
    at.needsUpdate = uv.needsUpdate = true;
    const r = innerRadius(this.glass, top);
    this.lid.scale.setScalar(r);
    this.lid.position.y = top + 2e-4;
  }
}

export class GlassView {
  readonly root = new Group();
  private readonly contents = new Group();
  private readonly line = new Group();
  private readonly garnish = new Group();
  private layers: LayerView[] = [];
  private faded = 1;

  constructor(private readonly glass: BarGlass, private readonly quality: Quality) {
    this.root.add(this.contents, this.line, this.garnish);
    this.makeGlass();
    this.makeLine();
    this.makeGarnish();
  }

  /** @param layers heights over the glass's floor @param line_m the fill line's height over it; undefined: no line */
  update(layers: readonly Layer[], line_m: number | undefined, done: boolean): void {
    layers.forEach((layer, i) => {
      if (this.layers[i]?.liquid !== layer.liquid) {
        this.pourOut(i);
        this.layers[i] = new LayerView(layer.liquid, this.glass, this.quality);
        this.contents.add(this.layers[i].root);
      }
      this.layers[i].place(layer.bottom_m + FLOOR_M, layer.top_m + FLOOR_M, i === layers.length - 1);
    });
    this.pourOut(layers.length);
    this.line.visible = line_m !== undefined;
    if (line_m !== undefined) {
      const r = innerRadius(this.glass, line_m + FLOOR_M) + 0.003;
      this.line.position.y = line_m + FLOOR_M;
      this.line.scale.set(r, 1, r);
    }
    this.garnish.visible = done;
  }

  /** @param share visible share of the glass, 0 .. 1; its materials are transparent only between */
  fade(share: number): void {
    this.root.visible = share > 0;
    if (share === this.faded) return;
    this.faded = share;
    this.root.traverse((object) => {
      const material = (object as Mesh).material;
      for (const m of material ? [material].flat() : []) {
        const whole = m.userData as { opacity?: number; transparent?: boolean };
        whole.opacity ??= m.opacity;
        whole.transparent ??= m.transparent;
        const transparent = whole.transparent || share < 1;
        if (m.transparent !== transparent) m.needsUpdate = true;
        m.transparent = transparent;
        m.opacity = whole.opacity * share;
      }
    });
  }

  private pourOut(from: number): void {
    for (const old of this.layers.splice(from)) {
      this.contents.remove(old.root);
      disposeTree(old.root);
    }
  }

  private makeGlass(): void {
    const r = this.glass.radius_m, h = this.glass.height_m, q = this.quality, fine = q === 'high';
    const clear = surface(q, { color: new Color('#eaf6f5'), transparent: true, opacity: 0.17, roughness: 0.05, metalness: 0,
      side: DoubleSide, depthWrite: false, envMapIntensity: 2.2, specularIntensity: 1 });
    const profile = [[1e-4, 0], [r * 0.84, 0], [r * 0.88, 0.002], [r * 0.9, FLOOR_M], [r, h]].map(([x, y]) => new Vector2(x, y));
    const wall = new Mesh(new LatheGeometry(profile, fine ? 64 : 32), clear);
    const rim = new Mesh(new TorusGeometry(r - 6e-4, 0.0013, fine ? 10 : 5, fine ? 72 : 40), surface(q, { color: new Color('#ffffff'), roughness: 0.08, transparent: true, opacity: 0.75 }));
    rim.rotation.x = Math.PI / 2;
    rim.position.y = h;
    const floor = new Mesh(new CylinderGeometry(r * 0.885, r * 0.85, 0.01, 48), surface(q, { color: new Color('#dff0ee'), transparent: true, opacity: 0.42, roughness: 0.1 }));
    floor.position.y = 0.0055;
    const coaster = new Mesh(new CylinderGeometry(0.044, 0.044, COASTER_M, 56), surface(q, { color: new Color('#243f3d'), roughness: 0.9 }));
    coaster.position.y = COASTER_M / 2;   // the glass stands in it
    coaster.receiveShadow = true;
    // Clear glass would cast no shadow; an invisible cylinder inside it does.
    const shade = new Mesh(new CylinderGeometry(r * 0.8, r * 0.8, h * 0.7, 24), new MeshBasicMaterial({ colorWrite: false, depthWrite: false }));
    shade.position.y = h * 0.35;
    shade.castShadow = true;
    wall.renderOrder = 3;
    rim.renderOrder = 4;
    this.root.add(wall, rim, floor, coaster, shade);
  }

  private makeLine(): void {
    const ring = (radius: number, height: number, material: Material) => new Mesh(new CylinderGeometry(radius, radius, height, 48, 1, true), material);
    this.line.add(ring(1.0, 0.0066, flat('#1c1410', { side: DoubleSide })), ring(1.007, 0.0036, flat('#ffffff', { side: DoubleSide })));
  }

  private makeGarnish(): void {
    const straw = new Mesh(new CylinderGeometry(0.0032, 0.0032, 0.15, 16), surface(this.quality, { color: new Color('#F7EEDD'), roughness: 0.5 }));
    straw.position.set(0.011, 0.108, -0.006);
    straw.rotation.z = -0.24;
    const face = surface(this.quality, { roughness: 0.6, map: picture(256, 256, lemonSlice) });
    const slice = new Mesh(new CylinderGeometry(0.021, 0.021, 0.004, 40), [surface(this.quality, { color: new Color('#F2B91E'), roughness: 0.6 }), face, face]);
    slice.rotation.order = 'YXZ';
    slice.rotation.set(Math.PI / 2, -0.35, 0);
    slice.position.set(-0.031, this.glass.height_m + 0.004, 0.006);
    straw.castShadow = slice.castShadow = true;
    this.garnish.add(straw, slice);
    this.garnish.visible = false;
  }
}

function lemonSlice(pen: CanvasRenderingContext2D): void {
  pen.fillStyle = '#F2B91E';
  pen.fillRect(0, 0, 256, 256);
  pen.fillStyle = '#FFF3C4';
  pen.beginPath();
  pen.arc(128, 128, 112, 0, 2 * Math.PI);
  pen.fill();
  pen.fillStyle = '#FFD84F';
  for (let i = 0; i < 8; i++) {
    pen.beginPath();
    pen.moveTo(128, 128);
    pen.arc(128, 128, 100, i * Math.PI / 4 + 0.08, (i + 1) * Math.PI / 4 - 0.08);
    pen.fill();
  }
}
