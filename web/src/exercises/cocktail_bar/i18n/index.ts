import { fill, language, type Language } from '../../../shared/i18n';
import { de } from './de';
import { en, type BarTextKey, type BarTexts } from './en';
import { fr } from './fr';
export type { BarTextKey } from './en';

const ALL: Readonly<Record<Language, BarTexts>> = { en, de, fr };

/** A text of the bar in the chosen language. */
export function text(key: BarTextKey, values?: Readonly<Record<string, string | number>>): string {
  return fill(ALL[language()][key], values);
}

/** A text that may be missing; undefined then. */
export function textOf(key: string): string | undefined {
  return key in en ? text(key as BarTextKey) : undefined;
}

/** The name of a liquid or drink of a file; an unknown one is returned with a capital. */
export function nameOf(kind: 'liquid' | 'drink', name: string): string {
  return textOf(`${kind}.${name}`) ?? name.charAt(0).toUpperCase() + name.slice(1).replace(/[-_]/g, ' ');
}

/** A liquid inside a sentence, "le citron"; an unknown one by its name. */
export function inSentence(liquid: string): string {
  return textOf(`inSentence.${liquid}`) ?? nameOf('liquid', liquid);
}
