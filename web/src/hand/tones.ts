// Skin tones that the person can choose: warmer in the folds, lighter on the palm's side. One is a glove.

import type { SkinTone } from './skin_shader';

const TONE_NAMES = ['porcelain', 'honey', 'bronze', 'umber', 'glove'] as const;
export type ToneName = (typeof TONE_NAMES)[number];

export const TONES: Readonly<Record<ToneName, SkinTone>> = {
  porcelain: { base: '#EBC3A6', palm: '#F3CDB6', fold: '#C98468', nail: '#F6D9CC' },
  honey: { base: '#CF9F80', palm: '#E3BBA2', fold: '#9C5F45', nail: '#F0D3C2' },
  bronze: { base: '#A86C46', palm: '#CC9873', fold: '#7A4228', nail: '#DDB396' },
  umber: { base: '#6E4430', palm: '#B07F62', fold: '#482818', nail: '#C39A80' },
  glove: { base: '#DCE5E6', palm: '#EDF2F2', fold: '#93A9AC', nail: '#DCE5E6' },
};

/** A tone by its name; honey for an unknown name. */
export function toneOf(name: string): SkinTone {
  return TONES[name as ToneName] ?? TONES.honey;
}
