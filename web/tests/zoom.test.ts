// Text of the game grows with the browser's zoom (WCAG 2.2, SC 1.4.4), on every screen.
import { expect, it } from 'vitest';
import { unitOf, zoomedTextOf } from '../src/scene/camera';

/** A window as large as the screen, in a browser that reports its zoom, or reports 1. */
const text_px = (width: number, height: number, zoom: number, reported = true): number => {
  const [w, h] = [width / zoom, height / zoom];
  return zoom * (zoomedTextOf(w, h, reported ? zoom : 1) ?? unitOf(w, h));
};

it.each([[1280, 720], [1366, 768], [1920, 1080], [2560, 1440], [1080, 1920]])('on a screen of %i × %i it follows the zoom up to a factor of two, and never decreases beyond', (width, height) => {
  for (const zoom of [1.1, 1.25, 1.5, 1.75, 2]) expect(text_px(width, height, zoom) / text_px(width, height, 1)).toBeCloseTo(zoom, 6);
  for (const zoom of [2.5, 3, 4, 5]) expect(text_px(width, height, zoom) / text_px(width, height, 1)).toBeGreaterThan(1.999);
});

it('is a factor of two on the smallest screen in a browser that does not report its zoom, too', () => {
  expect(text_px(1280, 720, 2, false) / text_px(1280, 720, 1, false)).toBeCloseTo(2, 6);
});

it.each([[1280, 720], [1280, 800], [1920, 1080], [1024, 640], [820, 1180]])('a window of %i × %i without zoom is unchanged, with borders or not', (width, height) => {
  for (const zoom of [1, 1.02]) expect(zoomedTextOf(width, height, zoom)).toBeUndefined();
});
