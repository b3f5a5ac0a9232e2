// The picture of the glass after a drink is done.
import { describe, expect, it } from 'vitest';
import { servingAt, ServingClock } from '../src/exercises/cocktail_bar/serving';

const TICK_S = 1 / 60;

describe('a done drink', () => {
  it('slides to the middle, is drunk, and slides away empty, in that order', () => {
    const seen = Array.from({ length: 6 * 60 }, (_, i) => servingAt(i * TICK_S, undefined, false));
    expect(seen[0]).toMatchObject({ pose: 'waits', toMiddle: 0, seen: 1, empty: false });
    const poses = seen.map(({ pose }) => pose).filter((pose, i, all) => pose !== all[i - 1]);
    expect(poses).toEqual(['waits', 'drinks', 'thanks']);
    for (const { pose, toMiddle, seen: share, empty } of seen) {
      if (pose === 'drinks') expect([toMiddle, share]).toEqual([1, 0]);   // the guest holds it
      if (pose === 'thanks') expect(empty).toBe(true);
    }
    expect(seen.at(-1)).toMatchObject({ pose: 'thanks', away: 1, seen: 0 });
  });

  it('moves without a jump, there and back', () => {
    const clock = new ServingClock();
    const all = Array.from({ length: 9 * 60 }, (_, i) => clock.look(i < 6 * 60, false, TICK_S, false));
    for (let i = 1; i < all.length; i++) {
      if (all[i].seen === 0 || all[i - 1].seen === 0) continue;   // invisible jumps are allowed
      expect(Math.abs(all[i].toMiddle - all[i - 1].toMiddle)).toBeLessThan(0.05);
      expect(Math.abs(all[i].away - all[i - 1].away)).toBeLessThan(0.05);
    }
    expect(all.at(-1)).toEqual({ pose: 'waits', toMiddle: 0, away: 0, seen: 1, empty: false });
  });
});

describe('the next drink', () => {
  it('has its glass at the program\'s place as soon as the hand is at a bottle', () => {
    const clock = new ServingClock();
    for (let i = 0; i < 360; i++) clock.look(true, false, TICK_S, false);
    expect(clock.look(false, false, TICK_S, false).away).toBeGreaterThan(0.9);
    expect(clock.look(false, true, TICK_S, false)).toMatchObject({ toMiddle: 0, away: 0, seen: 1 });
    expect(clock.look(false, false, TICK_S, false)).toMatchObject({ toMiddle: 0, away: 0, seen: 1 });
  });
});

describe('with reduced motion', () => {
  it('the glass fades and never slides while it is visible', () => {
    const clock = new ServingClock();
    const all = Array.from({ length: 9 * 60 }, (_, i) => clock.look(i < 6 * 60, false, TICK_S, true));
    for (let i = 1; i < all.length; i++) {
      expect(all[i].away).toBe(0);
      expect(Math.abs(all[i].seen - all[i - 1].seen)).toBeLessThan(0.1);
      expect(all[i].toMiddle).toBe(0);
      if (all[i].pose === 'drinks') expect(all[i].seen).toBeLessThan(0.01);   // the guest holds it
    }
    expect(all.map(({ pose }) => pose)).toEqual(expect.arrayContaining(['waits', 'drinks', 'thanks']));
  });
});
