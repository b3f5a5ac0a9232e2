// Behaviour when the person leaves the page, the page hangs, or the program does not answer.
import { expect, openPage, pageUrl, until } from './browser.mjs';
import { GOES_ON, openGame } from './checks.mjs';
import { FULL } from './harness.mjs';
import { RENDERING } from './watcher.mjs';

const UNATTENDED_S = 900;  // docs/protocol.md
/** Bit of WorldState.faults: the exercise's effort is off, since its owner is silent. */
const OWNER_SILENT = 1 << 20;

const fingers = (now) => now.q[now.axes.indexOf('finger_flexion')];
const boxOf = (locator) => locator.evaluate((element) => {
  const { left, top, right, bottom } = element.getBoundingClientRect();
  return { left, top, right, bottom };
});

/** From now on the watcher's page counts how often the exercise's effort goes off or returns, and who holds the controls. */
async function countSwitches(watcher) {
  await watcher.page.evaluate((bit) => {
    const silent = () => (window.wholehandNow.state.faults & bit) !== 0;
    clearInterval(window.switchTimer);
    window.switches = [];
    window.free_ms = 0;
    let before = silent();
    window.switchTimer = setInterval(() => {
      if (!window.free_ms && document.querySelector('[data-testid=holder]').textContent.includes('free')) window.free_ms = Date.now();
      if (silent() === before) return;
      before = !before;
      window.switches.push({ silent: before, at_ms: Date.now() });
    }, 10);
  }, OWNER_SILENT);
  const switches = () => watcher.page.evaluate(() => window.switches);
  switches.free_ms = () => watcher.page.evaluate(() => window.free_ms);
  return switches;
}

/**
 * Simulates a hidden page. Headless Chromium hides none: the page gets the event that browsers send, and
 * its timers run once a second, like those of a hidden page. Workers are unaffected, as in browsers.
 */
const EMULATED = () => {
  let hidden = false;
  let slow = false;
  Object.defineProperty(Document.prototype, 'hidden', { get: () => hidden });
  Object.defineProperty(Document.prototype, 'visibilityState', { get: () => (hidden ? 'hidden' : 'visible') });
  const every = window.setInterval.bind(window);
  window.setInterval = (run, ms, ...more) => {
    let ran_ms = -Infinity;
    return every(() => {
      if (slow && performance.now() - ran_ms < 990) return;
      ran_ms = performance.now();
      run(...more);
    }, ms);
  };
  const frame = window.requestAnimationFrame.bind(window);
  window.requestAnimationFrame = (run) => frame(function later(time) { if (slow) frame(later); else run(time); });
  window.emulate = (state) => {
    slow = state !== 'shown';
    if ((state === 'hidden') === hidden) return;
    hidden = !hidden;
    document.dispatchEvent(new Event('visibilitychange'));
  };
};

/** A playing game with the hand closed by the key, whose page can be hidden. */
async function withClosedHand(t) {
  const watcher = await t.watcher();
  const page = await openGame(t.plain, watcher.url, { help: 'none' }, { init: [EMULATED, GOES_ON] });
  // A page that lost the controls on a shared machine starts again, and so does the person.
  const hold = (key, what, reached) => {
    let due_tick = 0;
    return watcher.until(what, async (now) => {
      if (now.tick >= due_tick) {
        due_tick = now.tick + 4000;
        await page.keyboard.up(key);
        await page.keyboard.down(key);
      }
      return reached(now);
    });
  };
  // Moves away from the dispensers first: a gripped object would hold the fingers open.
  await hold('ArrowDown', 'the hand drawn back', (now) => now.q[now.axes.indexOf('x')] < -0.06);
  await page.keyboard.up('ArrowDown');
  await hold('Space', 'the hand closed', (now) => fingers(now) > 2);
  await page.evaluate(() => { window.letGo = true; });
  return { watcher, page, switches: await countSwitches(watcher) };
}

/** Half bent is 65 degrees, 1.13 rad. */
const open = (now) => fingers(now) < 1.3;
const cardIn = async (page, selector) => (await (await page.waitForSelector(selector)).innerText()).replace(/\s+/g, ' ');
const expectSwitches = (seen, count) => expect(seen.length === count && (count === 0 || seen.at(-1).silent === (count % 2 === 1)), `the effort changed ${seen.length} times, not ${count}: ${JSON.stringify(seen)}`);

