// What a person could do at the pages, one function each. All run against one program.
import { accessibilityFaults, openPage, pageUrl, until } from './browser.mjs';
import { playOneDrink } from './key_player.mjs';

const RENDERING = 1;
const STOPPED = 3;
// What a page and a hand need on a machine that others use too: no figure, only an end of waiting.
const PATIENT_MS = 60_000;

/** Fails with words. */
export function expect(condition, words) {
  if (!condition) throw new Error(words);
}

const axis = (now, name) => now.q[now.axes.indexOf(name)];

/** The game, past its first card, with a person about to play. */
export async function openGame(browser, programUrl, query = {}, options = {}) {
  const page = await openPage(browser, pageUrl(programUrl, '/', { lang: 'en', quality: 'low', ...query }), options);
  await page.waitForSelector('[data-testid=start]:enabled', { timeout: PATIENT_MS });
  await page.click('[data-testid=start]');
  await playing(page);
  return page;
}

/** A browser that gets no processor for 200 ms has lost the controls: on a machine that others use, a person presses "Go on". */
export const GOES_ON = () => {
  window.wentOn = 0;  // how often
  setInterval(() => {
    const button = document.querySelector('[data-testid=take-again]');
    if (button) { window.wentOn += 1; button.click(); }
  }, 500);
};

/** Arming rehearses: until it is done, nothing that the person does moves anything. */
async function playing(page) {
  try {
    await page.waitForSelector('body:not([data-state=welcome]):not([data-state=loading])', { timeout: PATIENT_MS });
  } catch {
    throw new Error(`no play within ${PATIENT_MS / 1000} s; the page says: ${(await page.locator('body').innerText()).replace(/\s+/g, ' ')}`);
  }
}

/** Within 300 ticks it moved by less than half a millimetre along x and y. */
async function handAtRest(watcher, words) {
  let before = { tick: -Infinity, place: [NaN, NaN] };
  return watcher.until(words, (now) => {
    if (now.tick < before.tick + 300) return false;
    const place = [axis(now, 'x'), axis(now, 'y')];
    const rests = place.every((at, i) => Math.abs(at - before.place[i]) < 5e-4);
    before = { tick: now.tick, place };
    return rests;
  }, { within_ms: PATIENT_MS });
}

/** Nearer to the person than this the cursor chooses the lane (guide.ts): a fifth of the way to the row [m along x]. */
const DRAWN_BACK_M = -0.06;

export async function mouseMovesTheHand(game, watcher) {
  await watcher.until('rendering', (now) => now.runState === RENDERING);
  const { width, height } = game.viewportSize();
  const box = await game.locator('#play').boundingBox();
  const to = async (part) => {
    await game.mouse.move(box.x + box.width * part, box.y + box.height / 2, { steps: 12 });
    await new Promise((resolve) => setTimeout(resolve, 100));
  };
  expect(box && box.width > width / 2 && box.height > height / 2, 'the picture does not fill the page');
  // Left in the picture is left of the person, y positive; what the cursor is on is what the palm goes in front of.
  await to(0.5);
  await watcher.until('the person steering', (now) => now.steering === 1, { within_ms: PATIENT_MS });
  // The wheel counts from where the hand is. Taken over, the hand may stand at a bottle, which it leaves towards the
  // person only; and a page that lost the controls begins anew: whoever plays moves and turns again.
  const turnUntil = (what, part, by_px, reached) => {
    let due_ms = 0;
    return watcher.until(what, async (now) => {
      if (reached(now)) return true;
      if (Date.now() >= due_ms) {
        due_ms = Date.now() + 5000;
        await to(part + 0.01);  // a cursor that stands still is nobody's
        await to(part);
        for (let k = 0; by_px !== 0 && k < 2; k += 1) await game.mouse.wheel(0, by_px);
      }
      return false;
    }, { within_ms: PATIENT_MS });
  };
  // The virtual patient may have finished the level before the page was there: the therapist begins it anew.
  await watcher.page.click('[data-testid=restart]', { timeout: PATIENT_MS });
  await watcher.until('the level begun anew', (now) => now.values.score === 0, { within_ms: PATIENT_MS });
  await new Promise((resolve) => setTimeout(resolve, 2000));   // it sets out
  await turnUntil('the hand drawn back from the row', 0.5, 100, (now) => axis(now, 'x') < DRAWN_BACK_M);
  const right = await handAtRest(watcher, 'the hand at rest before the cursor');
  await turnUntil('the hand farther left, as the cursor', 0.3, 0, (now) => axis(now, 'y') > axis(right, 'y') + 0.02);
  const before = await handAtRest(watcher, 'the hand at rest farther left');
  const away = await turnUntil('the device farther from the person after the wheel', 0.3, -100, (now) => axis(now, 'x') > axis(before, 'x') + 0.01);
  await turnUntil('the device nearer to the person after the wheel', 0.3, 100, (now) => axis(now, 'x') < axis(away, 'x') - 0.005);
  return `the hand followed the cursor to the left, steered by ${before.steering === 1 ? 'the person' : 'nobody'}`;
}

