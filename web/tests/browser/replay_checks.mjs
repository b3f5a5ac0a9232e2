// The replay of recordings, with the program as `replay --web`.
import { copyFileSync, existsSync, readFileSync, truncateSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { expect, expectAccessible, expectNothingScrollsSideways, openPage, until } from './browser.mjs';
import { letProgram, startProgram } from './program.mjs';
import { openWatcher } from './watcher.mjs';

const SECONDS = 12;

export const replayed = (page) => page.evaluate(() => window.wholehandReplay);
/** Waits until the page shows the requested data, and the whole time line. */
export const still = (page, what, look = () => true) => until(what, async () => {
  const now = await replayed(page);
  return now && now.exact && now.loaded === 1 && look(now) ? now : undefined;
});

/** A recording of the bar by the virtual patient, on the simulated clock; it is made once. */
export async function recording({ file, folder }, name = 'replayed.h5', exercise = 'cocktail-bar') {
  const path = join(folder, name);
  if (!existsSync(path)) await letProgram({ file, folder, args: ['run', '--exercise', exercise, '--simulated-clock', '--duration', String(SECONDS), '--record', path] });
  return path;
}

/** The address of a replay of one recording, or of two side by side. */
export const startReplay = (t, path, beside) => startProgram({ ...t, command: ['replay', path, '--web'], args: beside ? ['--beside', beside] : [] });
export const replay = async (...all) => (await startReplay(...all)).url;

export const withQuery = (address, query) => {
  const url = new URL(address);
  for (const [key, value] of Object.entries(query)) url.searchParams.set(key, value);
  return url.href;
};

/** Scrubbing, steps, playback and zoom; in two themes and three languages; the picture where there is 3D. */
export async function recordingIsReplayed(t) {
  const url = await replay(t, await recording(t));
  const page = await openPage(t.plain, withQuery(url, { lang: 'en', theme: 'light' }));
  // The whole is shown at first, including the ramp to neutral after its length.
  const { window: { to_s: last_s } } = await still(page, 'the first tick', (now) => now.rows[0] === 0);
  expect(last_s > SECONDS - 0.1 && last_s < SECONDS + 1, `it is ${last_s} s long`);
  // Through the middle and back: every position shows exactly the row of its time.
  const line = await page.locator('[data-testid=time-line]').boundingBox();
  for (const share of [0.5, 0.25, 0.9, 0.251]) {
    await page.mouse.click(line.x + share * line.width, line.y + 30);
    const now = await still(page, `the row at ${share}`, ({ time_s }) => Math.abs(time_s - share * last_s) < 0.05);
    expect(now.rows[0] === Math.round(now.time_s * 1000), `row ${now.rows[0]} at ${now.time_s} s`);
  }
  await keysMove(page, last_s);
  await zoomed(page, last_s);
  await page.keyboard.press('Home');
  await page.click('[data-testid=play]');
  await until('some of it played', async () => (await replayed(page)).time_s > 0.5);
  await page.keyboard.press(' ');
  const first = page.locator('[data-testid=moments] button').first();
  await first.click();
  await still(page, 'the first mark');
  expect((await first.getAttribute('aria-current')) === 'time', 'the mark at the play head is not marked');
  // A focused list keeps the key for itself.
  await page.locator('[role=slider]').first().focus();
  await page.keyboard.press('End');
  await still(page, 'the end', ({ time_s }) => Math.abs(time_s - last_s) < 2e-3);
  const marks = await page.locator('[data-testid=moments] button').evaluateAll((all) => all.map((one) => `${one.getAttribute('aria-current') ?? ''} ${one.innerText}`));
  expect(marks.findIndex((mark) => mark.startsWith('time')) === marks.length - 1, `the list does not follow the play head: ${JSON.stringify(marks)}`);
  for (const [lang, click] of [['en', null], ['de', '[data-testid=theme]'], ['fr', '[data-testid=tables]']]) {
    await page.selectOption('[data-testid=language]', lang);
    if (click) await page.click(click);
    // The next picture writes the page in the other language.
    await until('the button to play named', async () => (await page.innerText('[data-testid=play]')) !== '');
    await expectAccessible(page, lang);
    await t.picture(page, `replay_${lang}`);
    if (lang !== 'fr') await plotsAreComplete(page, lang);
  }
  await expectNothingScrollsSideways(page, 'replay');
  const { scrub_ms } = await replayed(page);
  await pictureIsDrawn(t, url);
  return `${scrub_ms.length} looks, the fastest answered within ${Math.min(...scrub_ms).toFixed(0)} ms`;
}

/** Rebuilt plots show the same as when they are drawn once more: curves, marks and limits. */
async function plotsAreComplete(page, lang) {
  await still(page, `all of it in ${lang}`);
  const drawn = () => page.locator('.plot .canvas canvas').evaluateAll((all) => all.map((canvas) => canvas.toDataURL()));
  const before = await drawn();
  await page.click('[data-testid=whole]');
  // One frame draws, the next one is after it.
  await page.evaluate(() => new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve))));
  const after = await drawn();
  const other = before.filter((plot, i) => plot !== after[i]).length;
  expect(before.length > 0 && other === 0, `${lang}: ${other} of ${before.length} plots lacked something when they were built anew`);
}

