import type { BarView } from './view';

/** Builds the small picture of the bar. Fails where there is no WebGL. */
export async function loadBarView(): Promise<BarView> {
  throw new Error('not there yet');
}
