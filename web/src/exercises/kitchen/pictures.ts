// Drawings for the task card and the welcome card: one sign for each verb.
import { drawing } from '../../shared/dom';
import type { Verb } from './task';

const INK = '#2A1C14';
const line = (d: string, wide = 7): string => `<path d="${d}" fill="none" stroke="${INK}" stroke-width="${wide}" stroke-linecap="round" stroke-linejoin="round"/>`;
const bar = (x: number): string => `<rect x="${x - 7}" y="20" width="14" height="60" rx="7" fill="#B9C0C4" stroke="${INK}" stroke-width="4"/>`;

/** Strokes of a hand on a disc of 100 by 100. */
export const HANDS = {
  open: [['M37 54L33 26', 10], ['M47 50L46 18', 10], ['M57 50L60 20', 10], ['M66 55L74 30', 10], ['M38 70L21 56', 11], ['M44 66L60 66L57 76L47 76Z', 20]],
  closed: [['M38 36H60', 11], ['M37 49H62', 11], ['M38 62H60', 11], ['M66 40V62', 16], ['M62 74L46 72', 11]],
} as const;
export const SKIN = '#E7B58E';

/** Two passes: the outline, and the drawing itself. */
export const PASSES = [[INK, 7], [SKIN, 0]] as const;

const hand = (kind: keyof typeof HANDS): string => PASSES.map(([color, more]) =>
  `<g stroke="${color}" fill="none" stroke-linecap="round" stroke-linejoin="round">${HANDS[kind].map(([d, wide]) => `<path d="${d}" stroke-width="${wide + more}"/>`).join('')}</g>`).join('');

const SIGNS: Readonly<Record<Verb, string>> = {
  reach: `${bar(70)}${line('M18 50H50M40 38L52 50 40 62')}`,
  take: `${bar(50)}${hand('closed')}`,
  move: `<circle cx="24" cy="50" r="9" fill="#FFB938" stroke="${INK}" stroke-width="4"/>${line('M36 50H80M68 37L81 50 68 63', 9)}`,
  hold: `<circle cx="50" cy="50" r="30" fill="none" stroke="${INK}" stroke-width="12"/><circle cx="50" cy="50" r="30" fill="none" stroke="#FFB938" stroke-width="6"/>${line('M50 34V50L60 58', 6)}`,
  press: `${line('M50 16V56M38 46L50 58 62 46', 9)}<rect x="24" y="68" width="52" height="13" rx="5" fill="#FFB938" stroke="${INK}" stroke-width="4"/>`,
  put: `${line('M22 80H78', 7)}<rect x="35" y="46" width="30" height="28" rx="5" fill="#FFB938" stroke="${INK}" stroke-width="4"/>${line('M50 12V34M41 26L50 36 59 26', 7)}`,
  let_go: hand('open'),
};

/** A disc with the verb's sign. */
export function verbDisc(verb: Verb): SVGElement {
  return drawing(`<svg class="swatch" viewBox="0 0 100 100" aria-hidden="true"><circle cx="50" cy="50" r="47" fill="#FFF6E6" stroke="${INK}" stroke-width="4"/>${SIGNS[verb]}</svg>`);
}

const front = (x: number): string => `<rect x="${x}" y="26" width="16" height="84" rx="5" fill="#C99A66" stroke="${INK}" stroke-width="4"/><path d="M${x + 16} 56h22M${x + 16} 92h22" stroke="${INK}" stroke-width="8"/><rect x="${x + 36}" y="44" width="14" height="60" rx="7" fill="#B9C0C4" stroke="${INK}" stroke-width="4"/>`;

function arm(skin: string, x: number, closed: boolean): string {
  const fingers = closed ? `M${x - 26} 60h24M${x - 27} 75h26M${x - 26} 90h24` : `M${x - 52} 50L${x - 4} 58M${x - 58} 70H${x}M${x - 50} 92L${x} 84`;
  return [[INK, 7], [skin, 0]].map(([color, more]) => `<g stroke="${color}" stroke-linecap="round" fill="none"><path d="${fingers}" stroke-width="${13 + Number(more)}"/><path d="M${x + 10} 68v14" stroke-width="${40 + Number(more)}"/></g>`).join('')
    + `<path d="M${x + 26} 78L${x + 74} 90" stroke="${INK}" stroke-width="40"/><path d="M${x + 28} 78L${x + 76} 90" stroke="#3A4A57" stroke-width="32"/>`;
}

const plate = (x: number, tilt: number): string => `<g transform="rotate(${tilt} ${x + 10} 68)"><rect x="${x}" y="34" width="20" height="68" rx="6" fill="#FFF6E6" stroke="${INK}" stroke-width="4"/></g><rect x="${x - 14}" y="18" width="10" height="100" rx="4" fill="#C99A66" stroke="${INK}" stroke-width="4"/>`;

/** The steps reach, push and draw back at a thing that the hand does not close around. */
function pushPicture(step: 1 | 2 | 3, skin: string): string {
  const arrow = (d: string): string => `${[[INK, 14], ['#FFB938', 7]].map(([color, wide]) => `<path d="${d}" fill="none" stroke="${color}" stroke-width="${wide}" stroke-linecap="round" stroke-linejoin="round"/>`).join('')}`;
  const ring = [[INK, 10], ['#FFB938', 5]].map(([color, wide]) => `<circle cx="72" cy="52" r="22" fill="none" stroke="${color}" stroke-width="${wide}"/>`).join('');
  return step === 1 ? `${plate(52, 10)}${ring}${arm(skin, 168, false)}` : step === 2 ? `${plate(52, -10)}${arrow('M132 16H76M92 5L74 16 92 27')}${arm(skin, 134, false)}` : `${plate(52, -10)}${arrow('M100 16H154M138 5L156 16 138 27')}${arm(skin, 178, false)}`;
}

/** The steps take hold, move and let go; the hand has the chosen skin tone. */
/** @param pushed the hand stays open, and pushes a plate without a handle */
export function stepPicture(step: 1 | 2 | 3, skin: string, pushed = false): SVGElement {
  if (pushed) return drawing(`<svg viewBox="0 0 260 132" aria-hidden="true">${pushPicture(step, skin)}</svg>`);
  const arrow = `<path d="M70 14H142M124 3L144 14 124 25" fill="none" stroke="${INK}" stroke-width="14" stroke-linecap="round" stroke-linejoin="round"/><path d="M70 14H142M124 3L144 14 124 25" fill="none" stroke="#FFB938" stroke-width="7" stroke-linecap="round" stroke-linejoin="round"/>`;
  const content = {
    1: `${front(36)}<circle cx="79" cy="74" r="46" fill="none" stroke="${INK}" stroke-width="10"/><circle cx="79" cy="74" r="46" fill="none" stroke="#FFB938" stroke-width="5"/>${arm(skin, 168, false)}`,
    2: `<g opacity="0.3">${front(36)}</g>${front(96)}${arrow}${arm(skin, 152, true)}`,
    3: `${front(36)}${arm(skin, 178, false)}`,
  }[step];
  return drawing(`<svg viewBox="0 0 260 132" aria-hidden="true">${content}</svg>`);
}
