// A slow machine makes room and hand between two pictures: then one additional picture is drawn.
import { describe, expect, it } from 'vitest';
import { RedrawTimer } from '../src/replay/redraw_needed';

describe('the redraw timer', () => {
  it('redraws until a change has settled', () => {
    const timer = new RedrawTimer();
    timer.isDue(0, true);
    timer.begin(10_000);
    expect(timer.isDue(10_100, true)).toBe(true);
    expect(timer.isDue(10_700, true)).toBe(false);
  });

  it('redraws while the hand is being made, however long', () => {
    const timer = new RedrawTimer();
    timer.begin(0);
    expect(timer.isDue(50_000, false)).toBe(true);
  });

  it('redraws once more when everything can be drawn, also if no picture came meanwhile', () => {
    const timer = new RedrawTimer();
    timer.begin(0);
    expect(timer.isDue(3_900, false)).toBe(true);
    expect(timer.isDue(20_000, true)).toBe(true);   // the page was blocked while the graphics card compiled its programs
    expect(timer.isDue(21_000, true)).toBe(false);
  });

  it('does so after each later change of the hand', () => {
    const timer = new RedrawTimer();
    timer.isDue(0, true);
    expect(timer.isDue(5_000, false)).toBe(true);
    expect(timer.isDue(9_000, true)).toBe(true);
  });
});