export async function keysFillAGlass(game, watcher) {
  const { now, taken_s } = await playOneDrink(game, watcher, { within_s: 150 });
  const { glass_l: glass, asked_l: asked, tolerance_l: tolerance, score } = now.values;
  const drink = glass > 0 ? glass : now.values['layer_l/0'];
  expect(drink > 0.02, `the glass holds ${1000 * drink} ml`);
  await game.waitForSelector('[data-testid=success]', { timeout: PATIENT_MS });
  return `a glass of ${(1000 * drink).toFixed(1)} ml (asked ${(1000 * asked).toFixed(0)} ± ${(1000 * tolerance).toFixed(0)}) in ${taken_s.toFixed(1)} s, score ${score.toFixed(0)}`;
}

/** With help "none" nothing brings the hand to the bottle: whoever plays goes in beside it. */
export async function keysFillAGlassAlone(browser, programUrl, watcher) {
  await watcher.page.waitForSelector('[data-testid=holder]:has-text("free")', { timeout: PATIENT_MS });
  const game = await openGame(browser, programUrl, { help: 'none', level: '1' }, { init: GOES_ON });
  try {
    const { now, taken_s } = await playOneDrink(game, watcher, { within_s: 240, help: 'none' });
    return `score ${now.values.score.toFixed(0)} in ${taken_s.toFixed(1)} s`;
  } finally {
    await game.context().close();
  }
}

/** From the console, which does not hold the controls: any client may stop. */
export async function emergencyStopEndsAllEffort(watcher, game) {
  const { page } = watcher;
  await page.bringToFront();
  const asked_ms = Date.now();
  await page.keyboard.press('Escape');
  await watcher.until('stopped, with every effort at neutral', (n) => n.runState === STOPPED && n.sent.every((effort) => Math.abs(effort) < 1e-6), { within_ms: 5000, every_ms: 20 });
  const took_ms = Date.now() - asked_ms;
  await until('the console says so', async () => (await page.getAttribute('body', 'data-state')) === 'stopped');
  await game.waitForSelector('text=/Stopped/', { timeout: PATIENT_MS });
  return `neutral ${took_ms} ms after the key (the page looked every 20 ms)`;
}

/** While the game has the controls, the console's limit holds all the same. */
export async function therapistSetsALimit(watcher) {
  const { page } = watcher;
  await page.waitForSelector('[data-testid=held]:not([hidden])', { timeout: PATIENT_MS });
  const name = 'effort_limit_hand_tip_n';
  const input = page.locator(`#parameter-${name}`);
  const before = await input.inputValue();
  const set = async (value) => {
    await input.fill(value);
    await input.press('Enter');
    await until(`a limit of ${value} N`, () => page.evaluate(([wanted, n]) => {
      const { state, scene } = window.wholehandNow;
      return Math.abs(state.parameters[scene.parameters.findIndex((p) => p.name === wanted)] - n) < 1e-4;
    }, [name, Number(value)]), { within_ms: PATIENT_MS });
  };
  await set('5');
  await set(before);
  return `5 N and back to ${before} N`;
}

/** From the console, with nobody at the controls: another level, and the virtual patient plays it. */
export async function anotherLevelIsLoaded(watcher) {
  const { page } = watcher;
  await page.waitForSelector('[data-testid=holder]:has-text("free")', { timeout: PATIENT_MS });
  await page.selectOption('[data-testid=level]', '3');
  await page.click('[data-testid=load]');
  await watcher.until('level 3', (now) => now.level === 3, { within_ms: PATIENT_MS });
  await page.waitForSelector('[data-testid=holder]:has-text("free")', { timeout: PATIENT_MS });
  const now = await watcher.until('the virtual patient playing it', (n) => n.runState === RENDERING && n.values.steps > 1, { within_ms: PATIENT_MS });
  return `level 3, ${now.dispensers.length} dispensers; the controls are free again`;
}

/** A number outside its range never leaves the page. */
export async function outOfRangeIsSaid(watcher) {
  const { page } = watcher;
  const input = page.locator('#parameter-damping_decay_s');
  const before = await input.inputValue();
  await input.fill('99');
  await input.press('Enter');
  const refusal = page.locator('#parameter-damping_decay_s-refusal');
  await refusal.waitFor({ state: 'visible', timeout: PATIENT_MS });
  expect((await input.inputValue()) === before, 'the value was not put back');
  return `"${await refusal.textContent()}"`;
}

