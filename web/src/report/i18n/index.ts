import { language, type Language } from '../../shared/i18n';
import { de } from './de';
import { en, type ReportTexts } from './en';
import { fr } from './fr';

const ALL: Readonly<Record<Language, ReportTexts>> = { en, de, fr };

/** The texts of this page in the chosen language. */
export function texts(): ReportTexts { return ALL[language()]; }
export type { ReportTexts };
