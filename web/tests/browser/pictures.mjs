// Pictures of both pages in full quality, kept beside the other output of the tests.
import { join } from 'node:path';
import { openPage, pageUrl } from './browser.mjs';

const VIEWS = [
  { file: 'game-welcome.png', path: '/', query: {} },
  { file: 'game.png', path: '/', query: {}, click: '[data-testid=watch]', stage: 2 },
  { file: 'console-light.png', path: '/console', query: { theme: 'light' }, stage: 2 },
  { file: 'console-dark.png', path: '/console', query: { theme: 'dark' } },
];

// The virtual patient pours into every drink, over and over.
const POURING_WITHIN_MS = 120_000;

/** Software rendering takes a second or more a frame in full quality. A picture whose moment never came is kept, and is a fault. */
export async function takePictures(browser, programUrl, folder, watcher) {
  const taken = [];
  const faults = [];
  for (const { file, path, query, click, stage } of VIEWS) {
    // On a busy machine a page that draws this slowly loses its line for a moment, and asks why.
    const page = await openPage(browser, pageUrl(programUrl, path, { lang: 'en', quality: 'high', ...query }), { cutOff: true });
    if (click) {
      // Not page.click: it waits for several pictures of a button that does not move. Pressed until it has acted: before
      // the page is connected it cannot be pressed, and one that loses its line for a moment takes it away and brings it back.
      await page.waitForFunction((selector) => {
        const button = document.querySelector(selector);
        button?.click();
        return button === null && document.body.dataset.state === 'watching';
      }, click, { timeout: 240_000 });
    }
    await page.waitForFunction(() => window.wholehandStats?.quality === 'high', null, { timeout: 300_000 });
    const frames = await page.evaluate(() => window.wholehandStats.frames);
    await page.waitForFunction((n) => window.wholehandStats.frames >= n + 4, frames, { timeout: 300_000 });
    if (stage !== undefined) {
      const pouring = (now) => now.values.stage === stage && now.values.poured_l > 0.2 * now.values.asked_l;
      await watcher.until('pouring', pouring, { within_ms: POURING_WITHIN_MS }).catch((error) => faults.push(`${file} does not show what it should: ${error.message}`));
    }
    // Nothing more is drawn: taking the picture does not wait for the next one.
    await page.evaluate(() => { window.requestAnimationFrame = () => 0; });
    await page.screenshot({ path: join(folder, file), timeout: 180_000 });
    taken.push(file);
    faults.push(...page.faults.map((fault) => `${file}: ${fault}`));
    await page.context().close();
  }
  return { taken, faults };
}