async function keysMove(page, last_s) {
  const last = Math.round(last_s * 1000);
  await page.keyboard.press('Home');
  await still(page, 'the beginning', (now) => now.rows[0] === 0);
  for (const [key, row] of [['ArrowRight', 1], ['ArrowRight', 2], ['ArrowLeft', 1], ['Shift+ArrowRight', 101], ['End', last], ['ArrowRight', last]]) {
    await page.keyboard.press(key);
    await still(page, `row ${row} after ${key}`, (now) => now.rows[0] === row && Math.abs(now.time_s - row / 1000) < 1e-6);
  }
}

/** The keys of the window, and a drag in a plot. */
async function zoomed(page, last_s) {
  await page.keyboard.press('+');
  await still(page, 'half the window', ({ window: w }) => Math.abs(w.to_s - w.from_s - last_s / 2) < 1e-6);
  await page.keyboard.press('0');
  const plot = await page.locator('.plot .u-over').first().boundingBox();
  await page.mouse.move(plot.x + 0.2 * plot.width, plot.y + 40);
  await page.mouse.down();
  await page.mouse.move(plot.x + 0.4 * plot.width, plot.y + 40, { steps: 6 });
  await page.mouse.up();
  await still(page, 'a fifth of it', ({ window: w }) => Math.abs(w.from_s - 0.2 * last_s) < 0.1 && Math.abs(w.to_s - 0.4 * last_s) < 0.1);
  await page.click('[data-testid=whole]');
  await still(page, 'all of it', ({ window: w }) => w.from_s === 0);
}

/** The hand is shown in 3D, at a moment of a grasp. */
async function pictureIsDrawn(t, url) {
  const page = await openPage(t.drawing, withQuery(url, { lang: 'en', quality: 'low' }), { width: 640, height: 400 });
  await until('the whole picture', async () => (await replayed(page))?.quality === 'low');
  await page.keyboard.press('PageDown');
  await still(page, 'a mark');
  await t.picture(page, 'replay_3d');
}

/** Another exercise beside the first: both at the same time, each with its plots. */
export async function twoAreReplayed(t) {
  const page = await openPage(t.plain, withQuery(await replay(t, await recording(t), await recording(t, 'grasping.h5', 'free-grasping')), { lang: 'en' }));
  await still(page, 'both at their beginning', (now) => now.rows.length === 2 && now.rows.every((row) => row === 0));
  const notices = await page.locator('.replay-notices').innerText();
  expect(notices.includes('Differs from A in: Exercise.'), notices);
  await page.keyboard.press('Shift+ArrowRight');
  const now = await still(page, 'a tenth of a second in both', ({ rows }) => rows.every((row) => row === 100));
  const plots = await page.locator('.plots').evaluateAll((all) => all.map((one) => one.querySelectorAll('.plot').length));
  expect(plots.length === 2 && plots[0] === plots[1] && plots[0] >= 8, `plots: ${plots}`);
  await expectAccessible(page);
  await t.picture(page, 'replay_beside');
  return `rows ${now.rows.join(' and ')}, ${plots[0]} plots each`;
}

