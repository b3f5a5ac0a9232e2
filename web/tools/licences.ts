// The licence texts of what the pages bundle.
import { readdirSync, readFileSync } from 'node:fs';
import { join } from 'node:path';

const ROOT = join(__dirname, '..');
const MODULES = join(ROOT, 'node_modules');

/** What every page is made of. */
export const BUNDLED: readonly string[] = ['three', 'uplot', 'flatbuffers',
  '@fontsource-variable/atkinson-hyperlegible-next', '@fontsource-variable/atkinson-hyperlegible-mono'];

function textOf(name: string): string {
  const file = readdirSync(join(MODULES, name)).find((n) => /^licen[sc]e/i.test(n));
  // What ships none is Apache-2.0 like this project, whose text says the same.
  return readFileSync(file ? join(MODULES, name, file) : join(ROOT, '..', 'LICENSE'), 'utf8');
}

export function licenceTexts(names: readonly string[]): string {
  return names.map((name) => {
    const { version } = JSON.parse(readFileSync(join(MODULES, name, 'package.json'), 'utf8')) as { version: string };
    return `==== ${name} ${version}\n\n${textOf(name)}`;
  }).join('\n\n');
}
