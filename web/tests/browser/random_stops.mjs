// Stops at random moments of people's presses at the pages. Nothing renders after a stop until somebody presses
// who was shown it. WHOLEHAND_FULL tries 1,000 moments, WHOLEHAND_MOMENTS a part of them, WHOLEHAND_SEED repeats them.
import { expect, openPage, pageUrl, until } from './browser.mjs';
import { keepRunStates, runStates } from './stop_checks.mjs';
import { openWatcher, RENDERING, STOPPED } from './watcher.mjs';

// After this time all orders that were under way at the stop have been answered.
const NOTHING_FOR_TICKS = 2000;
const MOMENTS = Number(process.env.WHOLEHAND_MOMENTS ?? (process.env.WHOLEHAND_FULL ? 1000 : 3));

/** Range of the random moments. */
const sleep = (ms) => new Promise((resolve) => setTimeout(resolve, ms));

/** Random numbers of 0 to 1, the same ones for the same seed (mulberry32). */
function draws(seed) {
  let a = seed >>> 0;
  return () => {
    a = (a + 0x6d2b79f5) >>> 0;
    let t = Math.imul(a ^ (a >>> 15), a | 1);
    t ^= t + Math.imul(t ^ (t >>> 7), t | 61);
    return ((t ^ (t >>> 14)) >>> 0) / 2 ** 32;
  };
}

const click = (page, testid) => page.evaluate((id) => document.querySelector(`[data-testid=${id}]:not(:disabled)`)?.click(), testid);

async function open({ browser, url, opened }, path, shown) {
  const page = await openPage(browser, pageUrl(url, path, { lang: 'en', quality: 'low' }), { cutOff: true });
  opened.push(page);
  await page.waitForSelector(`[data-testid=${shown}`);
  return page;
}

const openGame = (all) => open(all, '/', 'start]:enabled');
const openConsole = (all) => open(all, '/console', 'load]');

/** Presses another level and Start where the present card has them; the card changes with other clients' actions. */
const pressStart = (page) => page.evaluate(() => {
  document.querySelector('[data-level][aria-pressed=false]')?.click();
  document.querySelector('[data-testid=start]')?.click();
});

/**
 * Each opens its pages and returns a function that presses there until the stop; that returns a function for the presses
 * after the stop was shown, none of which starts.
 */
const SCRIPTS = {
  async start(all) {
    const page = await openGame(all);
    all.game = page;
    return () => pressStart(page);
  },
  async load(all) {
    const page = await openConsole(all);
    await page.selectOption('[data-testid=level]', String(1 + Math.floor(2 * all.random())));
    return () => click(page, 'load');
  },
  async arm(all) {
    const page = await openConsole(all);
    return () => click(page, 'arm');
  },
  /** "Pause" by mouse and by Space, repeatedly, also after the stop. */
  async pause(all) {
    const page = await openConsole(all);
    const box = await until('the button to pause', () => page.locator('[data-testid=pause]').boundingBox());
    const every_ms = 60 + 200 * all.random();
    return () => {
      let going = true;
      const pressing = (async () => {
        while (going) {
          if (all.random() < 0.5) await page.mouse.click(box.x + box.width / 2, box.y + box.height / 2);
          else await page.keyboard.press('Space');
          await sleep(every_ms);
        }
      })();
      pressing.catch(() => {});  // errors are reported where it is awaited
      return async () => {
        await sleep(1500);
        going = false;
        await pressing;
      };
    };
  },
  async reconnect(all) {
    const page = await openGame(all);
    const after_ms = 800 * all.random();
    return async () => {
      await pressStart(page);
      await sleep(after_ms);
      await page.reload({ waitUntil: 'commit' });
    };
  },
  /** A page that hangs while it starts, and continues long after the stop. */
  async hidden(all) {
    const page = await openGame(all);
    const cdp = await page.context().newCDPSession(page);
    const after_ms = 600 * all.random();
    return async () => {
      await pressStart(page);
      await sleep(after_ms);
      await cdp.send('Page.setWebLifecycleState', { state: 'frozen' });
      return async () => {
        await sleep(500);
        await cdp.send('Page.setWebLifecycleState', { state: 'active' });
      };
    };
  },
  async twoConsoles(all) {
    const pages = [await openConsole(all), await openConsole(all)];
    const what = pages.map(() => (all.random() < 0.5 ? 'arm' : 'load'));
    const between_ms = 300 * all.random();
    return async () => {
      await click(pages[0], what[0]);
      await sleep(between_ms);
      if (!all.stopped) await click(pages[1], what[1]);
    };
  },
};
const AT_THE_GAME = ['start', 'reconnect', 'hidden'];

async function oneMoment(all, watcher, name) {
  const { runState } = await watcher.now();
  const stopped = runState === STOPPED;  // the game has no Start then
  if (name === 'pause' || (stopped && AT_THE_GAME.includes(name)) || all.random() < 0.3) {
    // A therapist starts it and leaves: a game loads and starts nothing while a therapist is there.
    const page = await openConsole(all);
    await page.click('[data-testid=arm]:enabled');
    await watcher.rendering();
    await watcher.pass(100);  // nothing starts for a therapist who leaves before the first tick
    await page.context().close();
    all.opened.splice(all.opened.indexOf(page), 1);
  }
  const press = await SCRIPTS[name](all);
  const { endings: before } = await watcher.now();
  await runStates(watcher);
  const pressed = press();
  await sleep(2500 * all.random());
  all.stopped = true;
  if (all.game && all.random() < 0.5) await click(all.game, 'stop');
  else await watcher.page.keyboard.press('Escape');
  const afterwards = await pressed;
  await watcher.until('the stop shown', (now) => now.endings > before, { every_ms: 10 });
  await afterwards?.();
  await watcher.until('stopped', (now) => now.runState === STOPPED);
  await watcher.pass(NOTHING_FOR_TICKS);
  const states = await runStates(watcher);
  const again = states.filter((state) => state.runState === RENDERING && state.endings > before);
  expect(again.length === 0, `it renders again: ${JSON.stringify(states)}`);
  const now = await watcher.now();
  expect(now.runState === STOPPED && now.sent.every((effort) => Math.abs(effort) < 1e-6), `state ${now.runState}, efforts ${now.sent}`);
  return states.some((state) => state.runState === RENDERING);
}

export async function stopsAtRandomMoments(t) {
  const seed = Number(process.env.WHOLEHAND_SEED ?? 20251120);
  const random = draws(seed);
  const names = Object.keys(SCRIPTS);
  let program = null;
  let watcher = null;
  let rendered = 0;
  for (let moment = 0; moment < MOMENTS; moment += 1) {
    // A run that has never rendered waits for the game's Start; a stopped one, for a console.
    if (program === null || random() < 0.4) {
      await watcher?.page.context().close();
      await program?.stop();
      program = await t.program();
      watcher = await openWatcher(t.plain, program.url, { role: 'watcher' });
      await keepRunStates(watcher);
    }
    const name = names[(moment + seed) % names.length];
    const all = { browser: t.plain, url: program.url, random, opened: [], game: null, stopped: false };
    try {
      rendered += await oneMoment(all, watcher, name);
    } catch (error) {
      throw new Error(`moment ${moment} (${name}, WHOLEHAND_SEED=${seed}): ${error.message}`, { cause: error });
    }
    for (const page of all.opened) await page.context().close();
  }
  return `${MOMENTS} stops, ${rendered} of them of something that rendered: nothing started again`;
}
