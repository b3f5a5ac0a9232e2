// The size of text in a page that is zoomed, as the window is now.
import { browserZoom, isTouched } from '../shared/zoom';
import { zoomedTextOf } from './camera';

/** 1t of game.css; undefined: the page is not zoomed [px]. */
export function zoomedText_px(): number | undefined {
  return isTouched() ? undefined : zoomedTextOf(innerWidth, innerHeight, browserZoom());
}

/** Gives game.css the size; `data-zoomed` lets everything else give way. */
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
