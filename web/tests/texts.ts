// Requirements on the texts of every page: each language has everything that English has.
import { expect, it } from 'vitest';

const flat = (value: unknown, path = ''): [string, string][] => typeof value === 'string' ? [[path, value]]
  : Object.entries(value as object).flatMap(([name, inner]) => flat(inner, `${path}.${name}`));
const places = (words: string): string[] => (words.match(/\{\w+\}/g) ?? []).sort();

/** Declares the tests of a page's texts. */
export function testTexts(en: object, de: object, fr: object): void {
  it.each([['de', de], ['fr', fr]])('in %s have the keys and placeholders of English', (_name, other) => {
    const theirs = new Map(flat(other));
    expect([...theirs.keys()].sort()).toEqual(flat(en).map(([name]) => name).sort());
    for (const [name, words] of flat(en)) {
      expect(theirs.get(name)?.trim(), name).not.toBe('');
      expect(places(theirs.get(name)!), name).toEqual(places(words));
    }
  });

  it('in German use Swiss spelling', () => { for (const [name, words] of flat(de)) expect(words, name).not.toContain('ß'); });
}
