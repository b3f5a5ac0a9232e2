// A person's basic actions at the pages, one function each.
import { expect, expectAccessible, expectNothingScrollsSideways, openPage, pageUrl, pressUntil, until } from './browser.mjs';
import { playOneDrink } from './key_player.mjs';
import { startProgram } from './program.mjs';
import { openWatcher } from './watcher.mjs';

const axis = (now, name) => now.q[now.axes.indexOf(name)];
const innerText = async (page) => (await page.locator('body').innerText()).replace(/\s+/g, ' ').slice(0, 1500);

/** A browser that gets no processor for 200 ms loses the controls: on a shared machine, the person presses "Go on". */
export const GOES_ON = () => {
  window.wentOn = 0;  // number of presses; none once window.letGo is set
  setInterval(() => {
    const button = document.querySelector('[data-testid=take-again]');
    if (button && !window.letGo) { window.wentOn += 1; button.click(); }
  }, 500);
};

/** Presses Start of the first card. Arming includes a rehearsal: until it is done, no input moves anything. */
export async function pressStart(page, { hasTouch = false } = {}) {
  await pressUntil('the play', page, {
    press: () => page[hasTouch ? 'tap' : 'click']('[data-testid=start]:enabled'),
    acted: () => page.locator('body:not([data-state=welcome]):not([data-state=loading])').count(), refusal: '.welcome .notice',
  }).catch(async (error) => { throw new Error(`${error.message}; the page says: ${await innerText(page)}`); });
}

/** Opens the game and passes its first card. */
export async function openGame(browser, programUrl, query = {}, options = {}) {
  const page = await openPage(browser, pageUrl(programUrl, '/', { lang: 'en', quality: 'low', ...query }), options);
  await pressStart(page, options);
  return page;
}

/** Waits until the hand moved by less than half a millimetre along x and y within 300 ticks. */
async function handAtRest(watcher, words) {
  let before = { tick: -Infinity, place: [NaN, NaN] };
  return watcher.until(words, (now) => {
    if (now.tick < before.tick + 300) return false;
    const place = [axis(now, 'x'), axis(now, 'y')];
    const rests = place.every((at, i) => Math.abs(at - before.place[i]) < 5e-4);
    before = { tick: now.tick, place };
    return rests;
  });
}

/** Nearer to the person than this the cursor chooses the lane (guide.ts): a fifth of the way to the row [m along x]. */
const DRAWN_BACK_M = -0.06;

/** The palm moves in front of the bottle under the cursor: the only game here that needs its picture. */
export async function mouseMovesTheHand(t) {
  const watcher = await t.watcher();
  const game = await openGame(t.drawing, watcher.url, {}, { width: 960, height: 600, init: GOES_ON });
  const { width, height } = game.viewportSize();
  const box = await game.locator('#play').boundingBox();
  const to = (part) => game.mouse.move(box.x + box.width * part, box.y + box.height / 2, { steps: 12 });
  expect(box && box.width > width / 2 && box.height > height / 2, 'the picture does not fill the page');
  // Left in the picture is left of the person, y positive. Both positions are left of the bottle, where help moves the hand.
  const right_part = 0.5, left_part = 0.3;
  await to(right_part);
  await watcher.steered();
  // The wheel is relative to the hand. A hand that was taken over may be at a bottle, which it leaves only towards the
  // person; and a page that lost the controls starts again: the player moves and turns the wheel again.
  const turnUntil = (what, part, by_px, reached) => {
    let due_tick = 0;
    return watcher.until(what, async (now) => {
      if (reached(now)) return true;
      if (now.tick >= due_tick) {
        due_tick = now.tick + 5000;
        await to(part + 0.01);  // a cursor that does not move gives no input
        await to(part);
        for (let k = 0; by_px !== 0 && k < 2; k += 1) await game.mouse.wheel(0, by_px);
      }
      return false;
    });
  };
  // The virtual patient may have finished the level before the page was open: the therapist restarts it.
  await watcher.page.click('[data-testid=restart]');
  await watcher.until('the level begun anew', (now) => now.values.score === 0);
  await turnUntil('the hand drawn back from the row', right_part, 100, (now) => axis(now, 'x') < DRAWN_BACK_M);
  const right = await handAtRest(watcher, 'the hand at rest before the cursor');
  await turnUntil('the hand farther left, as the cursor', left_part, 0, (now) => axis(now, 'y') > axis(right, 'y') + 0.02);
  const before = await handAtRest(watcher, 'the hand at rest farther left');
  const away = await turnUntil('the device farther from the person after the wheel', left_part, -100, (now) => axis(now, 'x') > axis(before, 'x') + 0.01);
  await turnUntil('the device nearer to the person after the wheel', left_part, 100, (now) => axis(now, 'x') < axis(away, 'x') - 0.005);
  return 'the hand followed the cursor to the left, and the wheel';
}