/**
 * Timers at 1 Hz without an event for hiding, as in the power saving of some browsers: the worker continues the
 * heartbeats. Then a key is released behind a card, which must open the hand.
 */
export async function slowTimersKeepTheControls(t) {
  const { watcher, page, switches } = await withClosedHand(t);
  await page.evaluate(() => window.emulate('slow'));
  await watcher.pass(FULL ? 8000 : 4000);
  expectSwitches(await switches(), 0);
  await page.evaluate(() => window.emulate('shown'));
  await page.click('[data-testid=help]');
  await page.waitForSelector('[data-testid=help-card]');
  await page.keyboard.up('Space');
  const now = await watcher.until('the hand open behind the card', open);
  return `no change of the effort; fingers at ${fingers(now).toFixed(2)} rad behind the help`;
}

/** The page is hidden for a long time: it loses the controls once, and reports it; then it is visible, and used again. */
export async function hiddenPageLetsGoOnce(t, hidden_s) {
  const { watcher, page, switches } = await withClosedHand(t);
  const left_ms = await page.evaluate(() => { window.emulate('hidden'); return Date.now(); });
  await page.keyboard.up('Space');
  await watcher.until('the hand open', open);
  await watcher.pass(1000 * hidden_s);
  await page.evaluate(() => window.emulate('shown'));
  // Nobody held the controls for so long that the client's run was stopped, and the page reports that.
  const stopped = hidden_s > UNATTENDED_S;
  const words = await cardIn(page, stopped ? '.stopped' : '[data-testid=left]');
  expect(stopped || (/left this page/.test(words) && /given back/.test(words)), `the card says "${words}"`);
  await watcher.pass(1500);
  const seen = await switches();
  expectSwitches(seen, 1);
  const [free_ms, out_ms] = [(await switches.free_ms()) - left_ms, seen[0].at_ms - left_ms];
  // 200 ms and a frame on an idle machine; ControlTimeoutsTest.SilentHolder_IsSuspendedAfter200msAndResumesWithinASecond tests it in
  // simulated time. This test only distinguishes it from the 5 s after which nobody holds the controls in any case.
  expect(free_ms <= 4000 && out_ms <= 4000, `controls free after ${free_ms} ms, effort out after ${out_ms} ms`);
  const reported = `controls free after ${free_ms} ms, effort out after ${out_ms} ms and not back in ${hidden_s} s; "${words}"`;
  if (stopped) return reported;
  // It continues only by a press.
  await page.click('[data-testid=take-again]');
  await watcher.steered();
  await until('the effort back', async () => (await switches()).length === 2);
  return reported;
}

/** A page that draws for 8 s says so: the effort fades, it keeps the controls, and goes on without a press. */
export async function busyPageGoesOn(t) {
  const { watcher, page, switches } = await withClosedHand(t);
  const wentOn = await page.evaluate(() => window.wentOn);
  await page.evaluate(() => { for (const end_ms = Date.now() + 8000; Date.now() < end_ms;); });
  await until('the effort back', async () => (await switches()).length % 2 === 0 && (await switches()).length > 0);
  await watcher.steered();
  expect(await switches.free_ms() === 0, 'the controls were lost');
  expect(await page.locator('[data-testid=left]').count() === 0 && await page.evaluate(() => window.wentOn) === wentOn, 'it asks for a press');
  const [out, back] = await switches();
  return `effort out for ${back.at_ms - out.at_ms} ms while the page drew for 8 s; it went on without a press`;
}

/** Hidden for less than 2 s: the effort fades as always, and the play goes on without a press. */
export async function shortlyHiddenPageGoesOn(t) {
  const { watcher, page, switches } = await withClosedHand(t);
  await page.evaluate(() => window.emulate('hidden'));
  await until('the effort out', async () => (await switches()).length === 1);
  await page.evaluate(() => window.emulate('shown'));
  await until('the effort back', async () => (await switches()).length === 2);
  await page.keyboard.up('Space');
  await page.keyboard.down('Space');
  await watcher.until('the hand closed again', (now) => fingers(now) > 2);
  expect(await page.locator('[data-testid=left]').count() === 0, 'it asks for a press');
  expect(await switches.free_ms() === 0, 'the controls were lost');
  return 'the effort went out and came back, and the key closed the hand again';
}

