// Liquid that falls from a nozzle: a thin steady stream whose width follows the flow, with drops at its end, and a
// puddle on the counter when no glass is below it.

import { CircleGeometry, Color, Group, LatheGeometry, Mesh, SphereGeometry, TorusGeometry, Vector2, type MeshPhysicalMaterial } from 'three';
import { DRIP_L_S } from './bar';
import { liquidLook } from './liquids';
import { flat, surface } from '../../scene/materials';
import type { Quality } from '../../scene/quality';

/** Flow at which the stream of the thinnest liquid has its modelled width [l/s], and limits of its relative width. */
const FULL_L_S = 0.008;
const NARROWEST = 0.35;
const WIDEST = 1.5;
/** Viscosity of the thinnest liquid [Pa·s], and falling speed of its stream's ends [m/s]: a thicker one is slower, and so wider. */
const THIN_PA_S = 0.157;
const FALLS_M_S = 0.9;
/** Cut-off of the width's low-pass, so that it neither jumps nor trembles [Hz]. */
const FOLLOW_HZ = 5;
/** Times of the drops after the stream has ended [s], and their size [m]. */
const DROPS_S = [0, 0.2, 0.55] as const;
const DROP_M = 0.0024;
const GRAVITY_M_S2 = 9.81;
const PUDDLE_DEPTH_M = 2e-3;

/** State of the poured liquid. Points and heights in three.js's frame [m]. */
export interface StreamState {
  readonly liquid: string;
  readonly viscosity_pa_s: number | undefined;
  readonly flow_l_s: number;
  /** The nozzle's tip; the stream begins there. */
  readonly from: { readonly x: number; readonly y: number; readonly z: number };
  readonly floor_m: number;
  readonly overGlass: boolean;
  readonly counter_m: number;
  /** Volume spilt in the whole level. */
  readonly spilt_l: number;
}

export class StreamView {
  readonly root = new Group();
  private readonly jet: Mesh;
  private readonly drops: Mesh[];
  private readonly rings = new Group();
  private readonly puddle: Mesh;
  private width = 0;
  /** Distances that the stream's upper and lower end have fallen [m]. */
  private tailFallen_m = 0;
  private headFallen_m = 0;
  private sinceEnd_s = Infinity;
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

  /** @param dt_s time since the last call */
  update(poured: StreamState, dt_s: number): void {
    const { liquid, flow_l_s, from, floor_m, overGlass } = poured, fall_m = Math.max(0, from.y - floor_m);
    const slower = Math.sqrt(Math.sqrt((poured.viscosity_pa_s || THIN_PA_S) / THIN_PA_S));
    this.fall(flow_l_s > DRIP_L_S, fall_m, FALLS_M_S / slower * dt_s, dt_s);
    // The flow is proportional to the width squared times the speed.
    const wanted = Math.max(NARROWEST, Math.min(WIDEST, Math.sqrt(slower * flow_l_s / FULL_L_S)));
    if (this.tailFallen_m === 0) this.width += (wanted - this.width) * (1 - Math.exp(-2 * Math.PI * FOLLOW_HZ * dt_s));
    this.jet.visible = this.headFallen_m > this.tailFallen_m;
    this.rings.visible = this.jet.visible && this.headFallen_m === fall_m && overGlass;
    this.jet.position.set(from.x, from.y - this.tailFallen_m, from.z);
    this.jet.scale.set(this.width, this.headFallen_m - this.tailFallen_m, this.width);
    this.rings.position.set(from.x, floor_m + 6e-4, from.z);
    this.drops.forEach((drop, i) => {
      const fallen_s = this.sinceEnd_s - DROPS_S[i]!, fallen_m = 0.5 * GRAVITY_M_S2 * fallen_s * fallen_s;
      drop.visible = fallen_s >= 0 && fallen_m < fall_m;
      drop.position.set(from.x, from.y - fallen_m, from.z);
    });
    if (this.jet.visible || this.drops.some(({ visible }) => visible)) paint(this.jet, liquid);
    this.updatePuddle(poured);
  }

  /** Moves both ends of the stream down; drops follow the upper one. @param by_m distance of this step */
  private fall(pours: boolean, fall_m: number, by_m: number, dt_s: number): void {
    const wasFalling = this.headFallen_m > this.tailFallen_m;
    if (pours) this.tailFallen_m = 0;
    else if (wasFalling) this.tailFallen_m += by_m;
    if (pours || wasFalling) this.headFallen_m = Math.min(fall_m, this.headFallen_m + by_m);
    this.sinceEnd_s = pours ? Infinity : wasFalling && this.sinceEnd_s === Infinity ? 0 : this.sinceEnd_s + dt_s;
    if (pours || this.tailFallen_m < this.headFallen_m) return;
    this.tailFallen_m = this.headFallen_m = this.width = 0;
  }

  private updatePuddle({ liquid, from, overGlass, counter_m, spilt_l }: StreamState): void {
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
