import { fill, language, type Language } from '../../../shared/i18n';
import { de } from './de';
import { en } from './en';
import { fr } from './fr';

export type KitchenTexts = Readonly<Record<keyof typeof en, string>>;

const ALL: Readonly<Record<Language, KitchenTexts>> = { en, de, fr };

export function text(key: keyof typeof en, values?: Readonly<Record<string, string | number>>): string {
  return fill(ALL[language()][key], values);
}
