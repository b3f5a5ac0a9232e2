import { language } from './i18n';

/** Writes a number's text as the page's language does: English has a decimal point, German and French a comma. */
const inWriting = (text: string): string => (language() === 'en' ? text : text.replace('.', ',')).replace('-', '−');

/** Formats a number with a true minus sign, no minus zero, and fixed decimals. */
export function fixed(value: number, decimals: number): string {
  if (!Number.isFinite(value)) return '–';
  return inWriting(value.toFixed(decimals).replace(/^-(0(\.0*)?)$/, '$1'));
}

/** Formats a number with at most so many significant digits and no superfluous zeros. */
export const significant = (value: number, digits = 6): string => (Number.isFinite(value) ? inWriting(String(Number(value.toPrecision(digits)))) : '–');

const UNITS: Readonly<Record<string, string>> = { n: 'N', nm: 'N·m', m: 'm', s: 's', rad: 'rad', l: 'l', l_s: 'l/s', m_s: 'm/s', ml_s: 'ml/s', hz: 'Hz' };

/** A value's own name as words, with the unit that it ends in: squeeze_low_n becomes "Squeeze low, N". */
export function quantityWords(name: string): string {
  const [, stem, unit] = /^(.+?)_(l_s|m_s|ml_s|nm|rad|hz|n|m|s|l)(?=$|\/)/.exec(name) ?? [];
  if (stem === undefined) return asWords(name);
  return `${asWords(stem + name.slice(stem.length + 1 + unit!.length).replace('/', ' '))}, ${UNITS[unit!]}`;
}

/** Groups digits with thin spaces: 251840 becomes 251 840 in every language. */
export function grouped(value: number | bigint): string {
  return String(value).replace(/\B(?=(\d{3})+(?!\d))/g, '\u202f');
}

/** Formats a duration: 161 s as 2:41, over an hour as 1:02:41. */
export function duration(seconds: number): string {
  const whole = Math.max(0, Math.floor(seconds));
  const two = (n: number): string => String(n).padStart(2, '0');
  const hours = Math.floor(whole / 3600);
  const minutes = Math.floor(whole / 60) % 60;
  return hours > 0 ? `${hours}:${two(minutes)}:${two(whole % 60)}` : `${minutes}:${two(whole % 60)}`;
}

export function bytes(count: number): string {
  if (count < 1e3) return `${count} B`;
  if (count < 1e6) return `${Math.round(count / 1e3)} kB`;
  if (count < 1e9) return `${fixed(count / 1e6, count < 1e7 ? 1 : 0)} MB`;
  return `${fixed(count / 1e9, 1)} GB`;
}

/** Turns a name of the program, "adult-median-right" or "wall_ratio", into words. */
export function asWords(name: string): string {
  const words = name.replace(/[-_]+/g, ' ').trim();
  return words.charAt(0).toUpperCase() + words.slice(1);
}
