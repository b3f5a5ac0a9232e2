// After a stop nothing starts by itself, whatever was pressed before it was shown: the pages against the real program.
import { openPage, pageUrl } from './browser.mjs';
import { expect } from './checks.mjs';
import { openWatcher } from './watcher.mjs';

const RENDERING = 1;
const STOPPED = 3;
// A load and a rehearsal take about two seconds: what was still on its way has started by then.
const NOTHING_FOR_MS = 3000;
const PATIENT_MS = 60_000;

export const sleep = (ms) => new Promise((resolve) => setTimeout(resolve, ms));

/** The program's run states as a console's page hears them, from now on. */
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

async function expectNothingStarts(watcher, what) {
  await runStates(watcher);
  await sleep(NOTHING_FOR_MS);
  const states = await runStates(watcher);
  expect(states.every(({ runState }) => runState !== RENDERING), `${what}: it renders again: ${JSON.stringify(states)}`);
  const now = await watcher.now();
  expect(now.runState === STOPPED && now.sent.every((effort) => Math.abs(effort) < 1e-6), `${what}: state ${now.runState}, efforts ${now.sent}`);
}

const open = (browser, programUrl, path, query = {}) => openPage(browser, pageUrl(programUrl, path, { lang: 'en', quality: 'low', ...query }));

/** Start with another level, and Stop while the page says "One moment…". */
export async function stopWhileLoadingStartsNothing(browser, programUrl) {
  // A player who is alone: with a therapist there, the therapist loads.
  const watcher = await openWatcher(browser, programUrl, { role: 'watcher' });
  await keepRunStates(watcher);
  const game = await open(browser, programUrl, '/');
  await game.click('[data-level="2"]', { timeout: PATIENT_MS });
  await game.click('[data-testid=start]');
  await game.waitForSelector('body[data-state=loading]', { timeout: PATIENT_MS });
  // At once: a click of playwright's looks for the button for longer than the level takes to load.
  await game.evaluate(() => document.querySelector('[data-testid=stop]').click());
  await sleep(NOTHING_FOR_MS);
  const states = await runStates(watcher);
  expect(states.every(({ runState }) => runState !== RENDERING), `it starts after the stop: ${JSON.stringify(states)}`);
  await game.waitForSelector('text=/Stopped/', { timeout: PATIENT_MS });
  await expectNothingStarts(watcher, 'Stop while a level is loaded');
  await game.context().close();
  await watcher.page.context().close();
  return 'Stop while the level is loaded: nothing starts, and the page says so';
}

/** Starts from the console as a therapist does. */
export async function armFrom({ page }) {
  await page.click('[data-testid=arm]:enabled', { timeout: PATIENT_MS });
}

/** "Pause", by mouse and by Space, in the moment in which the page learns of an emergency stop and does not show it yet. */
export async function pauseAfterAStopStartsNothing(browser, programUrl) {
  const watcher = await openWatcher(browser, programUrl);
  await keepRunStates(watcher);
  const therapist = await openWatcher(browser, programUrl);
  for (const how of ['click', 'Space']) {
    await armFrom(watcher);
    await watcher.until('rendering', (now) => now.runState === RENDERING, { within_ms: PATIENT_MS });
    await therapist.page.waitForSelector('[data-testid=pause]:enabled', { timeout: PATIENT_MS });
    // The label is refreshed five times a second; this hits the moment in which the state is newer than the label.
    const pressed = therapist.page.evaluate((key) => new Promise((resolve) => {
      const button = document.querySelector('[data-testid=pause]');
      const look = setInterval(() => {
        if (window.wholehandNow.state.runState !== 3) return;
        clearInterval(look);
        const shown = button.dataset.testid;
        if (key === 'click') button.click();
        else document.body.dispatchEvent(new KeyboardEvent('keydown', { code: key, bubbles: true, cancelable: true }));
        resolve(shown);
      }, 4);
    }), how);
    await sleep(300);
    await watcher.page.keyboard.press('Escape');
    await pressed;
    await watcher.until('stopped', (now) => now.runState === STOPPED, { within_ms: PATIENT_MS });
    await expectNothingStarts(watcher, `Pause by ${how} after an emergency stop`);
  }
  await therapist.page.context().close();
  await watcher.page.context().close();
  return 'Pause by mouse and by Space just after an emergency stop: nothing starts';
}
