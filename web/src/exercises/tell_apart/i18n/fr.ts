import type { PairTexts } from './en';

export const fr: PairTexts = {
  'oneButton.press': 'appuyez une fois : la main presse les deux',
  'oneButton.point': 'sur une bouteille : votre réponse',
  'more.answer': 'Appuyez dessus, ou choisissez sur la carte',
};
