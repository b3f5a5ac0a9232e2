// Kitchen tasks on both pages, with a program whose virtual patient plays them.
import { join } from 'node:path';
import { expect, expectAccessible, openPage, pageUrl, until } from './browser.mjs';
import { GOES_ON, openGame } from './checks.mjs';
import { HANDS } from './drink_checks.mjs';
import { startProgram } from './program.mjs';
import { openWatcher } from './watcher.mjs';

/** Issue 41: time limit for a newcomer with a mouse, in the program's time [s]. */
const NEWCOMER_S = 60;
/** A person who sees no reaction presses again after this time [ms]. */
const PATIENCE_MS = 8000;

/** The drawer is pulled, opened, held and shut; the page shows the texts of its file, in another language than English. */
export async function drawerIsOpenedAndShut(t) {
  const { url } = await startProgram({ ...t, args: ['--exercise', 'drawer'] });
  const game = await openPage(t.drawing, pageUrl(url, '/', { lang: 'fr', quality: 'low', watch: '' }));
  await game.waitForSelector('[data-testid=task] h1 >> text=Un tiroir');
  const console = await openPage(t.plain, pageUrl(url, '/console', { lang: 'de' }));
  await console.waitForSelector('.exercise [data-value=joint_q]');
  const open_cm = async () => parseFloat((await console.locator('[data-value=joint_q] :is(.figure, .num)').first().innerText()).replace(',', '.'));
  const instructionIs = (words) => until(`"${words}"`, async () => (await game.locator('[data-testid=instruction]').innerText()) === words);
  await instructionIs('Tirez le tiroir');
  await nothingCoversTheCard(game);
  await until('an open drawer', async () => (await open_cm()) > 8);
  const most_cm = await open_cm();
  await t.picture(game, 'kitchen');
  await instructionIs('Refermez-le');
  await until('a shut drawer', async () => (await open_cm()) < 1);
  await instructionIs('Le tiroir est fermé');
  const done = await game.locator('.row .tick:not([hidden])').count();
  expect(done === 3, `${done} of the 3 rows of the card are done`);
  for (const page of [game, console]) await expectAccessible(page);
  return `opened ${most_cm} cm, and shut`;
}

/** Beside the card nothing stands over its rows: neither the meter nor "Play yourself". */
async function nothingCoversTheCard(page) {
  for (const size of [{ width: 1024, height: 640 }, { width: 1280, height: 720 }]) {
    await page.setViewportSize(size);
    await until(`a card that nothing covers at ${size.width} px`, () => page.evaluate(() => {
      const card = document.querySelector('[data-testid=task]').getBoundingClientRect();
      return ['.meter', '.playself', '.strip'].every((name) => {
        const box = document.querySelector(name)?.getBoundingClientRect();
        return !box || box.height === 0 || box.top >= card.bottom || box.left >= card.right;
      });
    }));
  }
}

/** A newcomer with a mouse and the left hand does the first task by the screen's text: it asks for one press. No picture is needed. */
export async function newcomerDoesTheFirstTask(t) {
  const { url } = await startProgram({ ...t, args: ['--wait', '--exercise', 'drawer', '--hand', join(HANDS, 'adult-median-left.toml')] });
  const watcher = await openWatcher(t.plain, url, { role: 'watcher' });
  const game = await openGame(t.plain, url, {}, { init: GOES_ON, hasTouch: false });
  await watcher.rendering();
  const { tick: began, rightHand } = await watcher.now();
  expect(!rightHand, 'it is a right hand');
  let presses = 0, pressed_ms = -Infinity;
  await watcher.until('the task done', async ({ tick, values }) => {
    if (values.done === 1) return true;
    expect(tick - began < 4000 * NEWCOMER_S, `not done: ${JSON.stringify(values)}`);
    if ((await game.getAttribute('body', 'data-state')) === 'reach' && Date.now() - pressed_ms > PATIENCE_MS) {
      pressed_ms = Date.now();
      presses += 1;
      const { x, y, width, height } = await game.locator('#play').boundingBox();
      await game.mouse.click(x + width / 2, y + height / 3, { delay: 100 });
    }
    return false;
  }, { every_ms: 200 });
  const { tick, values } = await watcher.now(), took_s = (tick - began) / 1000;
  expect(took_s <= NEWCOMER_S, `it took ${took_s.toFixed(1)} s`);
  return `${took_s.toFixed(1)} s, ${presses} presses, score ${values.score.toFixed(0)}`;
}
