import { language, type Language } from '../../shared/i18n';
import { de } from './de';
import { en, type CommissionTexts } from './en';
import { fr } from './fr';

const ALL: Readonly<Record<Language, CommissionTexts>> = { en, de, fr };

/** The texts of this page in the chosen language. */
export function texts(): CommissionTexts { return ALL[language()]; }
export type { CommissionTexts };
