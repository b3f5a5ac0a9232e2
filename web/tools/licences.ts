// The licence texts of the bundled packages.
import { readdirSync, readFileSync } from 'node:fs';
import { join } from 'node:path';

const ROOT = join(__dirname, '..');
const MODULES = join(ROOT, 'node_modules');

/** The packages that pages bundle. */
export const BUNDLED: readonly string[] = ['three', 'uplot', 'flatbuffers',
  '@fontsource-variable/atkinson-hyperlegible-next', '@fontsource-variable/atkinson-hyperlegible-mono'];

function textOf(name: string): string {
  const file = readdirSync(join(MODULES, name)).find((n) => /^licen[sc]e/i.test(n));
  // A package without a licence file has Apache-2.0 like this project, whose text is the same.
  return readFileSync(file ? join(MODULES, name, file) : join(ROOT, '..', 'LICENSE'), 'utf8');
}

export function licenceTexts(names: readonly string[]): string {
  return names.map((name) => {
    const { version } = JSON.parse(readFileSync(join(MODULES, name, 'package.json'), 'utf8')) as { version: string };
    return `==== ${name} ${version}\n\n${textOf(name)}`;
  }).join('\n\n');
}
