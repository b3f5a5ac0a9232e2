// The stars that a person has won. The browser stores them for each patient's profile, or for all players together without a profile.
import { store, stored } from '../shared/i18n';

const STORED = 'wholehand.stars';
const key = (profile: string): string => (profile === '' ? STORED : `${STORED}.${profile}`);

/** A stored value that is not a count is read as 0. */
export function starsOf(profile: string): number {
  const count = Number(stored(key(profile)) ?? 0);
  return Number.isInteger(count) && count > 0 ? count : 0;
}

export function addStars(profile: string, won: number): number {
  const count = starsOf(profile) + Math.max(0, Math.round(won));
  store(key(profile), String(count));
  return count;
}
