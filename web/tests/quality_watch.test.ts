import { expect, it } from 'vitest';
import { QualityWatch } from '../src/game/picture';
import type { Quality } from '../src/scene/quality';

/** Quality after some seconds at a frame period. */
function after(watch: QualityWatch, seconds: number, frame_ms: number, plays: boolean, from_ms = 0): Quality {
  const picture = { stats: () => ({ frame_ms, script_ms: 1, triangles: 0 }), setQuality: () => {} };
  for (let t = from_ms; t <= from_ms + 1000 * seconds; t += frame_ms) watch.look(picture, t, plays);
  return watch.now;
}

it('slow pictures lower the quality within 3 s, also one that the address asks for where the page plays', () => {
  for (const frame_ms of [60, 200, 700]) {
    expect(after(new QualityWatch('high', false), 3, frame_ms, false)).toBe('low');
    expect(after(new QualityWatch('high', true), 3, frame_ms, true)).toBe('low');
  }
});

it('an asked quality holds while the page only shows, and fast pictures keep theirs', () => {
  const shows = new QualityWatch('high', true);
  expect(after(shows, 60, 700, false)).toBe('high');
  expect(after(shows, 3, 700, true, 60_000)).toBe('low');
  expect(after(new QualityWatch('high', true), 60, 30, true)).toBe('high');
});
