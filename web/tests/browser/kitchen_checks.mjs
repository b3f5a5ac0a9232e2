// Tasks of the kitchen, seen on both pages, against a program whose virtual patient plays them.
import { expect, expectAccessible, openPage, pageUrl, until } from './browser.mjs';
import { startProgram } from './program.mjs';

/** The drawer is drawn, opened, held and shut; the page says the words of its file, in another language than English. */
export async function drawerIsOpenedAndShut(t) {
  const { url } = await startProgram({ ...t, args: ['--exercise', 'drawer'] });
  const game = await openPage(t.drawing, pageUrl(url, '/', { lang: 'fr', quality: 'low', watch: '' }));
  await game.waitForSelector('[data-testid=task] h1 >> text=Un tiroir');
  const console = await openPage(t.plain, pageUrl(url, '/console', { lang: 'de' }));
  await console.waitForSelector('.exercise [data-value=joint_q]');
  const open_cm = async () => parseFloat(await console.locator('[data-value=joint_q] :is(.figure, .num)').first().innerText());
  const says = (words) => until(`"${words}"`, async () => (await game.locator('[data-testid=instruction]').innerText()) === words);
  await says('Tirez le tiroir');
  await until('the meter of the joint', () => game.locator('[data-testid=meter]').isVisible());
  await until('an open drawer', async () => (await open_cm()) > 8);
  const most_cm = await open_cm();
  await t.picture(game, 'kitchen');
  await says('Refermez-le');
  await until('a shut drawer', async () => (await open_cm()) < 1);
  await says('Le tiroir est fermé. Bravo');
  const done = await game.locator('.row .tick:not([hidden])').count();
  expect(done === 3, `${done} of the 3 rows of the card are done`);
  for (const page of [game, console]) await expectAccessible(page);
  return `opened ${most_cm} cm, and shut`;
}