export async function reconnects(game, watcher, program, restart) {
  const before = await watcher.now();
  const pages = [game, watcher.page];
  for (const page of pages) page.cutOff = true;
  await program.stop('SIGKILL');
  for (const page of pages) {
    await page.waitForSelector('text=/Connection lost/', { timeout: PATIENT_MS });
  }
  const stopButton = watcher.page.locator('[data-testid=emergency-stop]');
  expect(await stopButton.isDisabled(), 'the console promises a stop that cannot act');
  const next = await restart();
  const back_ms = Date.now();
  await watcher.until('states of the new program', (now) => now.shown !== 'lost' && now.tick !== before.tick, { within_ms: PATIENT_MS });
  await until('the game without the lost card', async () => !(await game.isVisible('text=/Connection lost/')), { within_ms: PATIENT_MS });
  const took_ms = Date.now() - back_ms;
  // What was asked for while the program was away has failed by now.
  await new Promise((resolve) => setTimeout(resolve, 1000));
  for (const page of pages) page.cutOff = false;
  return { next, words: `both pages live ${took_ms} ms after the program was back` };
}

/** Four views of the pages, none with a serious or critical fault. */
export async function pagesAreAccessible(browser, programUrl) {
  const views = [
    ['game, welcome', '/', {}, null],
    ['game, watching', '/', {}, '[data-testid=watch]'],
    ['game, help and settings', '/', {}, '[data-testid=help]'],
    ['console, light', '/console', { theme: 'light' }, null],
    ['console, dark, German, tables', '/console', { theme: 'dark', lang: 'de' }, '[data-testid=tables]'],
  ];
  const found = [];
  for (const [name, path, query, click] of views) {
    const page = await openPage(browser, pageUrl(programUrl, path, { lang: 'en', quality: 'low', ...query }));
    await page.waitForSelector(path === '/' ? '[data-testid=start]' : '.plot', { timeout: PATIENT_MS });
    if (click) await page.click(click);
    await new Promise((resolve) => setTimeout(resolve, 1500));
    found.push(...(await accessibilityFaults(page)).map((fault) => `${name}: ${fault}`));
    await page.context().close();
  }
  expect(found.length === 0, found.join('\n'));
  return `${views.length} views, no serious or critical fault`;
}

/** Processor time that scripts of the page's main thread have used: others on the machine do not change it. */
async function scriptCpu_s(page) {
  page.metrics ??= await page.context().newCDPSession(page);
  await page.metrics.send('Performance.enable', { timeDomain: 'threadTicks' });
  const { metrics } = await page.metrics.send('Performance.getMetrics');
  return metrics.find(({ name }) => name === 'ScriptDuration').value;
}

/** Processor time so far of the browser's process that draws [ms]. */
async function drawing_ms(session) {
  const { processInfo } = await session.send('SystemInfo.getProcessInfo');
  return 1000 * processInfo.filter(({ type }) => type === 'GPU').reduce((sum, { cpuTime }) => sum + cpuTime, 0);
}

/** A machine that others use draws fewer than this a second, while the program tells as much as ever. */
const FRAMES_HZ = 15;

/** Frames a second in low quality, and what a frame takes of the processors: its script and its drawing. */
export async function cost(browser, programUrl, path, { seconds = 12, cutOff = false } = {}) {
  const session = await browser.newBrowserCDPSession();
  const page = await openPage(browser, pageUrl(programUrl, path, { lang: 'en', quality: 'low', theme: 'light' }), { cutOff });
  const watch = page.locator('[data-testid=watch]');
  if (path === '/') {
    await watch.waitFor({ timeout: PATIENT_MS });
    await watch.click();
  }
  await page.waitForFunction(() => window.wholehandStats?.quality === 'low', null, { timeout: PATIENT_MS });
  // The hand is made with its first states.
  await new Promise((resolve) => setTimeout(resolve, 5000));
  const scriptBefore_s = await scriptCpu_s(page);
  const before_ms = await drawing_ms(session);
  const frames = await page.evaluate(() => window.wholehandStats.frames);
  await new Promise((resolve) => setTimeout(resolve, 1000 * seconds));
  const stats = await page.evaluate(() => ({ ...window.wholehandStats }));
  const drawn = stats.frames - frames;
  const drawing = ((await drawing_ms(session)) - before_ms) / Math.max(1, drawn);
  const cpu_ms = (1000 * ((await scriptCpu_s(page)) - scriptBefore_s)) / Math.max(FRAMES_HZ * seconds, drawn);
  const faults = page.faults;
  await page.context().close();
  return { fps: drawn / seconds, drawing_cpu_ms_mean: drawing, script_cpu_ms_mean: cpu_ms, script_ms_p95: stats.script_ms_p95, state_age_ms_p99: stats.state_age_ms_p99, faults };
}