export async function keysFillAGlass(t) {
  const watcher = await t.watcher();
  const game = await openGame(t.plain, watcher.url, {}, { init: GOES_ON });
  const { glass_l: glass, asked_l: asked, tolerance_l: tolerance, score, drink_time_s: took_s, 'layer_l/0': layer } = (await playOneDrink(game, watcher)).values;
  const drink = glass > 0 ? glass : layer;
  expect(drink > 0.01, `the glass holds ${1000 * drink} ml`);
  await game.waitForSelector('[data-testid=success]');
  return `a glass of ${(1000 * drink).toFixed(1)} ml (asked ${(1000 * asked).toFixed(0)} ± ${(1000 * tolerance).toFixed(0)}) in ${took_s.toFixed(1)} s, score ${score.toFixed(0)}`;
}

/** With help "none" nothing moves the hand to the bottle: the player enters beside it. */
export async function keysFillAGlassAlone(t) {
  const watcher = await t.watcher();
  const game = await openGame(t.drawing, watcher.url, { help: 'none', level: '1' }, { smooth: true, init: GOES_ON });
  return `score ${(await playOneDrink(game, watcher, { help: 'none' })).values.score.toFixed(0)}`;
}

/** Time limit in the program's time from the key to neutral, after which a person would not wait. */
const STOPPED_WITHIN_TICKS = 5000;

/** An emergency stop from the console, which does not hold the controls: any client may stop. */
export async function emergencyStopEndsAllEffort(t) {
  const watcher = await t.watcher();
  const game = await openGame(t.plain, watcher.url);
  const { page } = watcher;
  await watcher.steered();
  const { tick } = await watcher.now();
  await page.keyboard.press('Escape');
  const took = (await watcher.neutral()).tick - tick;
  expect(took <= STOPPED_WITHIN_TICKS, `neutral ${took} ticks after the key`);
  await page.waitForSelector('body[data-state=stopped]');
  await game.waitForSelector('text=/Stopped/');
  return `neutral at most ${took} ticks after the key`;
}

/** The program is killed in play: both pages report it, accept a stop, keep one card during their attempts, and reconnect automatically. */
export async function reconnects(t) {
  const program = await t.program();
  const watcher = await openWatcher(t.plain, program.url);
  await watcher.arm();
  await watcher.rendering();
  const game = await openGame(t.plain, program.url);
  const before = await watcher.now();
  for (const page of [game, watcher.page]) page.cutOff = true;
  await program.stop('SIGKILL');
  for (const page of [game, watcher.page]) await page.waitForSelector('text=/Connection lost/');
  expect(await watcher.page.locator('[data-testid=emergency-stop]').isEnabled(), 'a stop that is pressed now would vanish');
  await game.waitForSelector('body[data-state=lost] .message');
  expect(await game.locator('[data-testid=stop-waits]').isVisible(), 'the game does not say that Stop waits for the line');
  await game.evaluate(() => { window.firstCard = document.querySelector('.message'); });
  const lit = () => game.locator('.dots .on').count();
  const first = await lit();
  await until('another attempt', async () => (await lit()) !== first);
  expect(await game.evaluate(() => window.firstCard.isConnected), 'the card was built anew at an attempt');
  await startProgram({ ...t, port: program.port, args: ['--wait'] });
  await watcher.until('states of the new program', (now) => now.shown !== 'lost' && now.tick !== before.tick);
  await game.waitForSelector('text=/Connection lost/', { state: 'hidden' });
  return 'one card through the attempts, which its dots show; both pages live again';
}

/** On a small laptop all controls of a therapist are visible, and no notice moves them. */
async function expectAllOfTheTherapistsViewAtOnce(page) {
  await page.setViewportSize({ width: 1280, height: 720 });
  const below = await page.locator('button, select, output, input, .view, .cause, [data-testid=tally]').evaluateAll((all) => all
    .filter((one) => one.getClientRects().length > 0 && !one.closest('.page, .recordings'))
    .filter((one) => { const { bottom, right } = one.getBoundingClientRect(); return bottom > 720 || right > 1280; }).map((one) => one.outerHTML.slice(0, 80)));
  expect(below.length === 0, `outside of 1280 x 720: ${below.join(' ')}`);
  const top = () => page.locator('main').evaluate((main) => main.getBoundingClientRect().top);
  const before = await top();
  await page.evaluate(() => { for (const notice of document.querySelectorAll('.notice')) notice.hidden = false; });
  expect(await top() === before, 'a notice moved what is below it');
  await page.locator('[data-testid=profile]').fill('Łucja Müller');
  expect(/Only A to Z/.test(await page.locator('.profile label').innerText()), 'a name that is refused says why');
}