/** A file that is not a recording, a missing one, and a program that stops meanwhile. */
export async function badRecordingsAreReported(t) {
  const path = await recording(t);
  const foreign = join(t.folder, 'foreign.h5');
  writeFileSync(foreign, 'this is no recording\n');
  const open = (url, query, more) => openPage(t.plain, withQuery(url, query), more);
  const url = await replay(t, foreign);
  const page = await open(url, { lang: 'de' }, { cutOff: true });
  const problem = page.locator('[data-testid=problem]');
  await problem.waitFor();
  expect((await problem.getAttribute('data-kind')) === 'unreadable', await problem.innerText());
  await page.goto(withQuery(url, { recording: '<b>nobody</b>', lang: 'de' }));
  await page.waitForSelector('[data-kind=unknown]');
  expect((await problem.locator('bdi').innerText()) === '<b>nobody</b>', 'a name is markup');
  const [firstLine] = (await problem.innerText()).split('\n');
  await page.context().close();
  // An unreadable recording does not hide the other one, in either order.
  for (const paths of [[path, foreign], [foreign, path]]) {
    const sound = await open(await replay(t, ...paths), { lang: 'fr' });
    await still(sound, 'the one that is sound', ({ rows }) => rows.length === 1);
    const notice = await sound.locator('.notice.bad:has([data-testid=reload])').innerText();
    expect(notice.includes('foreign.h5 n’est pas affiché'), notice);
    await t.picture(sound, 'replay_one_of_two');
    await sound.context().close();
  }
  const cut = join(t.folder, 'cut.h5');
  copyFileSync(path, cut);
  truncateSync(cut, Math.floor(readFileSync(path).length * 0.9));
  const damaged = await open(await replay(t, cut), { lang: 'fr' });
  await damaged.waitForSelector('[data-testid=problem], .notice');
  await t.picture(damaged, 'replay_cut');
  await damaged.context().close();
  const program = await startReplay(t, path);
  const left = await open(program.url, { lang: 'en' });
  await still(left, 'the first tick');
  await program.stop('SIGKILL');
  await left.keyboard.press('End');
  await left.waitForSelector('.notice.bad [data-testid=retry]');
  await left.keyboard.press('Home');
  await until('what was read', async () => (await replayed(left)).rows[0] === 0);
  await left.context().close();
  return `"${firstLine}"`;
}

/** A recording in progress is in the console's list, is replayed up to the present, and is offered for download when it has ended. */
export async function recordingIsListedWhileItRuns(t) {
  const { url } = await t.program();
  const { page, arm } = await openWatcher(t.plain, url);
  await page.selectOption('[data-testid=language]', 'de');
  await arm();
  // Recordings of other tests are in the list, too.
  const rows = page.locator('[data-testid=recordings] li');
  const replay = rows.filter({ hasText: 'wird noch aufgezeichnet' }).locator('[data-testid=replay]').first();
  const address = await replay.getAttribute('href');
  const row = rows.filter({ has: page.locator(`[href="${address}"]`) });
  const links = await row.locator('.links a').allInnerTexts();
  expect(links.join() === 'Wiedergabe', `offered while it is written: ${links}`);
  const replayPage = await openPage(t.plain, new URL(address, url).href);
  const { window: { to_s } } = await still(replayPage, 'what is written so far');
  // A second request within the second that the recorder writes at once gets the same answer.
  await until('what was written since', async () => {
    await replayPage.click('[data-testid=read-on]');
    const { window } = await still(replayPage, 'what it read');
    return window.to_s > to_s;
  });
  await page.click('[data-testid=emergency-stop]');
  await row.locator('a[download]').waitFor();
  return `replayed from ${to_s.toFixed(1)} s on`;
}
