// Liquid that falls from a nozzle: thin and steady, its width following the flow, with drops after it; and what it
// makes on the counter when no glass is under it.

import { CircleGeometry, Color, Group, LatheGeometry, Mesh, SphereGeometry, TorusGeometry, Vector2, type MeshPhysicalMaterial } from 'three';
import { DRIP_L_S } from './bar';
import { liquidLook } from './liquids';
import { flat, surface } from '../../scene/materials';
import type { Quality } from '../../scene/quality';

/** Flow at which the stream of the thinnest liquid is as wide as it is modelled [l/s], and how narrow and wide it gets. */
const FULL_L_S = 0.008;
const NARROWEST = 0.35;
const WIDEST = 1.5;
/** The thinnest liquid [Pa·s], and how fast its stream's ends fall [m/s]: a thick one is slower, and so wider. */
const THIN_PA_S = 0.157;
const FALLS_M_S = 0.9;
/** Of the width, so that it neither jumps nor trembles [Hz]. */
const FOLLOW_HZ = 5;
/** When drops fall after the stream has ended [s], and how large they are [m]. */
const DROPS_S = [0, 0.2, 0.55] as const;
const DROP_M = 0.0024;
const GRAVITY_M_S2 = 9.81;
const PUDDLE_DEPTH_M = 2e-3;

/** What pours. Points and heights in three.js's frame [m]. */
export interface Poured {
  readonly liquid: string;
  readonly viscosity_pa_s: number | undefined;
  readonly flow_l_s: number;
  /** The nozzle's tip, and where the stream ends. */
  readonly from: { readonly x: number; readonly y: number; readonly z: number };
  readonly floor_m: number;
  readonly overGlass: boolean;
  readonly counter_m: number;
  /** Of the whole level. */
  readonly spilt_l: number;
}

export class StreamView {
  readonly root = new Group();
  private readonly jet: Mesh;
  private readonly drops: Mesh[];
  private readonly rings = new Group();
  private readonly puddle: Mesh;
  private width = 0;
  /** How far its upper end and its lower one have fallen [m]. */
  private tail_m = 0;
  private head_m = 0;
  private ended_s = Infinity;
  private spilt_l = 0;

  constructor(quality: Quality) {
    const profile: Vector2[] = [];
    for (let i = 24; i >= 0; i--) {
      const t = i / 24;   // 0 at the nozzle: a falling stream narrows, and widens where it lands
      profile.push(new Vector2(0.0034 - 0.0012 * Math.sqrt(t) + (t > 0.94 ? (t - 0.94) * 0.02 : 0), -t));
    }
    const wet = surface(quality, { roughness: 0.18, clearcoat: 0.6 });
    this.jet = new Mesh(new LatheGeometry(profile, quality === 'high' ? 20 : 8), wet);
    this.jet.castShadow = true;
    const drop = new SphereGeometry(DROP_M, 10, 8);
    this.drops = DROPS_S.map(() => new Mesh(drop, wet));
    for (const [radius, opacity] of [[0.0085, 0.5], [0.015, 0.28]]) {
      const ring = new Mesh(new TorusGeometry(radius, 0.0007, 4, 40), flat('#ffffff', { transparent: true, opacity }));
      ring.rotation.x = Math.PI / 2;
      this.rings.add(ring);
    }
    this.puddle = new Mesh(new CircleGeometry(1, 48), surface(quality, { roughness: 0.15, clearcoat: 0.8, transparent: true, opacity: 0.85 }));
    this.puddle.rotation.x = -Math.PI / 2;
    for (const part of [this.jet, this.rings, this.puddle, ...this.drops]) part.visible = false;
    this.root.add(this.jet, this.rings, this.puddle, ...this.drops);
  }

  /** @param dt_s since last time */
  update(poured: Poured, dt_s: number): void {
    const { liquid, flow_l_s, from, floor_m, overGlass } = poured, fall_m = Math.max(0, from.y - floor_m);
    const slower = Math.sqrt(Math.sqrt((poured.viscosity_pa_s || THIN_PA_S) / THIN_PA_S));
    this.fall(flow_l_s > DRIP_L_S, fall_m, FALLS_M_S / slower * dt_s, dt_s);
    // What flows is the width squared times the speed.
    const wanted = Math.max(NARROWEST, Math.min(WIDEST, Math.sqrt(slower * flow_l_s / FULL_L_S)));
    if (this.tail_m === 0) this.width += (wanted - this.width) * (1 - Math.exp(-2 * Math.PI * FOLLOW_HZ * dt_s));
    this.jet.visible = this.head_m > this.tail_m;
    this.rings.visible = this.jet.visible && this.head_m === fall_m && overGlass;
    this.jet.position.set(from.x, from.y - this.tail_m, from.z);
    this.jet.scale.set(this.width, this.head_m - this.tail_m, this.width);
    this.rings.position.set(from.x, floor_m + 6e-4, from.z);
    this.drops.forEach((drop, i) => {
      const fallen_s = this.ended_s - DROPS_S[i]!, fallen_m = 0.5 * GRAVITY_M_S2 * fallen_s * fallen_s;
      drop.visible = fallen_s >= 0 && fallen_m < fall_m;
      drop.position.set(from.x, from.y - fallen_m, from.z);
    });
    if (this.jet.visible || this.drops.some(({ visible }) => visible)) paint(this.jet, liquid);
    this.updatePuddle(poured);
  }

  /** Both ends of the stream fall; drops come after the upper one. @param by_m how far they fall */
  private fall(pours: boolean, fall_m: number, by_m: number, dt_s: number): void {
    const was = this.head_m > this.tail_m;
    if (pours) this.tail_m = 0;
    else if (was) this.tail_m += by_m;
    if (pours || was) this.head_m = Math.min(fall_m, this.head_m + by_m);
    this.ended_s = pours ? Infinity : was && this.ended_s === Infinity ? 0 : this.ended_s + dt_s;
    if (pours || this.tail_m < this.head_m) return;
    this.tail_m = this.head_m = this.width = 0;
  }

  private updatePuddle({ liquid, from, overGlass, counter_m, spilt_l }: Poured): void {
    if (spilt_l < this.spilt_l) this.puddle.visible = false;   // a new level
    if (spilt_l > this.spilt_l + 1e-7 && !overGlass) {
      this.puddle.visible = true;
      this.puddle.position.set(from.x, counter_m + 8e-4, from.z);
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
