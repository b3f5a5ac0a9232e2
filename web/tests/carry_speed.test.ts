// Tests of carrying without physics: the target is held with exactly the requested force.
import { describe, expect, it } from 'vitest';
import { CarryControl, holdZone, isInPlace, type CarryInput } from '../src/input/carry_speed';
import type { Triple } from '../src/input/wish';

const LOW_N = 8.5;
const DT_S = 0.016;
/** The middle of the holding range [N]. */
const HELD_N = (holdZone(LOW_N).squeezeLow_n + holdZone(LOW_N).squeezeHigh_n) / 2;
const HOME: Triple = { x: 0.07, y: -0.06, z: 0 };
/** Position of the hand when the target is at the place where it is squeezed. */
const USE: Triple = { x: -0.03, y: 0, z: 0.05 };

class Hand {
  at = { ...HOME };
  readonly carry = new CarryControl();
  force_n = HELD_N;
  goesOn = true;
  way: Triple[] = [];

  /** Simulates until the carry ends or `until` holds; false: it ended. */
  play(most_s: number, until: () => boolean = () => false): boolean {
    for (let t = 0; t < most_s; t += DT_S) {
      const away = { x: USE.x - this.at.x, y: USE.y - this.at.y, z: USE.z - this.at.z };
      const seen: CarryInput = { hand: this.at, aim: this.at, away, squeeze_n: this.force_n, squeezeLow_n: LOW_N, goesOn: this.goesOn };
      const move = this.carry.step(seen, DT_S);
      if (!move) return false;
      this.force_n = move.hold ? HELD_N : 1.2 * LOW_N;
      this.at = { x: this.at.x + move.velocity.x * DT_S, y: this.at.y + move.velocity.y * DT_S, z: this.at.z + move.velocity.z * DT_S };
      this.way.push(this.at);
      if (until()) return true;
    }
    return true;
  }

  get away(): Triple { return { x: USE.x - this.at.x, y: USE.y - this.at.y, z: USE.z - this.at.z }; }
}

const expectHome = ({ at }: Hand): void => { for (const key of ['x', 'y', 'z'] as const) expect(Math.abs(at[key] - HOME[key])).toBeLessThan(0.005); };

describe('a carried target', () => {
  it('is lifted before it is moved sideways, squeezed only over the glass, and put back in its place', () => {
    const hand = new Hand();
    expect(hand.play(10, () => hand.force_n > LOW_N)).toBe(true);
    expect(isInPlace(hand.away)).toBe(true);
    const sideways = hand.way.find(({ x, y }) => Math.hypot(x - HOME.x, y - HOME.y) > 0.005)!;
    expect(sideways.z).toBeGreaterThan(0.9 * USE.z);
    hand.play(2);
    hand.goesOn = false;   // the step is finished
    expect(hand.play(10)).toBe(false);
    expectHome(hand);
  });

  it('is held on the way with less force than squeezes anything out', () => {
    const { squeezeLow_n, squeezeHigh_n } = holdZone(LOW_N);
    expect(squeezeLow_n).toBeGreaterThan(0);
    expect(squeezeHigh_n).toBeLessThan(LOW_N);
    const hand = new Hand();
    hand.play(10, () => { if (!isInPlace(hand.away)) expect(hand.force_n).toBeLessThan(LOW_N); return hand.force_n > LOW_N; });
  });

  it('is put back before the hand lets go when the person stops half way', () => {
    const hand = new Hand();
    hand.play(10, () => Math.hypot(hand.at.x - HOME.x, hand.at.y - HOME.y) > 0.04);
    hand.goesOn = false;
    expect(hand.play(10)).toBe(false);
    expectHome(hand);
  });

  it('is released in its place when the person stops before it was lifted', () => {
    const hand = new Hand();
    hand.play(0.1);
    hand.goesOn = false;
    expect(hand.play(0.1)).toBe(false);
    expect(hand.at).toEqual(HOME);
  });

  it('is put back when a limit of the reach keeps it from the glass', () => {
    const hand = new Hand();
    const limit = (): boolean => { hand.at.x = Math.max(hand.at.x, 0.03); return false; };
    expect(hand.play(60, limit)).toBe(false);
    expectHome(hand);
  });

  it('ends the carry once its grip is lost', () => {
    const hand = new Hand();
    hand.play(10, () => hand.at.z > 0.02);
    let ended = false;
    for (let t = 0; t < 1 && !ended; t += DT_S) {
      ended = !hand.carry.step({ hand: hand.at, aim: hand.at, away: hand.away, squeeze_n: 0, squeezeLow_n: LOW_N, goesOn: true }, DT_S);
    }
    expect(ended).toBe(true);
  });
});
