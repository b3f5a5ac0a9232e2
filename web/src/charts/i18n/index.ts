import { language, type Language } from '../../shared/i18n';
import { de } from './de';
import { en, type ChartTexts } from './en';
import { fr } from './fr';

const ALL: Readonly<Record<Language, ChartTexts>> = { en, de, fr };

/** The texts of this page in the chosen language. */
export function texts(): ChartTexts { return ALL[language()]; }
export type { ChartTexts };
