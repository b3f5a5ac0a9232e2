import { language, type Language } from '../../shared/i18n';
import { de } from './de';
import { en, type ClinicTexts } from './en';
import { fr } from './fr';

const ALL: Readonly<Record<Language, ClinicTexts>> = { en, de, fr };

/** The texts of this page in the chosen language. */
export function texts(): ClinicTexts { return ALL[language()]; }
export type { ClinicTexts };
