// Drawings of the bar: the disc of a liquid, and the three steps of the welcome card.
import { drawing } from '../../shared/dom';
import { liquidLook, type LiquidLook, type LiquidPattern, type LiquidSymbol } from './liquids';

const SYMBOLS: Readonly<Record<LiquidSymbol, string>> = {
  triangle: '<path d="M20 3L37.500 35h-35z"/>',
  circle: '<circle cx="20" cy="20" r="16"/>',
  square: '<path d="M5 5h30v30H5z"/>',
  diamond: '<path d="M20 1l17 19-17 19L3 20z"/>',
};

const PATTERNS: Readonly<Record<LiquidPattern, string>> = {
  stripes: '<path d="M-20 40L40-20M0 60L60 0M20 80L80 20M-40 20L20-40M40 100L100 40M10 90L90 10" stroke-width="7"/>',
  dots: '<g stroke="none"><circle cx="12" cy="12" r="7"/><circle cx="48" cy="10" r="7"/><circle cx="84" cy="14" r="7"/><circle cx="8" cy="50" r="7"/><circle cx="92" cy="50" r="7"/><circle cx="14" cy="86" r="7"/><circle cx="50" cy="92" r="7"/><circle cx="86" cy="86" r="7"/></g>',
  waves: '<path d="M-5 14q13-14 27 0t27 0 27 0 27 0M-5 50q13-14 27 0t27 0 27 0 27 0M-5 86q13-14 27 0t27 0 27 0 27 0" stroke-width="6"/>',
  rings: '<path d="M0 8h100M0 29h100M0 50h100M0 71h100M0 92h100" stroke-width="5"/>',
};

const onDark = (look: LiquidLook): boolean => look.pattern === 'dots' || look.pattern === 'waves';

let swatches = 0;

/** A disc with colour, pattern and symbol, for the recipe. */
export function swatch(liquid: string): SVGElement {
  const look = liquidLook(liquid);
  const clip = `disc-${++swatches}`;
  return drawing(`<svg class="swatch" viewBox="0 0 100 100" aria-hidden="true"><defs><clipPath id="${clip}"><circle cx="50" cy="50" r="47"/></clipPath></defs>
    <g clip-path="url(#${clip})"><rect width="100" height="100" fill="${look.color}"/><g fill="${look.ink}" stroke="${look.ink}">${PATTERNS[look.pattern]}</g><circle cx="50" cy="50" r="31" fill="${look.color}"/></g>
    <circle cx="50" cy="50" r="47" fill="none" stroke="#2A1C14" stroke-width="4"/>
    <g transform="translate(33 33) scale(.85)" fill="${onDark(look) ? '#fff' : '#2A1C14'}">${SYMBOLS[look.symbol]}</g></svg>`);
}

const INK = '#2A1C14';

const bottle = (x: number): string => `<g transform="translate(${x} 6)"><rect width="46" height="14" rx="4" fill="#9A7A44"/><path d="M2 14h42v66q0 10-9 12l-3 4H14l-3-4Q2 90 2 80z" fill="#F6C636" stroke="${INK}" stroke-width="4"/><path d="M12 20v58M24 20v60M35 20v58" stroke="#8A6100" stroke-width="4" transform="skewX(-14) translate(12 0)"/><path d="M17 97h12l-4 16h-4z" fill="${INK}"/></g>`;

/** Draws every stroke twice, wide in ink and narrower in the skin's colour: this gives an outline. */
const outlined = (skin: string, width: number, paths: (width: number) => string): string =>
  [[INK, width + 7], [skin, width]].map(([color, w]) => `<g stroke="${color}" stroke-width="${w}" stroke-linecap="round" fill="none">${paths(Number(w))}</g>`).join('');

const sleeve = (from: string, inner: string, to: string): string => `<path d="M${from}L${to}" stroke="${INK}" stroke-width="44"/><path d="M${inner}L${to}" stroke="#3A4A57" stroke-width="36"/>`;

/** The steps reach, squeeze and fill; the hand has the chosen skin tone. */
export function stepPicture(step: 0 | 1 | 2, skin: string): SVGElement {
  const open = outlined(skin, 15, (w) => `<path d="M62 44L36 28 10 22M64 54L34 48 8 44M66 64L36 66 12 66M70 74L44 82 24 86"/><path d="M64 52L86 66" stroke-width="${w + 24}"/><path d="M86 66L132 92" stroke-width="${w + 10}"/>`);
  const closed = outlined(skin, 13, () => '<path d="M50 52h4M48 70h5M52 88h3"/>') +
    outlined(skin, 17, (w) => `<path d="M124 66L98 46 58 42"/><path d="M112 62L130 76" stroke-width="${w + 22}"/>`);
  const content = [
    `${bottle(34)}<g transform="translate(112 6)">${open}${sleeve('112 81', '115 83', '150 102')}</g><path d="M104 112H84m9-9l-10 9 10 9" fill="none" stroke="${INK}" stroke-width="6" stroke-linecap="round" stroke-linejoin="round"/>`,
    `<g transform="translate(30 0)">${bottle(54)}${closed}${sleeve('142 80', '145 81.500', '200 108')}</g>`,
    `<path d="M126 0h8v50h-8z" fill="#F6C636"/><path d="M96 22l7 104h54l7-104" fill="#fff" fill-opacity=".55"/><path d="M98.600 62l4.400 64h54l4.400-64z" fill="#F6C636"/><path d="M103 84h54M105 106h50" stroke="#8A6100" stroke-width="4" opacity=".55"/><path d="M96 22l7 104h54l7-104" fill="none" stroke="${INK}" stroke-width="5" stroke-linejoin="round" stroke-linecap="round"/><path d="M84 54h92" stroke="${INK}" stroke-width="10" stroke-linecap="round"/><path d="M84 54h92" stroke="#fff" stroke-width="4" stroke-linecap="round"/><path d="M210 54h-20m8-8l-9 8 9 8" fill="none" stroke="${INK}" stroke-width="6" stroke-linecap="round" stroke-linejoin="round"/>`,
  ][step];
  return drawing(`<svg viewBox="0 0 260 132" aria-hidden="true">${content}</svg>`);
}
