import { readdirSync, readFileSync } from 'node:fs';
import { expect, test } from 'vitest';
import { de as consoleDe } from '../src/console/i18n/de';
import { en as consoleEn } from '../src/console/i18n/en';
import { fr as consoleFr } from '../src/console/i18n/fr';
import { de as barDe } from '../src/exercises/cocktail_bar/i18n/de';
import { en as barEn } from '../src/exercises/cocktail_bar/i18n/en';
import { fr as barFr } from '../src/exercises/cocktail_bar/i18n/fr';
import { de as graspDe } from '../src/exercises/free_grasping/i18n/de';
import { en as graspEn } from '../src/exercises/free_grasping/i18n/en';
import { fr as graspFr } from '../src/exercises/free_grasping/i18n/fr';
import { de as kitchenDe } from '../src/exercises/kitchen/i18n/de';
import { en as kitchenEn } from '../src/exercises/kitchen/i18n/en';
import { fr as kitchenFr } from '../src/exercises/kitchen/i18n/fr';
import { de as levelDe } from '../src/exercises/squeeze_to_level/i18n/de';
import { en as levelEn } from '../src/exercises/squeeze_to_level/i18n/en';
import { fr as levelFr } from '../src/exercises/squeeze_to_level/i18n/fr';
import { chooseLanguage, fill } from '../src/shared/i18n';
import { de } from '../src/shared/i18n/de';
import { en } from '../src/shared/i18n/en';
import { fr } from '../src/shared/i18n/fr';

const places = (text: string) => (text.match(/\{\w+\}/g) ?? []).sort();

test.each([
  ['de', de, en], ['fr', fr, en], ['de, of the bar', barDe, barEn], ['fr, of the bar', barFr, barEn], ['de, of free grasping', graspDe, graspEn],
  ['fr, of free grasping', graspFr, graspEn], ['de, of the levels', levelDe, levelEn], ['fr, of the levels', levelFr, levelEn], ['de, of the kitchen', kitchenDe, kitchenEn], ['fr, of the kitchen', kitchenFr, kitchenEn],
])('Texts_In_%s_HaveTheKeysAndPlaceholdersOfEnglish', (_name, texts, english) => {
  expect(Object.keys(texts).sort()).toEqual(Object.keys(english).sort());
  for (const [key, value] of Object.entries(english)) {
    const translated = (texts as Record<string, string>)[key];
    expect(translated.trim(), key).not.toBe('');
    expect(places(translated), key).toEqual(places(value));
  }
});

test('Texts_InGerman_UseSwissSpelling', () => {
  for (const [key, value] of Object.entries({ ...de, ...barDe })) expect(value, key).not.toContain('ß');
  // The texts of every page.
  const src = new URL('../src/', import.meta.url);
  const files = readdirSync(src, { recursive: true, encoding: 'utf8' }).filter((name) => name.endsWith('i18n/de.ts'));
  expect(files.length).toBeGreaterThan(6);
  for (const file of files) expect(readFileSync(new URL(file, src), 'utf8'), file).not.toContain('ß');
});

/** The names of an enum of the schema, in its order. */
function enumNames(name: string): string[] {
  const schema = readFileSync(new URL('../../protocol/wholehand.fbs', import.meta.url), 'utf8').replace(/\/\/.*/g, '');
  const body = schema.match(new RegExp(`enum ${name} : \\w+ \\{([^}]*)\\}`))?.[1] ?? '';
  return body.split(',').map((value) => value.trim());
}

test('Texts_HaveASentenceForEveryRefusalOfTheSchemaAndNoOther', () => {
  const refusals = enumNames('Refusal').filter((value) => value !== 'None' && value !== 'Other');
  expect(refusals).toContain('NotHolder');
  expect(Object.keys(en).filter((key) => key.startsWith('refusal.')).sort()).toEqual(refusals.map((value) => `refusal.${value}`).sort());
});

test('Texts_HaveAWordForEveryFaultOfTheProgram', () => {
  const source = readFileSync(new URL('../../src/loop/core/fault.hpp', import.meta.url), 'utf8');
  const names = [...source.matchAll(/\{Fault::k\w+, "([^"]+)",/g)].map(([, name]) => `fault.${name}`);
  expect(names).toContain('fault.late tick');
  expect(names.filter((name) => !(name in en))).toEqual([]);
});

test('Language_FromWishes_IsTheFirstAvailable', () => {
  expect(chooseLanguage([null, 'it-CH', 'fr-CH', 'de'])).toBe('fr');
  expect(chooseLanguage(['DE-ch'])).toBe('de');
  expect(chooseLanguage(['ja', undefined])).toBe('en');
});

test('Fill_PlaceholderWithoutValue_StaysVisible', () => {
  expect(fill('{a} of {b} ml', { a: 12 })).toBe('12 of {b} ml');
});

test('Texts_NameEveryLiquidAndDrinkOfTheShippedExercises', () => {
  const folder = new URL('../../config/exercises/', import.meta.url);
  const names = readdirSync(folder).flatMap((file) => [...readFileSync(new URL(file, folder), 'utf8')
    .matchAll(/\[\[(liquid|drink)s\]\]\s+name = "([^"]+)"/g)].map(([, kind, name]) => `${kind}.${name}`));
  expect(names.length).toBeGreaterThanOrEqual(9);   // four liquids, five drinks
  expect(names.filter((name) => !(name in barEn))).toEqual([]);
});

// WCAG 2.5.3: speech users say the visible text of a button.
test.each([consoleEn, consoleFr, consoleDe].map((t) => t.recordings))('accessible names of a recording contain the visible words ($download)', (t) => {
  expect(fill(t.downloadOf, { name: 'A' })).toContain(t.download);
  expect(fill(t.reportOf, { name: 'A' })).toContain(t.report);
  expect(fill(t.replayOf, { name: 'A' })).toContain(t.replay);
});
