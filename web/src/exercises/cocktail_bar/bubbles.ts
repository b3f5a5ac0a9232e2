// Air that returns into a squeezed bottle: bubbles that rise behind its plastic.

import { Group, Mesh, SphereGeometry, type MeshBasicMaterial, type Vector3 } from 'three';
import type { BarDispenser } from './bar';
import { liquidLook } from './liquids';
import { flat } from '../../scene/materials';

/** Maximum number of bubbles, and the air volume of each [l]. */
const BUBBLES = 10;
const BUBBLE_L = 0.0006;
/** Height over the nozzle's tip at which a bubble starts, its rise [m], and its speed [m/s]. */
const FROM_M = 0.045;
const RISE_M = 0.09;
const RISES_M_S = 0.13;
const RADIUS_M = 0.0034;
/** Bubbles are at this share of the bottle's radius, inside its plastic, which is narrower while air returns. */
const IN_WALL = 0.95;
/** Angles of the bubbles from the visible side, and amplitude of their swing [rad]. */
const ASIDE = [-0.2, 0.55, -0.75, 0.2, 0.85, -0.5, 0, 0.4, -0.9, 0.7] as const;
const SWING = 0.12;

interface Bubble { readonly mesh: Mesh<SphereGeometry, MeshBasicMaterial>; risen_m: number; angle: number; radius_m: number; bottle: Group | undefined; from_m: number }

export class BubblesView {
  readonly root = new Group();
  private readonly bubbles: Bubble[];
  private next = 0;
  private air_l = 0;

  constructor() {
    const ball = new SphereGeometry(1, 10, 8), look = () => flat('#ffffff', { transparent: true, opacity: 0.65, depthWrite: false });
    this.bubbles = Array.from({ length: BUBBLES }, () => ({ mesh: new Mesh(ball, look()), risen_m: 0, angle: 0, radius_m: 0, bottle: undefined, from_m: 0 }));
    for (const { mesh } of this.bubbles) mesh.visible = false;
    this.root.add(...this.bubbles.map(({ mesh }) => mesh));
  }

  /** Adds air to a bottle, on the side that the camera sees. @param air_l since the last call */
  take(d: BarDispenser, bottle: Group, eye: Vector3, air_l: number): void {
    this.air_l += Math.max(0, air_l);
    for (; this.air_l >= BUBBLE_L; this.air_l -= BUBBLE_L) {
      const bubble = this.bubbles[this.next]!, seen = bottle.worldToLocal(eye.clone());
      if (bubble.bottle) { this.air_l = 0; return; }
      Object.assign(bubble, { bottle, risen_m: 0, angle: Math.atan2(seen.x, seen.z) + ASIDE[this.next]!, radius_m: IN_WALL * d.radius_m, from_m: d.nozzle_m[2] + FROM_M });
      bubble.mesh.material.color.set(liquidLook(d.liquid).bubble);
      this.next = (this.next + 1) % BUBBLES;
    }
  }

  advance(dt_s: number): void {
    for (const bubble of this.bubbles) {
      const { mesh, bottle, radius_m, from_m } = bubble;
      if (!bottle) continue;
      bubble.risen_m += RISES_M_S * dt_s;
      const share = bubble.risen_m / RISE_M, angle = bubble.angle + SWING * Math.sin(20 * share);
      mesh.visible = share < 1;
      if (!mesh.visible) bubble.bottle = undefined;
      mesh.scale.setScalar(RADIUS_M * Math.sin(Math.PI * Math.min(1, share)) + 1e-6);
      mesh.position.set(radius_m * Math.sin(angle), from_m + bubble.risen_m, radius_m * Math.cos(angle));
      bottle.localToWorld(mesh.position);
    }
  }
}
