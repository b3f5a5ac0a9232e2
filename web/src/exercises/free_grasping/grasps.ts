// Which things were held: two parts of the hand press one thing from opposite sides, for a while. Pure.
import type { ContactPointT } from '../../protocol';

type Touch = Pick<ContactPointT, 'capsule' | 'body' | 'forceN'>;

/** A thing counts as held after so long [s]. */
export const HOLD_S = 1;
/** Weaker touches hold nothing [N]. */
const LEAST_N = 0.1;
/** States farther apart than this are no stretch of time that was watched [s]. */
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

  /** Takes a state; says what was held for the first time. */
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

  /** The thing in the hand; -1: none. */
  get now(): number { return this.since_s.findIndex((since_s) => since_s > 0); }

  /** For how long it has been held, as a share of what counts. */
  share(i: number): number { return Math.min(1, (this.since_s[i] ?? 0) / HOLD_S); }

  /** What to hold: what is in the hand and does not count yet, else the first that was not held; -1: all were. */
  get proposed(): number { return this.now >= 0 && !this.held[this.now] ? this.now : this.held.indexOf(false); }
}
