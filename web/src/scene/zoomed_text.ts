// The text size of a zoomed page, for the present window.
import { browserZoom, isTouched } from '../shared/zoom';
import { zoomedTextOf } from './camera';

/** 1t of game.css; undefined: the page is not zoomed [px]. */
export function zoomedText_px(): number | undefined {
  return isTouched() ? undefined : zoomedTextOf(innerWidth, innerHeight, browserZoom());
}

/** Sets the text size for game.css; `data-zoomed` makes everything else shrink. */
export function growWithZoom({ style, dataset }: HTMLElement): void {
  const text_px = zoomedText_px();
  if (text_px === undefined) {
    style.removeProperty('--t');
    delete dataset.zoomed;
  } else {
    style.setProperty('--t', `${text_px.toFixed(4)}px`);
    dataset.zoomed = '';
  }
}
