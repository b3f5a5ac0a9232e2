// Pages of charts that the program writes, opened as the files that they are: from the disk, without the program.
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';
import { accessibilityFaults, openPage, until } from './browser.mjs';
import { expect } from './checks.mjs';
import { letProgram } from './program.mjs';

const PATIENT_MS = 120_000;

async function open(browser, path, hash = '?lang=en&theme=dark') {
  const page = await openPage(browser, 'about:blank');
  const asked = [];
  page.on('request', (request) => { if (!/^(data|blob):/.test(request.url())) asked.push(request.url()); });
  await page.goto(`${pathToFileURL(path).href}${hash}`, { waitUntil: 'commit', timeout: PATIENT_MS });
  await until('the page is shown', () => page.evaluate(() => document.body?.dataset.state === 'shown'), { within_ms: PATIENT_MS });
  return { page, asked };
}

/** How bright the numbers beside the first chart are, 0 to 255. */
const inkOf = (page) => page.evaluate(() => {
  const canvas = document.querySelector('.chart canvas');
  const { data } = canvas.getContext('2d').getImageData(0, 0, 60, canvas.height);
  let [sum, count] = [0, 0];
  for (let i = 0; i < data.length; i += 4) if (data[i + 3] > 200) { sum += data[i]; count += 1; }
  return sum / count;
});

/** The certificate's charts: all drawn, in three languages, dark on a screen and light on paper. */
export async function chartsAreOneFile(plain, folder, picture) {
  const path = join(folder.folder, 'charts.html');
  await letProgram({ ...folder, args: ['certify', '--exercise', 'cocktail-bar', '--charts', path] });
  const { page, asked } = await open(plain, path);
  expect((await page.locator('.chart canvas').count()) === 4, 'four kinds of axes are drawn');
  const title = () => page.locator('.paper h1').innerText();
  for (const [language, word] of [['de', 'zertifiziert'], ['fr', 'certifié'], ['en', 'certified']]) {
    await page.selectOption('[data-testid=language]', language);
    await until(`it speaks ${language}`, async () => (await title()).endsWith(word));
    if (picture) await picture(page, `charts-${language}`);
  }
  const faults = await accessibilityFaults(page);
  expect(faults.length === 0, faults.join('; '));
  await until('the charts are drawn once more', async () => (await page.locator('.chart canvas').count()) === 4);
  const on_screen = await inkOf(page);
  await page.evaluate(() => dispatchEvent(new Event('beforeprint')));
  await until('words on paper are dark', async () => (await inkOf(page)) < 110);
  await page.evaluate(() => dispatchEvent(new Event('afterprint')));
  await until('words on the dark screen are bright again', async () => Math.abs((await inkOf(page)) - on_screen) < 1);
  const sheets = (await page.pdf({ preferCSSPageSize: true })).toString('latin1').match(/\/Type\s*\/Page\b/g) ?? [];
  expect(sheets.length === 1, `${sheets.length} sheets of paper`);
  expect(asked.length === 1, `it asked for nothing but itself: ${asked.join(' ')}`);
  expect(page.faults.length === 0, page.faults.join('; '));
  await page.context().close();
}
