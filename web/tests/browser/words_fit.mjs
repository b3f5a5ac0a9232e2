// Every instruction of every exercise fits into the strip: nine sizes, three languages, measured by scroll width.
// It needs no program: the pages' own display and style sheet are loaded by Vite.
import { readdirSync, readFileSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { createServer } from 'vite';
import { expect } from './browser.mjs';

const WEB = fileURLToPath(new URL('../..', import.meta.url));
const SIZES = [[1920, 1080], [1280, 800], [1280, 720], [1024, 640], [820, 1180], [1180, 820], [390, 844], [844, 390], [320, 640]];
const LANGUAGES = ['en', 'de', 'fr'];

/** Instructions of the exercises' files, by language. */
function ofFiles(language) {
  const folder = join(WEB, '../config/exercises');
  return readdirSync(folder).filter((name) => name.endsWith('.toml')).flatMap((name) =>
    readFileSync(join(folder, name), 'utf8').split(/^\[/m).filter((table) => table.startsWith('[panel.instructions]]')).map((table) => new RegExp(`^${language} = "(.*)"`, 'm').exec(table)[1]));
}

export async function instructionsFit(t) {
  const server = await createServer({ root: WEB, configFile: join(WEB, 'vite.config.ts'), server: { port: 0, host: '127.0.0.1' }, logLevel: 'error' });
  await server.listen();
  const { port } = server.httpServer.address();
  const context = await t.plain.newContext(), page = await context.newPage(), cut = [];
  let lines = 0;
  try {
    await page.goto(`http://127.0.0.1:${port}/tests/words_page.html`);
    for (const [width, height] of SIZES) {
      await page.setViewportSize({ width, height });
      for (const language of LANGUAGES) {
        const found = await page.evaluate(([own, of]) => window.measureWords(own, of), [language, ofFiles(language)]);
        lines += found.lines;
        for (const words of found.cut) cut.push(`${width} × ${height}, ${language}: ${words}`);
      }
    }
  } finally {
    await context.close();
    await server.close();
  }
  expect(cut.length === 0, `cut off:\n${cut.join('\n')}`);
  return `${lines} lines at nine sizes, none cut`;
}
