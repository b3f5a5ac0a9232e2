// Texts of comparing two bottles, one on each line.
export const en = {
  'oneButton.press': 'press once: your hand squeezes both',
  'oneButton.point': 'a bottle: your answer',
  'more.answer': 'Press on it, or choose on the card',
};
export type PairTexts = Record<keyof typeof en, string>;
