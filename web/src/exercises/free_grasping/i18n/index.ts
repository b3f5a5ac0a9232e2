import { fill, language, type Language } from '../../../shared/i18n';
import { de } from './de';
import { en, type GraspTexts } from './en';
import { fr } from './fr';

const ALL: Readonly<Record<Language, GraspTexts>> = { en, de, fr };

export function text(key: keyof typeof en, values?: Readonly<Record<string, string | number>>): string {
  return fill(ALL[language()][key], values);
}
