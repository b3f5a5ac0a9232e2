// The texts of all pages in three languages, one file each.
import { de } from './de';
import { en, type TextKey, type Texts } from './en';
import { fr } from './fr';
export type { TextKey, Texts } from './en';

export type Language = 'en' | 'de' | 'fr';

export const LANGUAGES: readonly Language[] = ['de', 'fr', 'en'];
const ALL: Readonly<Record<Language, Texts>> = { en, de, fr };
const STORED = 'wholehand.language';

/** The first wish that is an available language: "de-CH" gives "de"; English if none is. */
export function chooseLanguage(wishes: readonly (string | null | undefined)[]): Language {
  for (const wish of wishes) {
    const found = LANGUAGES.find((language) => language === wish?.slice(0, 2).toLowerCase());
    if (found) return found;
  }
  return 'en';
}

/** Fills the placeholders of a text: {x} is replaced by values.x. */
export function fill(text: string, values: Readonly<Record<string, string | number>> = {}): string {
  return text.replace(/\{(\w+)\}/g, (place, name: string) => (name in values ? String(values[name]) : place));
}

export function hasText(key: string): key is TextKey { return key in en; }

/** Reads a stored choice; private windows may refuse. */
export function stored(key: string): string | null {
  try { return localStorage.getItem(key); } catch { return null; }
}
export function store(key: string, value: string): void {
  try { localStorage.setItem(key, value); } catch { /* without storage the choice lasts for this visit */ }
}

let current: Language = 'en';
const listeners = new Set<(language: Language) => void>();

/** Language of the address (?lang=), else the stored choice, else the browser's. Call once at the start. */
export function startLanguage(): Language {
  current = chooseLanguage([new URLSearchParams(location.search).get('lang'), stored(STORED), ...navigator.languages]);
  document.documentElement.lang = current;
  return current;
}

export function language(): Language { return current; }

export function setLanguage(wanted: Language): void {
  current = wanted;
  document.documentElement.lang = wanted;
  store(STORED, wanted);
  for (const callback of listeners) callback(wanted);
}

/** Calls back after every change of language; returns a function that ends this. */
export function onLanguage(callback: (language: Language) => void): () => void {
  listeners.add(callback);
  return () => { listeners.delete(callback); };
}

/** A text in the chosen language. */
export function text(key: TextKey, values?: Readonly<Record<string, string | number>>): string {
  return fill(ALL[current][key], values);
}

/** The text of a fault in Scene.fault_names; an unknown one in the program's words. */
export function faultWord(name: string): string {
  const key = `fault.${name}`;
  return hasText(key) ? text(key) : name;
}
