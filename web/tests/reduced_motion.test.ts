// A person who asked for reduced motion sees no movement that a style adds; only the bar of a held button moves, which tells the remaining time.
import { readdirSync, readFileSync } from 'node:fs';
import { resolve } from 'node:path';
import { expect, it } from 'vitest';

const SOURCES = resolve(__dirname, '../src');
const STYLES = readdirSync(SOURCES, { withFileTypes: true }).filter((one) => one.isDirectory())
  .flatMap(({ name }) => readdirSync(resolve(SOURCES, name)).filter((file) => file.endsWith('.css')).map((file) => [`${name}/${file}`, readFileSync(resolve(SOURCES, name, file), 'utf8')] as const));

/** The rules outside of blocks for persons without that wish. */
function always(css: string): string {
  const begin = css.indexOf('@media (prefers-reduced-motion: no-preference)');
  if (begin < 0) return css;
  let end = css.indexOf('{', begin) + 1;
  for (let open = 1; open > 0; end += 1) open += css[end] === '{' ? 1 : css[end] === '}' ? -1 : 0;
  return css.slice(0, begin) + always(css.slice(end));
}

it.each(STYLES)('%s moves nothing against that wish', (_, css) => {
  const moving = [...always(css).matchAll(/([^{}]+)\{[^{}]*(?:animation|transition):\s*(?!none)([^;}]+)/g)].filter(([, , how]) => !how!.includes('var(--motion'));
  for (const [, selector] of moving) {
    const still = new RegExp(`@media \\(prefers-reduced-motion: reduce\\) \\{[^}]*${selector!.trim().split('\n').at(-1)!.trim().replace(/[.*+?^${}()|[\]\\]/g, '\\$&')}[^}]*(?:animation|transition): none`);
    expect(still.test(css), selector!.trim()).toBe(true);
  }
});

it('reads the styles of every page', () => { expect(STYLES.map(([name]) => name)).toEqual(expect.arrayContaining(['game/game.css', 'clinic/clinic.css', 'console/console.css', 'replay/replay.css'])); });
