// Additional text scale that follows the browser's zoom (WCAG 2.2, SC 1.4.4).
//
// Sizes of the game follow the window. A zoomed page has a smaller window, so text would not grow without this.

/** 1t of game.css on the smallest supported screen, 1280 × 720 [px]. */
const SMALLEST_SCREEN_PX = 0.9;
/** A scale below this means zoom even if the browser does not report it: no screen with a mouse is so small. */
const ZOOMED_BELOW_PX = 0.65;
/** A ratio below this comes from the borders of the window. */
const LEAST = 1.05;
/** Text grows at most to twice its size: other content needs room beside it. */
const MOST = 2;

/** @param scale_px 1u of game.css by the window @param zoom the zoom that the browser reports */
export function textZoom(scale_px: number, zoom: number, upright: boolean): number {
  const unsaid = !upright && scale_px < ZOOMED_BELOW_PX ? SMALLEST_SCREEN_PX / scale_px : 1;
  const grown = Math.min(MOST, Math.max(zoom, unsaid));
  return grown < LEAST ? 1 : grown;
}

/** The zoom that the browser reports: a zoomed page has fewer px than its window. A docked tool also takes room, but changes no pixel size. */
export function browserZoom(): number {
  return Math.min(outerWidth / Math.max(1, innerWidth), devicePixelRatio);
}

/** Whether the screen is touched: a zoom by two fingers does not change the layout. */
export const isTouched = (): boolean => matchMedia('(pointer: coarse)').matches;
