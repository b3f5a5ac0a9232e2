// A lost picture of a browser: it is reported, the play waits, and continues by a press when the picture is back.
import { expect, expectAccessible, until } from './browser.mjs';
import { GOES_ON, openGame } from './checks.mjs';

const PLAYS = 'body:is([data-state=reach], [data-state=squeeze], [data-state=hold], [data-state=drawback])';

export async function lostPictureIsReported(t) {
  const watcher = await t.watcher();
  const page = await openGame(t.drawing, watcher.url, {}, { width: 480, height: 300, init: GOES_ON });
  const pictures = async (count) => {
    const frames = await page.evaluate(() => window.wholehandStats?.frames ?? 0);
    await page.waitForFunction((n) => window.wholehandStats?.quality === 'low' && window.wholehandStats.frames >= n, frames + count);
  };
  await pictures(2);
  // The virtual patient may have finished the level before the page was open: the therapist restarts it.
  await watcher.page.click('[data-testid=restart]');
  await page.waitForSelector(PLAYS);
  await page.evaluate(() => {
    window.lose = document.querySelector('#picture').getContext('webgl2').getExtension('WEBGL_lose_context');
    window.lose.loseContext();
  });
  await page.waitForSelector('[data-testid=unseen] >> text=/The picture is gone/');
  expect(await page.isDisabled('[data-testid=see-again]'), 'the play can go on without a picture');
  await expectAccessible(page);
  await t.picture(page, 'picture-lost');
  await page.evaluate(() => window.lose.restoreContext());
  await page.waitForSelector('[data-testid=unseen] >> text=/The picture is back/');
  // A page whose heartbeats were missing for 200 ms meanwhile shows that instead, and GOES_ON presses there.
  // A new card ignores presses for 0.7 s: a person presses again.
  await until('the play after a press', async () => {
    await page.evaluate(() => document.querySelector('[data-testid=see-again]')?.click());
    return page.locator(PLAYS).count();
  }, { every_ms: 1000 });
  await pictures(2);
  await t.picture(page, 'picture-back');
  // three.js deletes objects of the lost context.
  page.faults = page.faults.filter((fault) => !/does not belong to this context/.test(fault));
  return 'gone, said; back, and the play goes on by a press';
}
