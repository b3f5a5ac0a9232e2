// Draws a glow for each touching pair of capsule and body; its size follows the force.

import { Group, Sprite, SpriteMaterial, Vector3, type Camera, type Texture } from 'three';
import type { ContactPointT } from '../protocol';
import { toThree } from './frames';
import { glowTexture } from './textures';

/** Cut-off of the low-pass for the shown force, so that an intermittent contact does not flicker [Hz]. */
const FOLLOW_HZ = 5;
const DIAMETER_M = 0.019;
const DIAMETER_PER_N = 0.0066;
const LARGEST_M = 0.06;
/** Weaker contacts are not shown [N]. */
const WEAKEST_N = 0.05;
/** Radius of the warm tint on the skin [m], and per newton. */
const TINT_M = 0.009;
const TINT_PER_N = 0.0022;
const MOST = 10;

export interface Contact { readonly x: number; readonly y: number; readonly z: number; readonly force_n: number }

interface DisplayedContact { point: Vector3; push: Vector3; target_n: number; force_n: number }

/** Forces at the same capsule and body, summed, at their mean point, low-passed. In the program's frame. */
export class ContactFilter {
  private readonly shown = new Map<string, DisplayedContact>();

  take(contacts: readonly ContactPointT[]): void {
    for (const s of this.shown.values()) s.target_n = 0;
    const sums = new Map<string, { force_n: number; at: Vector3; push: Vector3 }>();
    for (const c of contacts) {
      if (!c.pointM || !c.forceN) continue;
      const force_n = Math.hypot(c.forceN.x, c.forceN.y, c.forceN.z), key = `${c.capsule} ${c.body}`;
      const sum = sums.get(key) ?? { force_n: 0, at: new Vector3(), push: new Vector3() };
      sum.force_n += force_n;
      sum.at.addScaledVector(new Vector3(c.pointM.x, c.pointM.y, c.pointM.z), force_n);
      sum.push.add(new Vector3(c.forceN.x, c.forceN.y, c.forceN.z));
      sums.set(key, sum);
    }
    for (const [key, sum] of sums) {
      if (sum.force_n <= 0) continue;
      const s = this.shown.get(key) ?? { point: new Vector3(), push: new Vector3(), target_n: 0, force_n: 0 };
      s.point.copy(sum.at).divideScalar(sum.force_n);
      s.push.copy(sum.push);
      s.target_n = sum.force_n;
      this.shown.set(key, s);
    }
  }

  advance(dt_s: number): void {
    const share = 1 - Math.exp(-2 * Math.PI * FOLLOW_HZ * dt_s);
    for (const [key, s] of this.shown) {
      s.force_n += (s.target_n - s.force_n) * share;
      if (s.target_n === 0 && s.force_n < WEAKEST_N) this.shown.delete(key);
    }
  }

  /** The contacts, the strongest first. */
  strongest(): readonly DisplayedContact[] {
    return [...this.shown.values()].filter((s) => s.force_n >= WEAKEST_N).sort((a, b) => b.force_n - a.force_n).slice(0, MOST);
  }
}

export class ContactGlow {
  readonly root = new Group();
  private readonly filter = new ContactFilter();
  private readonly sprites: Sprite[] = [];
  private readonly texture: Texture = glowTexture();

  constructor() {
    for (let i = 0; i < MOST; i++) {
      const sprite = new Sprite(new SpriteMaterial({ map: this.texture, transparent: true, depthTest: false, depthWrite: false, toneMapped: false }));
      sprite.renderOrder = 10;
      sprite.visible = false;
      this.sprites.push(sprite);
      this.root.add(sprite);
    }
  }

  take(contacts: readonly ContactPointT[]): void { this.filter.take(contacts); }

  /** @returns the tints of the skin: program's frame, radius of each [m] */
  update(camera: Camera, dt_s: number): { point: Vector3; radius_m: number }[] {
    this.filter.advance(dt_s);
    const list = this.filter.strongest();
    this.sprites.forEach((sprite, i) => {
      const s = list[i];
      sprite.visible = s !== undefined;
      if (!s) return;
      const at = toThree(s.point), toCamera = camera.position.clone().sub(at).normalize();
      const hidden = toThree(s.push).dot(toCamera) < 0;
      const size = Math.min(LARGEST_M, DIAMETER_M + DIAMETER_PER_N * s.force_n);
      sprite.scale.set(size, size, 1);
      sprite.position.copy(at).addScaledVector(toCamera, 0.012);
      sprite.material.opacity = (hidden ? 0.6 : 1) * Math.min(1, s.force_n / 0.4);
    });
    return list.map((s) => ({ point: s.point, radius_m: (TINT_M + TINT_PER_N * s.force_n) * Math.min(1, s.force_n / 0.4) }));
  }
}