/** Frames a second of a game beside a console that draws its picture, too, each in a browser of its own. */
export async function gameBesideAConsole(browser, openBrowser, programUrl, options) {
  const another = await openBrowser();
  try {
    const console3d = await openPage(another, pageUrl(programUrl, '/console', { lang: 'en', quality: 'low', role: 'watcher' }));
    await console3d.waitForFunction(() => window.wholehandStats?.quality === 'low', null, { timeout: PATIENT_MS });
    const framesOf = () => console3d.evaluate(() => window.wholehandStats.frames);
    const [before, began_ms] = [await framesOf(), Date.now()];
    const game = await cost(browser, programUrl, '/', options);
    const console_fps = (1000 * ((await framesOf()) - before)) / (Date.now() - began_ms);
    return { ...game, console_fps, faults: [...game.faults, ...console3d.faults] };
  } finally {
    await another.close();
  }
}

/** A camera that is refused, or not there, is said in words, and the game can still be begun. */
export async function missingCameraIsSaid(openBrowserWith, programUrl) {
  const said = [];
  const cases = [
    ['refused', ['--use-fake-device-for-media-stream'], [], /refused/],
    ['absent', [], ['camera'], /No camera/],
  ];
  for (const [name, args, permissions, words] of cases) {
    const browser = await openBrowserWith(args);
    try {
      const page = await openPage(browser, pageUrl(programUrl, '/', { lang: 'en' }), { permissions });
      await page.click('[data-way=webcam]', { timeout: PATIENT_MS });
      await page.click('[data-testid=start]');
      const text = page.getByText(words).first();
      await text.waitFor({ state: 'visible', timeout: PATIENT_MS });
      said.push(`${name}: "${await text.textContent()}"`);
    } finally {
      await browser.close();
    }
  }
  return said.join(' ');
}

/** One finger drags the hand, the large button squeezes. */
export async function touchMovesAndSqueezes(browser, programUrl, watcher) {
  // The page before has just closed: its controls come free when the program notices.
  await watcher.page.waitForSelector('[data-testid=holder]:has-text("free")', { timeout: PATIENT_MS });
  // With full help there are no buttons: a tap does it all.
  const page = await openPage(browser, pageUrl(programUrl, '/', { lang: 'en', quality: 'low', help: 'some' }), { hasTouch: true });
  let at = {};
  try {
    await page.waitForSelector('[data-testid=start]:enabled', { timeout: PATIENT_MS });
    await page.tap('[data-testid=start]');
    await playing(page);
    await watcher.until('rendering', (now) => now.runState === RENDERING, { within_ms: PATIENT_MS });
    const touch = await page.context().newCDPSession(page);
    const send = (type, points) => touch.send('Input.dispatchTouchEvent', { type, touchPoints: points });
    const wait = (ms) => new Promise((resolve) => setTimeout(resolve, ms));
    await send('touchStart', [{ x: 640, y: 340 }]);
    await watcher.until('the person steering', (now) => now.steering === 1, { within_ms: PATIENT_MS });
    // The virtual patient may have been at a dispenser: draw back first, as a person has to.
    for (let k = 1; k <= 20; k += 1) {
      await send('touchMove', [{ x: 640, y: 340 + 22 * k }]);
      await wait(60);
    }
    await watcher.until('the hand drawn back', (now) => axis(now, 'x') < -0.06, { within_ms: PATIENT_MS });
    const before = axis(await watcher.now(), 'y');
    const goal_px = before > 0 ? 1 : -1;
    at = { before, goal_px };
    for (let k = 1; k <= 10; k += 1) {
      await send('touchMove', [{ x: 640 + 12 * k * goal_px, y: 780 }]);
      await wait(60);
    }
    // 120 px are more than half of the half range, which is 30 % of the picture's height.
    await watcher.until('the device following the finger', (now) => (before - axis(now, 'y')) * goal_px > 0.03, { within_ms: PATIENT_MS });
    await send('touchEnd', []);
    const fingers = axis(await watcher.now(), 'finger_flexion');
    const button = await page.locator('[data-testid=touch-squeeze]').boundingBox();
    await send('touchStart', [{ x: button.x + button.width / 2, y: button.y + button.height / 2 }]);
    await watcher.until('the hand closing', (now) => axis(now, 'finger_flexion') > fingers + 0.3, { within_ms: PATIENT_MS });
    await send('touchEnd', []);
    return 'one finger moved the hand, the button closed it';
  } catch (error) {
    const { q, steering, runState, values } = await watcher.now();
    const said = (await page.locator('body').innerText()).replace(/\s+/g, ' ').slice(0, 1500);
    throw new Error(`${error.message}; ${JSON.stringify(at)} q ${q.map((v) => v.toFixed(3)).join(' ')}, steering ${steering}, state ${runState}, stage ${values.stage}; the page says: ${said}`);
  } finally {
    await page.context().close();
  }
}
