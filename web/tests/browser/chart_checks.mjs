// Pages of charts written by the program, opened as files from the disk, without the program.
import { join } from 'node:path';
import { expect, expectAccessible, openFile, sheetsOf, until } from './browser.mjs';
import { letProgram } from './program.mjs';

/** Brightness of the numbers beside the first chart, 0 to 255. */
const inkOf = (page) => page.evaluate(() => {
  const canvas = document.querySelector('.chart canvas');
  const { data } = canvas.getContext('2d').getImageData(0, 0, 60, canvas.height);
  let [sum, count] = [0, 0];
  for (let i = 0; i < data.length; i += 4) if (data[i + 3] > 200) { sum += data[i]; count += 1; }
  return sum / count;
});

/** The certificate's charts are all drawn, in three languages, dark on a screen and light on paper. */
export async function chartsAreOneFile(t) {
  const path = join(t.folder, 'charts.html');
  await letProgram({ ...t, args: ['certify', '--exercise', 'cocktail-bar', '--charts', path] });
  const { page, asked } = await openFile(t.plain, path, { theme: 'dark' });
  expect((await page.locator('.chart canvas').count()) === 4, 'four kinds of axes are drawn');
  const title = () => page.locator('.paper h1').innerText();
  for (const [language, word] of [['de', 'zertifiziert'], ['fr', 'certifié'], ['en', 'certified']]) {
    await page.selectOption('[data-testid=language]', language);
    await until(`it speaks ${language}`, async () => (await title()).endsWith(word));
    await t.picture(page, `charts-${language}`);
  }
  await expectAccessible(page);
  await until('the charts are drawn once more', async () => (await page.locator('.chart canvas').count()) === 4);
  const on_screen = await inkOf(page);
  await page.evaluate(() => dispatchEvent(new Event('beforeprint')));
  await until('words on paper are dark', async () => (await inkOf(page)) < 110);
  await page.evaluate(() => dispatchEvent(new Event('afterprint')));
  await until('words on the dark screen are bright again', async () => Math.abs((await inkOf(page)) - on_screen) < 1);
  expect(await sheetsOf(page) === 1, 'not one sheet of paper');
  expect(asked.length === 1, `it asked for nothing but itself: ${asked.join(' ')}`);
}
