// Detects held objects: two parts of the hand press one object from opposite sides for HOLD_S. Pure.
import type { ContactPointT } from '../../protocol';

type Touch = Pick<ContactPointT, 'capsule' | 'body' | 'forceN'>;

/** An object counts as held after this time [s]. */
export const HOLD_S = 1;
/** Weaker contacts do not count as holding [N]. */
const LEAST_N = 0.1;
/** A longer gap between two states is not counted [s]. */
const GAP_S = 0.25;

/** Whether two capsules press a body from opposite sides. */
export function isHeld(contacts: readonly Touch[], body: number): boolean {
  const pressing = contacts.flatMap(({ capsule, body: on, forceN }) =>
    on === body && forceN && Math.hypot(forceN.x, forceN.y, forceN.z) >= LEAST_N ? [{ capsule, ...forceN }] : []);
  return pressing.some((a) => pressing.some((b) => a.capsule < b.capsule && a.x * b.x + a.y * b.y + a.z * b.z < 0));
}

export type News = 'held' | 'all' | undefined;

export class Grasps {
  readonly held: boolean[];
  private readonly since_s: number[];
  private last_s = NaN;

  constructor(private readonly bodies: readonly number[]) {
    this.held = bodies.map(() => false);
    this.since_s = bodies.map(() => 0);
  }

  /** Processes a state; reports objects that were held for the first time. */
  look(contacts: readonly Touch[], now_s: number): News {
    const dt_s = now_s - this.last_s, before = this.count;
    this.last_s = now_s;
    const watched_s = dt_s > 0 && dt_s <= GAP_S ? dt_s : 0;
    this.bodies.forEach((body, i) => {
      this.since_s[i] = isHeld(contacts, body) ? this.since_s[i]! + watched_s : 0;
      this.held[i] ||= this.since_s[i]! >= HOLD_S;
    });
    if (this.count === before) return undefined;
    return this.all ? 'all' : 'held';
  }

  begin(): void {
    this.held.fill(false);
    this.since_s.fill(0);
    this.last_s = NaN;
  }

  get count(): number { return this.held.filter(Boolean).length; }
  get all(): boolean { return this.count === this.held.length; }

  /** The object in the hand; -1: none. */
  get now(): number { return this.since_s.findIndex((since_s) => since_s > 0); }

  /** Holding time of an object as a share of HOLD_S. */
  share(i: number): number { return Math.min(1, (this.since_s[i] ?? 0) / HOLD_S); }

  /** The object to hold next: the one in the hand if it does not count yet, else the first that was not held; -1: all were. */
  get proposed(): number { return this.now >= 0 && !this.held[this.now] ? this.now : this.held.indexOf(false); }
}