/** The smallest supported screen [CSS px], and the same one in a browser at 200 %: its pixels count double. */
const SCREEN = { width: 1280, height: 720 };
const ZOOMED_TWICE = { width: SCREEN.width / 2, height: SCREEN.height / 2 };

/** Every visible text with its size [px]; a page that is rebuilt for its size shows the same texts again. */
const SIZES_OF_TEXT = () => {
  const count = {};
  const saysText = ({ nodeType, data }) => nodeType === Node.TEXT_NODE && data.trim() !== '';
  const seen = [...document.body.querySelectorAll('*')].filter((one) => [...one.childNodes].some(saysText) && one.checkVisibility({ visibilityProperty: true }) && !one.closest('.sr'));
  return Object.fromEntries(seen.map((one) => {
    const words = `${one.tagName} ${one.textContent.trim().slice(0, 40)}`;
    count[words] = (count[words] ?? 0) + 1;
    return [`${words} ${count[words]}`, parseFloat(getComputedStyle(one).fontSize)];
  }));
};

/** Text of a page at 200 % is twice as large (WCAG 2.2, SC 1.4.4), and does not overflow. @return number of texts */
async function expectTextGrowsWithZoom(page, name) {
  const sizesAt = async (screen) => {
    await page.setViewportSize(screen);
    // After two frames the page knows its size.
    await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
    return page.evaluate(SIZES_OF_TEXT);
  };
  const whole = await sizesAt(SCREEN), zoomed = await sizesAt(ZOOMED_TWICE);
  const both = Object.keys(zoomed).filter((words) => words in whole).map((words) => ({ words, ratio: 2 * zoomed[words] / whole[words] }));
  const less = both.filter(({ ratio }) => ratio < 1.99).map(({ words, ratio }) => `"${words}" is ${ratio.toFixed(2)} times as large`);
  expect(both.length > 5, `${name}: only ${both.length} texts are seen where the page is zoomed`);
  expect(less.length === 0, `${name}, zoomed twice: ${less.join('; ')}`);
  const wide = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
  expect(wide <= 0, `${name}, zoomed twice, is scrolled sideways by ${wide} px`);
  await page.setViewportSize(SCREEN);
  return both.length;
}

/** For a person who asked for reduced motion, no style moves anything. */
async function expectStill(page, name) {
  await page.emulateMedia({ reducedMotion: 'reduce' });
  const moves = await page.evaluate(() => document.getAnimations().filter(({ playState }) => playState === 'running').map(({ effect }) => effect.target.outerHTML.slice(0, 80)));
  expect(moves.length === 0, `${name} moves against the wish: ${moves.join(' | ')}`);
  await page.emulateMedia({ reducedMotion: 'no-preference' });
}

/** Views of the pages have no serious or critical accessibility fault. */
export async function pagesAreAccessible(t) {
  const { url } = await t.watcher();
  const views = [
    ['game, watching', '/', {}, '[data-testid=watch]:enabled', 'body[data-state=watching]'],
    ['game, welcome', '/', {}, null, '[data-testid=start]:enabled'],
    ['game, help and settings', '/', {}, '[data-testid=help]', '[data-testid=help-card]'],
    ['console, the therapist’s view', '/console', { theme: 'light' }, null, '[data-testid=big-controls] output'],
    ['console, light', '/console', { theme: 'light', view: 'engineer' }, null, '.plot canvas'],
    ['console, dark, German, tables', '/console', { theme: 'dark', lang: 'de', view: 'engineer' }, '[data-testid=tables]', '[data-testid=tables][aria-pressed=true]'],
    ['replay, of nothing', '/replay', {}, null, '.problem'],
    ['commissioning', '/commission', {}, null, 'main.commission'],
  ];
  let texts = 0;
  for (const [name, path, query, click, shown] of views) {
    const page = await openPage(t.plain, pageUrl(url, path, { lang: 'en', quality: 'low', ...query }));
    if (click) await page.click(click);
    await page.waitForSelector(shown);
    if (name.includes('therapist')) await expectAllOfTheTherapistsViewAtOnce(page);
    await expectAccessible(page, name);
    await expectStill(page, name);
    if (/^game|therapist/.test(name)) texts += await expectTextGrowsWithZoom(page, name);
    if (path !== '/') await expectNothingScrollsSideways(page, name);
    await page.context().close();
  }
  return `${views.length} views, no serious or critical fault; ${texts} texts grow with the zoom`;
}

