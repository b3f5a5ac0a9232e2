import { svg } from '../console/dom';
import type { OneSide, Size } from './records';

/** Range of hand sizes that the records accept [m]. */
export const LENGTH_M = [0.15, 0.215] as const, BREADTH_M = [0.06, 0.11] as const;
export const MEDIAN: Size = { length_m: 0.188, breadth_m: 0.085 };

/** For each finger: the position of its base across the knuckles (−1 to 1, from the thumb's side), and its tip as a share of the hand's length. */
const FINGERS = [[-0.74, 0.93], [-0.25, 1], [0.25, 0.95], [0.74, 0.8]] as const;
const KNUCKLES = 0.54;

/** A hand seen from its back, to scale, with a ruler of 10 cm: 1 unit is 1 mm. */
export function handPicture(side: OneSide, { length_m, breadth_m }: Size, words: string): SVGElement {
  const [length, breadth] = [1000 * length_m, 1000 * breadth_m];
  const wide = 0.21 * breadth, half = breadth / 2, knuckles = KNUCKLES * length;
  // Seen from the back, the thumb of a right hand points to the left.
  const mirror = side === 'right' ? 1 : -1;
  const [palm, wrist] = [knuckles + 0.02 * length, 0.36 * breadth];
  const d = `M${-wrist} 0C${-half * 1.02} ${-palm * 0.35} ${-half} ${-palm * 0.7} ${-half} ${-palm}L${half} ${-palm * 0.93}C${half} ${-palm * 0.6} ${half * 0.95} ${-palm * 0.3} ${wrist} 0Z`;
  const finger = ([across, tip]: readonly [number, number]): SVGElement => svg('line', { x1: across * half * 0.95, y1: -knuckles * 0.98, x2: across * half * 1.12, y2: -(tip * length - wide / 2), 'stroke-width': wide.toFixed(1) });
  const thumb = svg('path', { d: `M${-half * 0.55} ${-palm * 0.3}Q${-half * 1.15} ${-palm * 0.55} ${-half * 1.6} ${-palm * 0.98}`, 'stroke-width': (wide * 1.15).toFixed(1) });
  const line = (points: string): SVGElement => svg('path', { class: 'measure', d: points });
  const y = -knuckles;
  return svg('svg', { class: 'hand-picture', viewBox: '-100 -222 200 236', role: 'img', 'aria-label': words },
    svg('g', { class: 'hand-shape', transform: `scale(${mirror} 1)` }, svg('path', { d }), thumb, ...FINGERS.map(finger)),
    line(`M${-half} ${y}H${half}M${-half} ${y - 4}V${y + 4}M${half} ${y - 4}V${y + 4}`), line(`M88 0V${-length}M84 0H92M84 ${-length}H92`),
    svg('path', { class: 'ruler', d: 'M-95 0V-100M-98 0H-92M-98 -100H-92M-97 -50H-93' }), svg('text', { x: -99, y: 11, 'text-anchor': 'start' }, '10 cm'),
    svg('text', { x: 99, y: 11, 'text-anchor': 'end' }, `${Math.round(length)} mm`), svg('text', { x: 0, y: y + 14, 'text-anchor': 'middle' }, `${Math.round(breadth)} mm`));
}
