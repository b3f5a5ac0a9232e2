// Appearances of the guests. Skin has the hand's tones, cloth is as plain as its sleeve.

export type Hair = 'short' | 'bun' | 'curls' | 'bald' | 'long' | 'bob';
export type Collar = 'shirt' | 'crew' | 'scarf';

export interface Look {
  readonly skin: string;
  readonly hair: Hair; readonly hairColor: string;
  readonly cloth: string; readonly collar: Collar; readonly trim: string;
  readonly glasses?: boolean; readonly moustache?: boolean; readonly beard?: boolean; readonly lips?: string;
  /** Breadth of the shoulders, and length of the face, relative to the median. */
  readonly broad: number; readonly face: number;
}

/** Guests are used in turn, one for every drink. */
export const GUESTS: readonly Look[] = [
  { skin: '#E0AE8A', hair: 'bun', hairColor: '#B9B2A8', cloth: '#A8503C', collar: 'scarf', trim: '#E9D9B8', glasses: true, lips: '#B5604F', broad: 0.92, face: 0.97 },
  { skin: '#8A5638', hair: 'short', hairColor: '#2B211C', cloth: '#C9A25A', collar: 'shirt', trim: '#EFE7D8', beard: true, broad: 1.06, face: 1.03 },
  { skin: '#EBC3A6', hair: 'bald', hairColor: '#CFC8BD', cloth: '#54708C', collar: 'shirt', trim: '#EFE7D8', moustache: true, broad: 1.08, face: 1 },
  { skin: '#6E4430', hair: 'curls', hairColor: '#241913', cloth: '#8A5A86', collar: 'crew', trim: '#6C4469', lips: '#8A3F3A', broad: 0.94, face: 0.98 },
  { skin: '#CF9F80', hair: 'bob', hairColor: '#4A2A1A', cloth: '#4F7F6C', collar: 'crew', trim: '#EFE7D8', lips: '#B0564C', broad: 0.93, face: 0.97 },
  { skin: '#DDB08C', hair: 'long', hairColor: '#8A4B22', cloth: '#D8C5A0', collar: 'scarf', trim: '#54708C', glasses: true, lips: '#BB6656', broad: 0.95, face: 1 },
];

/** @param guest number of the guest, one for every drink */
export const lookOf = (guest: number): Look => GUESTS[((guest % GUESTS.length) + GUESTS.length) % GUESTS.length];
