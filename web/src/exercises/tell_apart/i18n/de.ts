import type { PairTexts } from './en';

export const de: PairTexts = {
  'oneButton.press': 'einmal drücken: Ihre Hand drückt beide',
  'oneButton.point': 'auf eine Flasche: Ihre Antwort',
  'more.answer': 'Auf sie drücken oder auf der Karte wählen',
};
