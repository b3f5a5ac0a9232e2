import { language, type Language } from '../../shared/i18n';
import { de } from './de';
import { en, type ReplayTexts } from './en';
import { fr } from './fr';

const ALL: Readonly<Record<Language, ReplayTexts>> = { en, de, fr };

/** The texts of this page in the chosen language. */
export function texts(): ReplayTexts { return ALL[language()]; }
export type { ReplayTexts };
