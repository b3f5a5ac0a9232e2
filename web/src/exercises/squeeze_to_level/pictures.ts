// Drawings for the task card and the welcome card.
import { drawing } from '../../shared/dom';

const INK = '#2A1C14';

/** A disc with a balloon at its height over the hills. @param of number of heights */
export function heightDisc(height: number, of: number): SVGElement {
  const y = 66 - 34 * (of > 1 ? height / (of - 1) : 0);
  return drawing(`<svg class="swatch" viewBox="0 0 100 100" aria-hidden="true"><defs><clipPath id="height-${height}"><circle cx="50" cy="50" r="47"/></clipPath></defs>
    <g clip-path="url(#height-${height})"><rect width="100" height="100" fill="#BFDDE8"/><path d="M-4 92l30-26 22 16 24-22 34 30v20H-4z" fill="#4E7F6C"/>
    <path d="M10 ${y + 16}h80M10 ${y - 16}h80" stroke="${INK}" stroke-width="7"/><path d="M10 ${y + 16}h80M10 ${y - 16}h80" stroke="#fff" stroke-width="3.500"/>
    <circle cx="50" cy="${y - 2}" r="12" fill="#C8452F" stroke="${INK}" stroke-width="3"/><path d="M46 ${y + 12}h8v7h-8z" fill="${INK}"/></g>
    <circle cx="50" cy="50" r="47" fill="none" stroke="${INK}" stroke-width="4"/></svg>`);
}

const handle = (x: number): string => `<path d="M${x + 16} 0v22" stroke="#9A7A44" stroke-width="8"/><rect x="${x}" y="16" width="32" height="100" rx="13" fill="#3B6FD1" stroke="${INK}" stroke-width="4"/><path d="M${x + 3} 40h26M${x + 3} 58h26M${x + 3} 76h26M${x + 3} 94h26" stroke="#A9C6FF" stroke-width="4"/>`;

const balloon = (x: number, y: number, r: number): string => `<path d="M${x - r} ${y}a${r} ${r} 0 0 1 ${2 * r} 0q0 ${0.7 * r}-${0.7 * r} ${1.3 * r}h-${0.6 * r}q-${0.7 * r}-${0.6 * r}-${0.7 * r}-${1.3 * r}z" fill="#C8452F" stroke="${INK}" stroke-width="4"/><path d="M${x - 0.35 * r} ${y + 1.3 * r}Q${x - 0.7 * r} ${y} ${x} ${y - r}q${0.7 * r} ${r} ${0.35 * r} ${2.3 * r}z" fill="#FFE3A3"/><rect x="${x - 0.28 * r}" y="${y + 1.55 * r}" width="${0.56 * r}" height="${0.45 * r}" rx="3" fill="#765443" stroke="${INK}" stroke-width="3"/>`;

const ribbon = (y: number): string => `<path d="M20 ${y}h220" stroke="${INK}" stroke-width="10" stroke-linecap="round"/><path d="M20 ${y}h220" stroke="#fff" stroke-width="4.500" stroke-linecap="round"/>`;

const fingers = (skin: string): string => [[INK, 7], [skin, 0]].map(([color, more]) => `<g stroke="${color}" stroke-linecap="round" fill="none"><path d="M112 46h22M110 62h24M112 78h22" stroke-width="${13 + Number(more)}"/><path d="M190 74L160 50 122 40" stroke-width="${17 + Number(more)}"/><path d="M172 66L192 80" stroke-width="${34 + Number(more)}"/></g>`).join('')
  + `<path d="M204 84L258 112" stroke="${INK}" stroke-width="44"/><path d="M206 85L260 113" stroke="#3A4A57" stroke-width="36"/>`;

/** The steps take hold, squeeze and hold; the hand has the chosen skin tone. */
export function stepPicture(step: 1 | 2 | 3, skin: string): SVGElement {
  const content = {
    1: `${handle(114)}${fingers(skin)}`,
    2: `${ribbon(30)}${ribbon(84)}${balloon(130, 92, 22)}<path d="M196 76V46m-13 12l13-13 13 13" fill="none" stroke="${INK}" stroke-width="6" stroke-linecap="round" stroke-linejoin="round"/>`,
    3: `<path d="M20 30h220v66H20z" fill="#FFE3A3"/>${ribbon(30)}${ribbon(96)}${balloon(130, 54, 19)}`,
  }[step];
  return drawing(`<svg viewBox="0 0 260 132" aria-hidden="true">${content}</svg>`);
}
