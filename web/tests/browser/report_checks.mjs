// A report of the program, opened as a file from the disk, without the program.
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { expect, expectAccessible, expectNothingScrollsSideways, expectNoFaults, openFile, sheetsOf, until } from './browser.mjs';
import { letProgram } from './program.mjs';
import { recording } from './replay_checks.mjs';

/** Makes a report; with `before`, beside the earlier session. */
async function report(t, before) {
  const path = join(t.folder, 'report.html');
  await letProgram({ ...t, args: ['replay', await recording(t), '--report', path, ...(before ? ['--before', before] : [])] });
  return path;
}

const words = (page, selector) => page.locator(selector).innerText();

/** Without 3D and network: therapy, engineering, three languages, two printed sheets, and the viewer; beside a session of another exercise. */
export async function reportIsOneFile(t) {
  const before = await recording(t, 'grasping.h5', 'free-grasping');
  const { page, asked } = await openFile(t.plain, await report(t, before));
  await until('it says that there is no 3D', async () => /no WebGL/.test(await words(page, '[data-testid=picture]')));
  const therapy = await words(page, '[data-testid=therapy]');
  for (const text of ['Relaxed adult', 'Cocktail bar, Level 1', 'drinks finished', 'Poured', 'grip force', 'Lemonade', 'Effort limits in force', 'Lemon']) {
    expect(therapy.toLowerCase().includes(text.toLowerCase()), `the therapy says ${text}: ${therapy}`);
  }
  const kinds = await page.locator('.happened tr').evaluateAll((rows) => rows.map((row) => row.dataset.kind));
  for (const kind of ['stop', 'emergency_stop', 'fault', 'controls_lost', 'missing']) expect(kinds.includes(kind), `${kind} has a line, whether or not it happened`);
  await until('charts are drawn', async () => (await page.locator('.chart canvas').count()) >= 9);
  await expectAccessible(page);
  expect(await sheetsOf(page) === 2, 'not two sheets of paper');
  await nothingIsCutOnPaper(page);
  const compared = await words(page, '[data-testid=before]');
  expect(/^Before: .*It differs in: Exercise\. No figure can be compared\.$/.test(compared), compared);
  expect((await page.locator('.tiles em').count()) === 0, 'no figure of another exercise is beside one of this');
  for (const [language, title, differs] of [['de', 'Stopps und Störungen', 'Anders war: Übung. Keine der Zahlen ist vergleichbar.'], ['fr', 'Arrêts et défauts', 'Ce qui diffère : Exercice. Aucun chiffre n’est comparable.']]) {
    await page.selectOption('[data-testid=language]', language);
    await until(`it speaks ${language}`, async () => (await words(page, '.happened h2')) === title);
    const shown = await words(page, '[data-testid=before]');
    expect(shown.includes(differs), shown);
    await t.picture(page, `report-${language}`);
  }
  await expectNothingScrollsSideways(page, 'the report');
  await viewerShows(page);
  expect(asked.length === 1, `it asked for nothing but itself: ${asked.join(' ')}`);
}

/** The whole of a sheet fits on its paper. */
async function nothingIsCutOnPaper(page) {
  const { width, height } = page.viewportSize();
  await page.emulateMedia({ media: 'print' });
  await page.setViewportSize({ width: 794, height: 1123 });
  const cut = await page.locator('.sheet').evaluateAll((all) => all.map((sheet) => sheet.scrollHeight - sheet.clientHeight));
  expect(cut.every((px) => px <= 1), `cut off on paper: ${cut.join(' and ')} px`);
  await page.emulateMedia({ media: 'screen' });
  await page.setViewportSize({ width, height });
}

/** The viewer in the report seeks to a moment, steps through the available states, and returns to the sheets. */
async function viewerShows(page) {
  await page.locator('#report [data-testid=replay]').click();
  const now = (what, look) => until(what, async () => {
    const replay = await page.evaluate(() => window.wholehandReplay);
    return replay && replay.exact && look(replay) ? replay : undefined;
  });
  const { rows: [first] } = await now('the first state', () => true);
  await page.evaluate(() => { location.hash = 'replay=3'; });
  // The states of 12 s are at most as far apart as 1500 of them would be, with room for larger ones.
  const { rows: [third] } = await now('the state at 3 s', ({ time_s, rows }) => time_s === 3 && Math.abs(rows[0] - 3000) < 50);
  await page.keyboard.press('ArrowRight');
  await now('the next state', ({ rows }) => rows[0] > third);
  expect(third > first, `row ${third} after ${first}`);
  await page.locator('#app [data-testid=report]').click();
  await until('the sheets again', () => page.locator('[data-testid=therapy]').isVisible());
  await page.locator('body').press('Space');
  expect(!(await page.evaluate(() => window.wholehandReplay.playing)), 'Space on the sheets started the hidden viewer');
}

/** With 3D the strongest moment is a picture that can be printed. */
export async function reportHasItsPicture(t) {
  const { page } = await openFile(t.drawing, await report(t));
  await page.waitForSelector('[data-testid=picture] img');
  const caption = await words(page, '[data-testid=picture] figcaption');
  expect(/Strongest contact: [\d.]+ N at 0:\d\d/.test(caption), caption);
  await t.picture(page, 'report');
}

/** A template, a truncated file, data of another version: each is reported, and nothing hangs. */
export async function badReportsAreReported(t) {
  const whole = readFileSync(await report(t), 'utf8');
  const at = whole.indexOf('id="page-data">');
  const end = whole.indexOf('</script>', at);
  const cases = [
    ['template', `${whole.slice(0, at)}id="page-data">"none"${whole.slice(end)}`, 'carries no recording'],
    ['cut', whole.slice(0, at + (end - at) / 2), 'is cut, or damaged'],
    ['newer', whole.replace(/"version":1(?=[,}])/, '"version":9'), 'data of version 9'],
    ['corrupted', whole.replace(/("series":")[\w+/]{400}/, `$1${'A'.repeat(400)}`), 'damaged'],
  ];
  for (const [name, text, expected] of cases) {
    const path = join(t.folder, `report-${name}.html`);
    writeFileSync(path, text);
    const { page } = await openFile(t.plain, path, { state: 'problem' });
    const shown = await words(page, '[data-testid=problem]');
    expect(shown.includes(expected), `${name}: ${shown}`);
    expectNoFaults(page);
    await page.context().close();
  }
}
