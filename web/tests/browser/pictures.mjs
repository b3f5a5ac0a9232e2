// Pictures of both pages in full quality, stored with the other output of the tests.
import { join } from 'node:path';
import { expectNoFaults, HANGS_MS, openPage, pageUrl } from './browser.mjs';

const VIEWS = [
  { file: 'game-welcome.png', path: '/', query: {} },
  { file: 'game.png', path: '/', query: {}, click: '[data-testid=watch]', stage: 2 },
  { file: 'console-light.png', path: '/console', query: { theme: 'light' }, stage: 2 },
  { file: 'console-dark.png', path: '/console', query: { theme: 'dark' } },
];

/** Software rendering takes a second or more per frame in full quality. */
export async function takePictures(t) {
  const watcher = await t.watcher();
  for (const { file, path, query, click, stage } of VIEWS) {
    // On a busy machine a page that draws this slowly loses its connection for a moment, and asks for the reason.
    const page = await openPage(t.drawing, pageUrl(watcher.url, path, { lang: 'en', quality: 'high', ...query }), { cutOff: true });
    page.setDefaultTimeout(2 * HANGS_MS);
    if (click) {
      // Not page.click, which waits for several frames of a still button. The press is repeated until it has acted: before
      // the page is connected the button is disabled, and a page that loses its connection removes it for a moment.
      await page.waitForFunction((selector) => {
        const button = document.querySelector(selector);
        button?.click();
        return button === null && document.body.dataset.state === 'watching';
      }, click);
    }
    await page.waitForFunction(() => window.wholehandStats?.quality === 'high');
    const frames = await page.evaluate(() => window.wholehandStats.frames);
    await page.waitForFunction((n) => window.wholehandStats.frames >= n + 4, frames);
    // The virtual patient pours into every drink, repeatedly.
    if (stage !== undefined) await watcher.until('pouring', (now) => now.values.stage === stage && now.values.poured_l > 0.2 * now.values.asked_l);
    // Drawing is stopped, so that the screenshot does not wait for the next frame.
    await page.evaluate(() => { window.requestAnimationFrame = () => 0; });
    await page.screenshot({ path: join(t.output, file) });
    expectNoFaults(page);
    await page.context().close();
  }
  return `${VIEWS.map(({ file }) => file).join(', ')} in ${t.output}`;
}
