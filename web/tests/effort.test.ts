// Praise is given only for measured facts.
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { EffortMeter, effortText, farthestStep, gripWord } from '../src/exercises/cocktail_bar/effort';
import { Memory } from '../src/game/memory';
import type { BarDrink } from '../src/exercises/cocktail_bar/bar';
import { ExerciseValues } from '../src/exercises/values';
import { Stars } from '../src/game/stars';
import type { WorldStateT } from '../src/protocol';

const NAMES = ['flow_l_s', 'engaged_dispenser', 'target_dispenser', 'squeeze_n', 'squeeze_low_n', 'squeeze_high_n'];
const values = new ExerciseValues(NAMES);
const state = (flow: number, engaged: number, squeeze_n: number) => ({ values: [flow, engaged, 1, squeeze_n, 1, 2] }) as unknown as WorldStateT;

/** Pours for this time at 60 states a second. */
function poured(long_s: number, squeeze: (t_s: number) => number, engaged = 1, flow = 0.01) {
  const meter = new EffortMeter();
  for (let i = 0; i <= 60 * long_s; i++) meter.look(values, state(flow, engaged, squeeze(i / 60)), i / 60);
  return meter.grip();
}

const step = (liquid: string, amount_l: number) => ({ liquid, amount_l, tolerance_l: 0.004 });
const one: BarDrink = { name: 'lemonade', steps: [step('lemon', 0.04)] };
const two: BarDrink = { name: 'blush', steps: [step('lemon', 0.04), step('cherry', 0.03)] };

describe('the grip', () => {
  it('that is constant is steady and just right', () => {
    expect(poured(5, () => 1.5)).toEqual({ steady: true, rightShare: 1 });
  });

  it('that swings is steady up to a quarter of its mean: the standard deviation of a sine is its amplitude over √2', () => {
    const swing = (share: number) => poured(10, (t_s) => 1.5 * (1 + share * Math.SQRT2 * Math.sin(2 * Math.PI * t_s)))?.steady;
    expect(swing(0.24)).toBe(true);
    expect(swing(0.26)).toBe(false);
  });

  it('is not mentioned after little pouring, from another bottle, or without flow', () => {
    expect(poured(0.5, () => 1.5)).toBeNull();
    expect(poured(5, () => 1.5, 0)).toBeNull();
    expect(poured(5, () => 1.5, 1, 0)).toBeNull();
  });

  it('is not praised if the page squeezed, or if it was neither steady nor right', () => {
    expect(gripWord({ steady: true, rightShare: 1 }, false)).toBe('');
    expect(gripWord({ steady: false, rightShare: 0.3 }, true)).toBe('');
    expect(gripWord({ steady: false, rightShare: 0.8 }, true)).toBe('right');
    expect(gripWord({ steady: true, rightShare: 0 }, true)).toBe('steady');
  });
});

describe('the text on the amounts', () => {
  it('names the step that is farthest off, in millilitres', () => {
    expect(farthestStep(two, [0.042, 0.024])).toEqual({ liquid: 'cherry', off_ml: -6 });
    expect(effortText(one, [0.046], 'steady')).toBe('6 ml too much, the grip was steady.');
    expect(effortText(two, [0.042, 0.024], '')).toBe('Cherry: 6 ml too little.');
    expect(effortText(two, [0.0404, 0.0296], 'right')).toBe('Filled to within 1 ml, the squeeze was mostly just right.');
  });
});

describe('stars', () => {
  const kept = new Map<string, string>();
  beforeEach(() => {
    kept.clear();
    vi.stubGlobal('localStorage', { getItem: (key: string) => kept.get(key) ?? null, setItem: (key: string, value: string) => kept.set(key, value) });
  });
  afterEach(() => { vi.unstubAllGlobals(); });

  const of = (visit: bigint, profile: string): Stars => {
    const stars = new Stars();
    stars.belongTo(visit, profile);
    return stars;
  };

  it('are stored for each patient, and counted from 0 in each visit', () => {
    of(0n, 'anna').add(3);
    of(0n, 'anna').add(2);
    of(7n, 'anna').add(1);
    expect([of(0n, 'anna'), of(0n, 'ben'), of(7n, 'anna'), of(7n, ''), of(8n, 'anna')].map(({ count }) => count)).toEqual([5, 0, 1, 1, 0]);
  });

  it('of a person without a profile do not go to the next one at the same page', () => {
    const stars = of(0n, '');
    stars.add(3);
    expect(stars.count).toBe(3);
    stars.begin();
    expect(stars.count).toBe(0);
  });

  it('of a drink count once, however often its praise is shown', () => {
    vi.stubGlobal('location', { search: '' });
    vi.stubGlobal('matchMedia', () => ({ matches: false }));
    const memory = new Memory();
    expect(memory.countStars(3)).toBe(3);
    expect(memory.countStars(3)).toBe(3);
  });

  it('that cannot be read count as none', () => {
    kept.set('wholehand.stars.anna', 'many');
    expect(of(0n, 'anna').count).toBe(0);
    expect(of(0n, 'anna').add(3)).toBe(3);
  });
});
