import { language, type Language } from '../../../shared/i18n';
import { de } from './de';
import { en, type PairTexts } from './en';
import { fr } from './fr';

const ALL: Readonly<Record<Language, PairTexts>> = { en, de, fr };

export const text = (key: keyof PairTexts): string => ALL[language()][key];
