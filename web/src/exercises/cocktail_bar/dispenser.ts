// A squeeze bottle that hangs from the rail, nozzle down, and the sign over it.

import {
  BufferAttribute, Color, CylinderGeometry, Group, LatheGeometry, Mesh, Vector2, type Material,
} from 'three';
import { liquidLook } from './liquids';
import type { BarDispenser } from './bar';
import type { SkinUniforms } from '../../hand/skin_shader';
import { Dent, pressingOn } from '../../scene/dent';
import { surface } from '../../scene/materials';
import { inkOf, Sign } from '../../scene/sign';
import { drawSymbol, patternTexture } from './liquid_textures';
import type { Quality } from '../../scene/quality';
import { brass } from '../../scene/stage';

/** Heights over the nozzle's tip: end of the cap, and end of the straight part [m]. */
const CAP_M = 0.0335;
const STRAIGHT_M = 0.0525;
/** Height of the brass ring that holds the bottle [m]. */
const RING_M = 0.013;
/** A pressed bottle is narrower: by this per litre, and at most by this share. */
const NARROWER_PER_L = 15;
const NARROWEST = 0.18;
const SIGN_WIDTH_M = 0.121;
const SIGN_HEIGHT_M = 0.0369;

const points = (list: readonly (readonly [number, number])[]) => list.map(([r, y]) => new Vector2(r, y));

/** The straight wall has `rows` segments, so that it can deform. */
function bottleProfile(d: BarDispenser, rows: number): Vector2[] {
  const r = d.radius_m, tip = d.nozzle_m[2], top = d.height_m / 2 - RING_M, low = tip + STRAIGHT_M;
  const wall = Array.from({ length: rows }, (_, i) => [r, low + (top - 0.008 - low) * i / (rows - 1)] as const);
  return points([
    [0.54 * r, tip + 0.0315], [0.66 * r, tip + 0.0325], [0.84 * r, tip + 0.037], [0.968 * r, tip + 0.044], ...wall,
    [0.94 * r, top - 0.0025], [0.76 * r, top], [1e-4, top],
  ]);
}

function bottle(d: BarDispenser, quality: Quality): Mesh {
  const profile = bottleProfile(d, quality === 'high' ? 40 : 2);
  const geometry = new LatheGeometry(profile, quality === 'high' ? 96 : 32, Math.PI);
  // The pattern is mapped by height, not by point of the profile, so that it is not stretched.
  const uv = geometry.attributes.uv as BufferAttribute, at = geometry.attributes.position as BufferAttribute;
  for (let i = 0; i < uv.count; i++) uv.setY(i, at.getY(i) / d.height_m + 0.5);
  const around_m = 2 * Math.PI * d.radius_m;
  const texture = patternTexture(d.liquid, 1024, Math.round(1024 * d.height_m / around_m), 1.3333);
  const mesh = new Mesh(geometry, surface(quality, { map: texture, roughness: 0.36, clearcoat: 0.55, clearcoatRoughness: 0.22 }));
  mesh.castShadow = mesh.receiveShadow = true;
  return mesh;
}

function nozzle(d: BarDispenser, quality: Quality): Mesh {
  const tip = d.nozzle_m[2];
  const profile = points([
    [1e-4, tip], [0.0042, tip], [0.0046, tip + 0.002], [0.0085, tip + 0.024], [0.0145, tip + 0.0255],
    [0.015, tip + 0.027], [0.015, tip + CAP_M], [1e-4, tip + CAP_M],
  ]);
  const mesh = new Mesh(new LatheGeometry(profile, quality === 'high' ? 40 : 16), surface(quality, { color: new Color('#2a2320'), roughness: 0.45, clearcoat: 0.3 }));
  mesh.castShadow = true;
  return mesh;
}

/** The ring around the bottle's upper end, and the stem to the rail. */
function holder(d: BarDispenser, quality: Quality, rail_m: number): Mesh[] {
  const top = d.height_m / 2, metal = brass(quality);
  const ring = new Mesh(new CylinderGeometry(0.82 * d.radius_m, 0.82 * d.radius_m, RING_M, quality === 'high' ? 40 : 20), metal);
  ring.position.y = top - RING_M / 2;
  ring.castShadow = true;
  const reach = rail_m - top;
  if (d.free || reach <= 0) return [ring];
  const stem = new Mesh(new CylinderGeometry(0.004, 0.004, reach, 16), metal);
  stem.position.y = top + reach / 2;
  stem.castShadow = true;
  return [ring, stem];
}

/** Opacity of an empty bottle, of which only the plastic is visible. */
const EMPTY_OPACITY = 0.28;

/** The deformable plastic of a dispenser. */
export class Shell {
  private readonly dent: Dent | undefined;
  private empty = false;
  private narrower = 0;

  constructor(private readonly mesh: Mesh, private readonly radius_m: number, quality: Quality) {
    // Plain materials have few vertices: there the whole wall becomes narrower, by half of the waist.
    this.dent = quality === 'high' ? new Dent(mesh.geometry, radius_m) : undefined;
  }

  /** @param keeps share of the dents that stays without a finger, 0 .. 1 */
  yieldTo(skin: SkinUniforms, root: Group, keeps: number): void { this.dent?.update(pressingOn(root, skin, this.radius_m), keeps, this.narrower); }

  /** @param pressed_l liquid that was pressed out and not yet replaced by air */
  show(pressed_l: number, empty: boolean): void {
    this.narrower = Math.min(NARROWEST, NARROWER_PER_L * pressed_l);
    const wide = this.dent ? 1 : 1 - 0.5 * this.narrower;
    this.mesh.scale.set(wide, 1, wide);
    if (empty === this.empty) return;
    this.empty = empty;
    const material = this.mesh.material as Material;
    material.transparent = empty;
    material.opacity = empty ? EMPTY_OPACITY : 1;
    material.needsUpdate = true;
  }
}

/** @param rail_m height of the rail over the body's origin */
export function makeDispenser(d: BarDispenser, quality: Quality, rail_m: number): { root: Group; shell: Shell } {
  const root = new Group(), body = bottle(d, quality);
  root.add(body, nozzle(d, quality), ...holder(d, quality, rail_m));
  return { root, shell: new Shell(body, d.radius_m, quality) };
}

/** The sign on the rail: symbol and word, highlighted for the current dispenser. */
export function makeSign(liquid: string): Sign {
  const look = liquidLook(liquid);
  return new Sign(SIGN_WIDTH_M, {
    width_px: 944, height_px: 288, corner_px: 64, text_px: 150, most_px: 660,
    write(pen, name, lit) {
      const left = (944 - pen.measureText(name).width - 150) / 2;
      pen.fillStyle = lit ? look.deep : look.color;
      drawSymbol(pen, look.symbol, left + 58, 146, 58);
      pen.fillStyle = inkOf(lit);
      pen.fillText(name, left + 150, 152);
    },
  }, SIGN_HEIGHT_M);
}
