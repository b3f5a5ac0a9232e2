// How much larger than the size of the window asks for text is: it follows the browser's zoom (WCAG 2.2, SC 1.4.4).
//
// Sizes of the game follow the window. A page that is zoomed has a smaller window, in which text would stay as it was.

/** 1t of game.css on the smallest screen that it is made for, 1280 × 720 [px]. */
const SMALLEST_SCREEN_PX = 0.9;
/** No screen with a mouse is so small: the page is zoomed, though the browser does not say so. */
const ZOOMED_BELOW_PX = 0.65;
/** Borders of the window are no zoom. */
const LEAST = 1.05;
/** Text that is twice as large as without zoom grows no more: something must have room beside it. */
const MOST = 2;

/** @param scale_px 1u of game.css by the window; `zoom`: what the browser says of it */
export function textZoom(scale_px: number, zoom: number, upright: boolean): number {
  const unsaid = !upright && scale_px < ZOOMED_BELOW_PX ? SMALLEST_SCREEN_PX / scale_px : 1;
  const grown = Math.min(MOST, Math.max(zoom, unsaid));
  return grown < LEAST ? 1 : grown;
}

/** What the browser says: a zoomed page has fewer px than its window. A docked tool takes room, too, but leaves the pixels as they are. */
export function browserZoom(): number {
  return Math.min(outerWidth / Math.max(1, innerWidth), devicePixelRatio);
}

/** Who touches the screen zooms with two fingers, which moves nothing. */
export const isTouched = (): boolean => matchMedia('(pointer: coarse)').matches;
