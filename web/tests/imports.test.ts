// The sources of the pages import each other without a circle, so that each can be read and loaded after what it uses.
import { readFileSync, readdirSync } from 'node:fs';
import { dirname, join, relative, resolve } from 'node:path';
import { expect, test } from 'vitest';

const SOURCES = resolve(__dirname, '../src');

/** The sources that each source imports. */
function readImports(): Map<string, string[]> {
  const files = readdirSync(SOURCES, { recursive: true }).map(String).filter((file) => file.endsWith('.ts') && !file.endsWith('.d.ts'));
  const known = new Set(files);
  return new Map(files.map((file) => {
    const text = readFileSync(join(SOURCES, file), 'utf8');
    const targets = [...text.matchAll(/^(?:import|export)\b[^;]*? from '(\.[^']*)'/gm)].map(([, target]) => {
      const at = relative(SOURCES, resolve(SOURCES, dirname(file), target));
      return known.has(`${at}.ts`) ? `${at}.ts` : join(at, 'index.ts');
    });
    return [file, targets.filter((target) => known.has(target))];
  }));
}

/** A circle of imports; undefined where there is none. */
function findCircle(imports: ReadonlyMap<string, readonly string[]>): string[] | undefined {
  const done = new Set<string>();
  const visit = (file: string, path: readonly string[]): string[] | undefined => {
    if (path.includes(file)) return [...path.slice(path.indexOf(file)), file];
    if (done.has(file)) return undefined;
    for (const target of imports.get(file) ?? []) {
      const circle = visit(target, [...path, file]);
      if (circle) return circle;
    }
    done.add(file);
    return undefined;
  };
  for (const file of imports.keys()) {
    const circle = visit(file, []);
    if (circle) return circle;
  }
  return undefined;
}

test('no circle of imports, types included', () => {
  const imports = readImports();
  expect(imports.size).toBeGreaterThan(200);
  expect([...imports.values()].flat().length).toBeGreaterThan(1000);
  expect(findCircle(imports)).toBeUndefined();
});

test('a circle is found', () => {
  expect(findCircle(new Map([['a', ['b', 'c']], ['b', []], ['c', ['d']], ['d', ['a']]]))).toEqual(['a', 'c', 'd', 'a']);
});
