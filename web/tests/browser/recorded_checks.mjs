// The pages show for every session whether it is recorded.
import { existsSync, mkdtempSync, readdirSync, rmSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { openGame } from './checks.mjs';
import { expect, expectAccessible, openPage, pageUrl, until } from './browser.mjs';
import { startProgram } from './program.mjs';

/** A program that starts by itself, like `./start`, in a folder of its own; its two pages. */
async function begun(t, prepare = () => {}) {
  const folder = mkdtempSync(join(t.folder, 'recorded-'));
  prepare(folder);
  const program = await startProgram({ file: t.file, folder, args: ['--no-rehearsal'] });
  const page = await openPage(t.plain, pageUrl(program.url, '/console', { lang: 'en' }));
  await page.waitForSelector('[data-testid=state][data-name=rendering]');
  const game = await openGame(t.plain, program.url);
  await game.waitForSelector('[data-testid=recorded]:not([hidden])');
  return { folder, program, page, game, recordedText: () => game.locator('[data-testid=recorded]').innerText() };
}

export const recordings = (folder) => {
  const kept = join(folder, 'out', 'recordings');
  return existsSync(kept) ? readdirSync(kept).filter((name) => name.endsWith('.h5')) : [];
};

/** The first session of a player, which nobody asked to record, is recorded, and the player sees that. */
export async function firstSessionIsRecorded(t) {
  const { folder, program, page, game, recordedText } = await begun(t);
  expect((await recordedText()) === '● Recording', `the game says: ${await recordedText()}`);
  await until('the console says so', async () => (await page.locator('header.top').innerText()).includes('● Recording'));
  expect(await page.locator('[data-testid=unrecorded]').isHidden(), 'the console says that nothing is recorded');
  await expectAccessible(game);
  const before = recordings(folder);
  expect(before.length === 1, `one recording: ${before.join()}`);
  await Promise.all([page.close(), game.close()]);  // otherwise they would look for the ended program
  await program.stop();
  const after = recordings(folder);
  expect(after.join() === before.join(), `the first session's recording is kept: ${after.join()}`);
  rmSync(folder, { recursive: true });
  return `kept ${after[0]}`;
}

/** If no recording can be made, both pages show that. */
export async function unrecordedSessionIsReported(t) {
  const { folder, program, page, game, recordedText } = await begun(t, (at) => writeFileSync(join(at, 'out'), 'a file where a folder should be'));
  expect((await recordedText()) === 'Not recorded', `the game says: ${await recordedText()}`);
  await page.waitForSelector('[data-testid=unrecorded]:not([hidden])');
  const words = await page.locator('[data-testid=unrecorded]').innerText();
  expect((await page.locator('header.top').innerText()).includes('Not recorded'), 'the header does not say so');
  await expectAccessible(page);
  await expectAccessible(game);
  await Promise.all([page.close(), game.close()]);  // otherwise they would look for the ended program
  await program.stop();
  rmSync(folder, { recursive: true });
  return words.replace(/\s+/g, ' ');
}
