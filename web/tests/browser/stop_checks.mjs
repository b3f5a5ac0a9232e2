// After a stop nothing starts by itself, whatever was pressed before it was shown: the pages with the real program.
import { expect, openPage, pageUrl } from './browser.mjs';
import { openWatcher, RENDERING, STOPPED } from './watcher.mjs';

// A load and a rehearsal take about two seconds: after this time any order under way would have started something.
const NOTHING_FOR_TICKS = 3000;

/** Records the program's run states from now on, as a console's page receives them. */
export async function keepRunStates({ page }) {
  await page.evaluate(() => {
    window.runStates = [];
    setInterval(() => {
      const { runState, session, endings } = window.wholehandNow?.state ?? {};
      const last = window.runStates.at(-1);
      const same = last?.runState === runState && last.session === session && last.endings === endings;
      if (runState !== undefined && !same) window.runStates.push({ runState, session, endings });
    }, 4);
  });
}

export const runStates = ({ page }) => page.evaluate(() => window.runStates.splice(0));

/** The states since the last ending (WorldState.endings): before, the program had not received the stop. */
const sinceTheStop = (states) => states.slice(Math.max(0, states.findLastIndex(({ endings }, i) => i > 0 && endings > states[i - 1].endings)));

/** Expects that nothing renders from now on, nor since the run states were read last, except states that `since` leaves out. */
async function expectNothingStarts(watcher, what, since = (states) => states) {
  await watcher.pass(NOTHING_FOR_TICKS);
  const states = since(await runStates(watcher));
  expect(states.every(({ runState }) => runState !== RENDERING), `${what}: it renders again: ${JSON.stringify(states)}`);
  const now = await watcher.now();
  expect(now.runState === STOPPED && now.sent.every((effort) => Math.abs(effort) < 1e-6), `${what}: state ${now.runState}, efforts ${now.sent}`);
}

/** Start with another level, and Stop while the page shows "One moment…". */
export async function stopWhileLoadingStartsNothing(t) {
  const { url } = await t.program();
  // The player is alone: if a therapist is there, the therapist loads.
  const watcher = await openWatcher(t.plain, url, { role: 'watcher' });
  await keepRunStates(watcher);
  const game = await openPage(t.plain, pageUrl(url, '/', { lang: 'en', quality: 'low' }));
  await game.click('[data-level="2"]');
  await game.click('[data-testid=start]');
  await game.waitForSelector('body[data-state=loading]');
  // At once: a click by playwright waits for the button for longer than the level takes to load.
  await game.evaluate(() => document.querySelector('[data-testid=stop]').click());
  await game.waitForSelector('text=/Stopped/');
  await expectNothingStarts(watcher, 'Stop while a level is loaded', sinceTheStop);
  return 'Stop while the level is loaded: nothing starts, and the page says so';
}

/** "Pause", by mouse and by Space, at the moment when the page has received an emergency stop and does not show it yet. */
export async function pauseAfterAStopStartsNothing(t) {
  const watcher = await t.watcher();
  await keepRunStates(watcher);
  const { page } = await openWatcher(t.plain, watcher.url);
  for (const how of ['click', 'Space']) {
    if ((await watcher.now()).runState !== RENDERING) await watcher.arm();
    await watcher.rendering();
    await page.waitForSelector('[data-testid=pause]:enabled');
    // The label is refreshed five times a second; this is the moment when the state is newer than the label.
    await page.evaluate((key) => {
      const button = document.querySelector('[data-testid=pause]');
      const look = setInterval(() => {
        if (window.wholehandNow.state.runState !== 3) return;
        clearInterval(look);
        if (key === 'click') button.click();
        else document.body.dispatchEvent(new KeyboardEvent('keydown', { code: key, bubbles: true, cancelable: true }));
        window.pressedBy = key;
      }, 4);
    }, how);
    await watcher.page.keyboard.press('Escape');
    await page.waitForFunction((key) => window.pressedBy === key, how);
    await watcher.neutral();
    await runStates(watcher);
    await expectNothingStarts(watcher, `Pause by ${how} after an emergency stop`);
  }
  return 'Pause by mouse and by Space just after an emergency stop: nothing starts';
}
