// A slow machine makes room and hand between two pictures: then one picture more is drawn.
import { describe, expect, it } from 'vitest';
import { Settling } from '../src/replay/settling';

describe('Settling', () => {
  it('draws until a change has settled', () => {
    const settling = new Settling();
    settling.isDue(0, true);
    settling.begin(10_000);
    expect(settling.isDue(10_100, true)).toBe(true);
    expect(settling.isDue(10_700, true)).toBe(false);
  });

  it('draws while the hand is being made, however long', () => {
    const settling = new Settling();
    settling.begin(0);
    expect(settling.isDue(50_000, false)).toBe(true);
  });

  it('draws once more when all can be drawn, also where no picture came meanwhile', () => {
    const settling = new Settling();
    settling.begin(0);
    expect(settling.isDue(3_900, false)).toBe(true);
    expect(settling.isDue(20_000, true)).toBe(true);   // the page stood still while the card made its programs
    expect(settling.isDue(21_000, true)).toBe(false);
  });

  it('does so after each new making', () => {
    const settling = new Settling();
    settling.isDue(0, true);
    expect(settling.isDue(5_000, false)).toBe(true);
    expect(settling.isDue(9_000, true)).toBe(true);
  });
});
