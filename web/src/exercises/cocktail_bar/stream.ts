// Liquid that falls from a nozzle: thin and steady, its width following the flow; and what it makes
// on the counter when no glass is under it.

import { CircleGeometry, Color, Group, LatheGeometry, Mesh, TorusGeometry, Vector2, type MeshPhysicalMaterial } from 'three';
import { liquidLook } from './liquids';
import { flat, surface } from '../../scene/materials';
import type { Quality } from '../../scene/quality';

/** Flow at which the stream is as wide as it is modelled [l/s], and the narrowest share of that. */
const FULL_L_S = 0.008;
const NARROWEST = 0.5;
/** Of the width, so that it neither jumps nor trembles [Hz]. */
const FOLLOW_HZ = 5;
const PUDDLE_DEPTH_M = 2e-3;

export class StreamView {
  readonly root = new Group();
  private readonly jet: Mesh;
  private readonly rings = new Group();
  private readonly puddle: Mesh;
  private width = 0;
  private spilt_l = 0;

  constructor(quality: Quality) {
    const profile: Vector2[] = [];
    for (let i = 24; i >= 0; i--) {
      const t = i / 24;   // 0 at the nozzle: a falling stream narrows, and widens where it lands
      profile.push(new Vector2(0.0034 - 0.0012 * Math.sqrt(t) + (t > 0.94 ? (t - 0.94) * 0.02 : 0), -t));
    }
    this.jet = new Mesh(new LatheGeometry(profile, quality === 'high' ? 20 : 8), surface(quality, { roughness: 0.18, clearcoat: 0.6 }));
    this.jet.castShadow = true;
    for (const [radius, opacity] of [[0.0085, 0.5], [0.015, 0.28]]) {
      const ring = new Mesh(new TorusGeometry(radius, 0.0007, 4, 40), flat('#ffffff', { transparent: true, opacity }));
      ring.rotation.x = Math.PI / 2;
      this.rings.add(ring);
    }
    this.puddle = new Mesh(new CircleGeometry(1, 48), surface(quality, { roughness: 0.15, clearcoat: 0.8, transparent: true, opacity: 0.85 }));
    this.puddle.rotation.x = -Math.PI / 2;
    this.jet.visible = this.rings.visible = this.puddle.visible = false;
    this.root.add(this.jet, this.rings, this.puddle);
  }

  /**
   * @param from the nozzle's tip, three.js's frame; @param floor height at which the stream ends
   * @param counter height of the counter; @param spilt_l of the whole level; @param dt_s since last time
   */
  update(liquid: string, flow_l_s: number, from: { x: number; y: number; z: number }, floor: number, overGlass: boolean,
         counter: number, spilt_l: number, dt_s: number): void {
    const wanted = flow_l_s > 1e-6 ? Math.max(NARROWEST, Math.min(1.3, Math.sqrt(flow_l_s / FULL_L_S))) : 0;
    this.width += (wanted - this.width) * (1 - Math.exp(-2 * Math.PI * FOLLOW_HZ * dt_s));
    const falls = this.width > 0.12 && from.y > floor;
    this.jet.visible = falls;
    this.rings.visible = falls && overGlass;
    if (falls) {
      this.jet.position.set(from.x, from.y, from.z);
      this.jet.scale.set(this.width, from.y - floor, this.width);
      this.rings.position.set(from.x, floor + 6e-4, from.z);
      paint(this.jet, liquid);
    }
    this.updatePuddle(liquid, from, overGlass, counter, spilt_l);
  }

  private updatePuddle(liquid: string, from: { x: number; z: number }, overGlass: boolean, counter: number, spilt_l: number): void {
    if (spilt_l < this.spilt_l) this.puddle.visible = false;   // a new level
    if (spilt_l > this.spilt_l + 1e-7 && !overGlass) {
      this.puddle.visible = true;
      this.puddle.position.set(from.x, counter + 8e-4, from.z);
      paint(this.puddle, liquid);
    }
    this.spilt_l = spilt_l;
    const radius = Math.sqrt(Math.max(0, spilt_l) * 1e-3 / (Math.PI * PUDDLE_DEPTH_M));
    this.puddle.scale.set(radius, radius * 0.8, 1);
  }
}

function paint(mesh: Mesh, liquid: string): void {
  (mesh.material as MeshPhysicalMaterial).color.copy(new Color(liquidLook(liquid).color));
}
