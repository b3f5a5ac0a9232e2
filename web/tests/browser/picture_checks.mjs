// The picture that a browser loses: said, the play waits, and goes on by a press when it is back.
import { accessibilityFaults } from './browser.mjs';
import { expect, GOES_ON, openGame } from './checks.mjs';

const PATIENT_MS = 120_000;

export async function lostPictureIsSaid(browser, programUrl, picture) {
  const page = await openGame(browser, programUrl, {}, { width: 800, height: 500, init: GOES_ON });
  try {
    await page.waitForFunction(() => window.wholehandStats?.quality === 'low', null, { timeout: PATIENT_MS });
    await page.waitForSelector('body:is([data-state=reach], [data-state=squeeze], [data-state=hold], [data-state=drawback])', { timeout: PATIENT_MS });
    await page.evaluate(() => {
      window.lose = document.querySelector('#picture').getContext('webgl2').getExtension('WEBGL_lose_context');
      window.lose.loseContext();
    });
    await page.waitForSelector('[data-testid=unseen] >> text=/The picture is gone/', { timeout: PATIENT_MS });
    expect(await page.isDisabled('[data-testid=see-again]'), 'the play can go on without a picture');
    const faults = await accessibilityFaults(page);
    expect(faults.length === 0, faults.join('\n'));
    await picture(page, 'picture-lost');
    await page.evaluate(() => window.lose.restoreContext());
    await page.waitForSelector('[data-testid=unseen] >> text=/The picture is back/', { timeout: PATIENT_MS });
    // A page that was not heard for 200 ms meanwhile says that instead, and GOES_ON presses there.
    const wentOn = await page.evaluate(() => window.wentOn);
    await page.click('[data-testid=see-again]', { timeout: 10_000 }).catch(async (error) => {
      if (await page.evaluate(() => window.wentOn) === wentOn) throw error;
    });
    await page.waitForSelector('body:is([data-state=reach], [data-state=squeeze], [data-state=hold], [data-state=drawback])', { timeout: PATIENT_MS });
    await new Promise((resolve) => setTimeout(resolve, 2000));
    await picture(page, 'picture-back');
    return 'gone, said; back, and the play goes on by a press';
  } finally {
    await page.context().close();
  }
}