/** After a playing page has vanished nothing pushes until somebody presses something; watching is sufficient. */
export async function watchingBringsThePlayBack(t) {
  const watcher = await t.watcher();
  const played = await openGame(t.plain, watcher.url);
  await watcher.steered();
  await played.context().close();
  const faded = (now) => (now.faults & OWNER_SILENT) !== 0;
  await watcher.until('the effort out', faded);
  const page = await openPage(t.plain, pageUrl(watcher.url, '/', { lang: 'en', quality: 'low' }));
  await page.waitForSelector('[data-testid=watch]:enabled');
  await watcher.pass(1000);
  expect(faded(await watcher.now()), 'a page that is only opened brings the effort back');
  // A slow page draws its first picture for seconds after the press, and reads no answer before.
  await page.evaluate(() => {
    document.querySelector('[data-testid=watch]').click();
    for (const end_ms = Date.now() + 4500; Date.now() < end_ms;);
  });
  await watcher.until('the virtual patient playing', (now) => !faded(now) && now.steering === 0 && now.runState === RENDERING);
  return 'the virtual patient plays again after a press of "Watch first" on a page that then drew for 4.5 s';
}

/** Simulates a slow machine: the connection opens when the test says so. */
const LATE_LINE = () => {
  const { postMessage } = Worker.prototype;
  const kept = [];
  Worker.prototype.postMessage = function later(...args) { kept.push(() => postMessage.apply(this, args)); };
  window.openLine = () => {
    Worker.prototype.postMessage = postMessage;
    kept.forEach((post) => post());
  };
};

/** Start is enabled only when it acts: no press on it is lost. */
export async function startWaitsForTheConnection(t) {
  const watcher = await t.watcher();
  const game = await openPage(t.plain, pageUrl(watcher.url, '/', { lang: 'en', quality: 'low' }), { init: LATE_LINE });
  await game.waitForSelector('[data-testid=start]:disabled');
  const words = await game.locator('.welcome .actions p').innerText();
  expect(words === 'Connecting …', `beside the button that cannot be pressed it says "${words}"`);
  await game.evaluate(() => window.openLine());
  await game.click('[data-testid=start]');  // waits until it is enabled, presses once
  await watcher.steered();
  return `"${words}" beside Start, then one press began the play`;
}

/** Whether a press in the middle of this button reaches it. */
const reachable = (locator) => locator.evaluate((element) => {
  const { left, top, width, height } = element.getBoundingClientRect();
  return width > 0 && element.contains(document.elementFromPoint(left + width / 2, top + height / 2));
});

/** With the program suspended: the pages' texts, and the stop acts as soon as possible. */
export async function unconfirmedStopIsReported(t) {
  const watcher = await t.watcher();
  const page = await openGame(t.plain, watcher.url);
  await watcher.rendering();
  const stop = page.locator('[data-testid=stop]');
  const warning = page.locator('[data-testid=stop-unconfirmed]');
  for (const one of [page, watcher.page]) one.cutOff = true;
  watcher.program.signal('SIGSTOP');
  await stop.click();
  await warning.waitFor();
  expect((await warning.innerText()).includes('Stop not confirmed: use the red button'), `it says "${await warning.innerText()}"`);
  await page.waitForSelector('body[data-state=lost]');
  const card = page.locator('[role=alertdialog]');
  for (const [width, height] of [[1280, 800], [390, 844], [844, 390]]) {
    await page.setViewportSize({ width, height });
    await until(`Stop beside the card at ${width} x ${height}`, async () => {
      const [over, under] = [await boxOf(card), await boxOf(stop)];
      return await reachable(stop) && (over.bottom <= under.top || over.right <= under.left);
    });
    await t.picture(page, `stop-unconfirmed-${width}`);
  }
  await page.setViewportSize({ width: 1280, height: 800 });
  const words = await cardIn(page, '[role=alertdialog]');
  expect(!/letting go/.test(words), `the card claims "${words}"`);
  await watcher.page.keyboard.press('Escape');
  await watcher.page.waitForSelector('[data-testid=stop-unconfirmed]:not([hidden])');
  await t.picture(watcher.page, 'stop-unconfirmed-console');
  watcher.program.signal('SIGCONT');
  // A stall of more than half a second is a fault, too (docs/safety.md, kLongGap).
  await watcher.page.waitForSelector('body[data-state=stopped], body[data-state=faulted]');
  await warning.waitFor({ state: 'hidden' });
  await watcher.page.waitForSelector('[data-testid=stop-unconfirmed]', { state: 'hidden' });
  return `"${words}"; stopped when the program went on`;
}
