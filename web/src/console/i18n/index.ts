import { language, type Language } from '../../shared/i18n';
import { de } from './de';
import { en, type ConsoleTexts } from './en';
import { fr } from './fr';

const ALL: Readonly<Record<Language, ConsoleTexts>> = { en, de, fr };

/** The console's texts in the chosen language. */
export function texts(): ConsoleTexts {
  return ALL[language()];
}

export type { ConsoleTexts };
