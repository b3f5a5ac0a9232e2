// Drawings for the task card and the welcome card.
import { drawing } from '../../shared/dom';
import type { ThingKind } from './things';

const INK = '#2A1C14';

/** Pictures of the objects, about 60 wide, in the middle of 100 by 100. */
const SHAPES: Readonly<Record<ThingKind, string>> = {
  cube: '<path d="M50 20l27 14v32L50 80 23 66V34z"/><path d="M23 34l27 14 27-14M50 48v32" fill="none"/>',
  cylinder: '<path d="M32 28v44q18 12 36 0V28"/><ellipse cx="50" cy="28" rx="18" ry="8"/><path d="M32 44q18 12 36 0M32 58q18 12 36 0" fill="none"/>',
  sphere: '<circle cx="50" cy="50" r="28"/><path d="M23 43q27 16 54 0M23 57q27 16 54 0" fill="none"/>',
  disk: '<path d="M18 46v12q32 28 64 0V46"/><ellipse cx="50" cy="46" rx="32" ry="16"/><ellipse cx="50" cy="46" rx="16" ry="8" fill="none"/>',
};

/** A disc with the object before a night sky. */
export function thingDisc(kind: ThingKind, color: string): SVGElement {
  return drawing(`<svg class="swatch" viewBox="0 0 100 100" aria-hidden="true"><circle cx="50" cy="50" r="47" fill="#FFF6E6" stroke="${INK}" stroke-width="4"/>
    <g fill="${color}" stroke="${INK}" stroke-width="4" stroke-linejoin="round">${SHAPES[kind]}</g></svg>`);
}

const thing = (kind: ThingKind, color: string, x: number, y: number, size: number): string =>
  `<g transform="translate(${x - 50 * size} ${y - 50 * size}) scale(${size})" fill="${color}" stroke="${INK}" stroke-width="${4 / size}" stroke-linejoin="round">${SHAPES[kind]}</g>`;

const star = (x: number, y: number, r: number, fill: string): string => {
  const points = Array.from({ length: 8 }, (_, i) => { const a = i * Math.PI / 4, d = i % 2 ? 0.36 * r : r; return `${(x + d * Math.sin(a)).toFixed(1)} ${(y - d * Math.cos(a)).toFixed(1)}`; });
  return `<path d="M${points.join('L')}z" fill="${fill}" stroke="${INK}" stroke-width="4" stroke-linejoin="round"/>`;
};

function hand(skin: string, closed: boolean): string {
  const fingers = closed ? 'M148 34L126 40M146 52L120 56M146 70L122 74M156 88L132 92' : 'M150 40L112 18M150 52L104 42M150 66L104 68M156 82L120 100';
  return [[INK, 7], [skin, 0]].map(([color, more]) => `<g stroke="${color}" stroke-linecap="round" fill="none"><path d="${fingers}" stroke-width="${14 + Number(more)}"/><path d="M164 54L178 68" stroke-width="${42 + Number(more)}"/></g>`).join('')
    + `<path d="M196 78L252 106" stroke="${INK}" stroke-width="44"/><path d="M198 79L254 107" stroke="#3A4A57" stroke-width="36"/>`;
}

/** The steps reach, hold and star; the hand has the chosen skin tone. */
export function stepPicture(step: 1 | 2 | 3, skin: string): SVGElement {
  const content = {
    1: `${thing('sphere', '#A31D38', 62, 58, 0.9)}${thing('cube', '#3B6FD1', 24, 104, 0.55)}${thing('disk', '#0B6B58', 34, 20, 0.6)}${hand(skin, false)}`,
    2: `${thing('sphere', '#A31D38', 108, 58, 1.25)}${hand(skin, true)}`,
    3: `<path d="M54 92L104 40 158 74 212 30" fill="none" stroke="${INK}" stroke-width="4" stroke-dasharray="2 10" stroke-linecap="round"/>${star(54, 92, 20, '#FFD15C')}${star(104, 40, 24, '#FFD15C')}${star(158, 74, 20, '#FFD15C')}${star(212, 30, 24, '#FFF')}`,
  }[step];
  return drawing(`<svg viewBox="0 0 260 132" aria-hidden="true">${content}</svg>`);
}
