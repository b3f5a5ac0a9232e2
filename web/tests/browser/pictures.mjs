// Pictures of both pages in full quality, kept beside the other output of the tests.
import { join } from 'node:path';
import { openPage, pageUrl } from './browser.mjs';

const VIEWS = [
  { file: 'game-welcome.png', path: '/', query: {} },
  { file: 'game.png', path: '/', query: {}, click: '[data-testid=watch]', stage: 2 },
  { file: 'console-light.png', path: '/console', query: { theme: 'light' }, stage: 2 },
  { file: 'console-dark.png', path: '/console', query: { theme: 'dark' } },
];

/** Software rendering takes a second or more a frame in full quality. */
export async function takePictures(browser, programUrl, folder, watcher) {
  const taken = [];
  for (const { file, path, query, click, stage } of VIEWS) {
    const page = await openPage(browser, pageUrl(programUrl, path, { lang: 'en', quality: 'high', ...query }));
    if (click) {
      await page.waitForSelector(click, { timeout: 240_000 });
      // Not page.click: it waits for several pictures of a button that does not move.
      await page.evaluate((selector) => document.querySelector(selector).click(), click);
    }
    await page.waitForFunction(() => window.wholehandStats?.quality === 'high', null, { timeout: 300_000 });
    const frames = await page.evaluate(() => window.wholehandStats.frames);
    await page.waitForFunction((n) => window.wholehandStats.frames >= n + 4, frames, { timeout: 300_000 });
    if (stage !== undefined) await watcher.until('pouring', (now) => now.values.stage === stage && now.values.poured_l > 0.2 * now.values.asked_l, { within_ms: 60_000 }).catch(() => null);
    // Nothing more is drawn: taking the picture does not wait for the next one.
    await page.evaluate(() => { window.requestAnimationFrame = () => 0; });
    await page.screenshot({ path: join(folder, file), timeout: 180_000 });
    taken.push(file);
    await page.context().close();
  }
  return taken;
}