/** A pad that the test moves. Browsers show one only after its first press. */
const PAD = () => {
  window.pad = null;
  navigator.getGamepads = () => [window.pad];
  window.plugPad = () => {
    window.pad = { index: 0, mapping: 'standard', connected: true, axes: [0, 0, 0, 0], buttons: Array.from({ length: 17 }, () => ({ value: 0, pressed: false })) };
    dispatchEvent(new Event('gamepadconnected'));
  };
};

/** A pad that is plugged in beside the first card is offered there; its stick moves the hand, its button closes it. */
export async function padMovesAndSqueezes(t) {
  const watcher = await t.watcher();
  const page = await openPage(t.plain, pageUrl(watcher.url, '/', { lang: 'en', quality: 'low' }), { init: [PAD, GOES_ON] });
  await page.waitForSelector('[data-testid=start]:enabled');
  expect(await page.locator('[data-way=gamepad]').count() === 0, 'a pad is offered that nobody has');
  await page.evaluate(() => window.plugPad());
  await page.click('[data-way=gamepad]');
  await page.click('[data-help=some]');
  await pressStart(page);
  await watcher.steered();
  // A pad counts after it was at rest: on a page that lost the controls meanwhile, the person lets go and moves it again.
  const hold = async (what, axes, pressed, reached) => {
    let due_tick = 0;
    await watcher.until(what, async (now) => {
      if (reached(now)) return true;
      if (now.tick >= due_tick) {
        due_tick = now.tick + 4000;
        await page.evaluate(() => { window.pad.axes = [0, 0, 0, 0]; window.pad.buttons[0] = { value: 0, pressed: false }; });
        await page.evaluate(() => new Promise((done) => setTimeout(done, 200)));
        await page.evaluate(([to, down]) => { window.pad.axes = [...to, 0, 0]; window.pad.buttons[0] = { value: Number(down), pressed: down }; }, [axes, pressed]);
      }
      return false;
    });
  };
  await hold('the hand drawn back', [0, 1], false, (now) => axis(now, 'x') < DRAWN_BACK_M);
  const before = axis(await watcher.now(), 'y'), to = before > 0 ? 1 : -1;   // positive y is left
  await hold('the hand following the stick', [to, 0], false, (now) => (before - axis(now, 'y')) * to > 0.03);
  const fingers = axis(await watcher.now(), 'finger_flexion');
  await hold('the hand closing', [0, 0], true, (now) => axis(now, 'finger_flexion') > fingers + 0.3);
  return 'offered when it was plugged in; the stick moved the hand, the button closed it';
}

/** One finger drags the hand, the large button squeezes. */
export async function touchMovesAndSqueezes(t) {
  const watcher = await t.watcher();
  // With full help there are no buttons: a tap does everything.
  const page = await openGame(t.plain, watcher.url, { help: 'some' }, { hasTouch: true });
  const touch = await page.context().newCDPSession(page);
  const send = (type, ...points) => touch.send('Input.dispatchTouchEvent', { type, touchPoints: points });
  // One move per frame of the page, like a real finger.
  const drag = async (steps, place) => {
    for (let k = 1; k <= steps; k += 1) {
      await send('touchMove', place(k));
      await page.evaluate(() => new Promise((resolve) => requestAnimationFrame(resolve)));
    }
  };
  try {
    await send('touchStart', { x: 640, y: 340 });
    await watcher.steered();
    // The virtual patient may have been at a dispenser: the hand is drawn back first, as a person must do.
    await drag(20, (k) => ({ x: 640, y: 340 + 22 * k }));
    await watcher.until('the hand drawn back', (now) => axis(now, 'x') < DRAWN_BACK_M);
    const before = axis(await watcher.now(), 'y');
    const goal_px = before > 0 ? 1 : -1;
    await drag(10, (k) => ({ x: 640 + 12 * k * goal_px, y: 780 }));
    // 120 px are more than half of the half range, which is 30 % of the picture's height.
    await watcher.until('the device following the finger', (now) => (before - axis(now, 'y')) * goal_px > 0.03);
    await send('touchEnd');
    const fingers = axis(await watcher.now(), 'finger_flexion');
    const button = await page.locator('[data-testid=touch-squeeze]').boundingBox();
    await send('touchStart', { x: button.x + button.width / 2, y: button.y + button.height / 2 });
    await watcher.until('the hand closing', (now) => axis(now, 'finger_flexion') > fingers + 0.3);
    return 'one finger moved the hand, the button closed it';
  } catch (error) {
    throw new Error(`${error.message}; the page says: ${await innerText(page)}`, { cause: error });
  }
}
