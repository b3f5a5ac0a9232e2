// Unexpected actions of a person, a page or a machine: play and Stop continue, and every refusal is explained.
import { loadavg } from 'node:os';
import { expect, expectAccessible, openPage, pageUrl, until } from './browser.mjs';
import { GOES_ON, openGame, pressStart } from './checks.mjs';
import { playOneDrink } from './key_player.mjs';
import { start, startProgram } from './program.mjs';
import { openWatcher } from './watcher.mjs';

const instruction = (page) => page.locator('.say').first().innerText();

/** The page is reloaded repeatedly in play: a press continues the play, and Stop stops. */
export async function reloadedPagePlaysOn(t) {
  const watcher = await t.watcher();
  const game = await openGame(t.plain, watcher.url, {}, { init: GOES_ON });
  for (let k = 0; k < 5; k += 1) {
    await watcher.steered();
    await watcher.pass(2000);
    await game.reload({ waitUntil: 'commit' });
    await pressStart(game);
  }
  await watcher.steered();
  await game.click('[data-testid=stop]');
  await watcher.neutral();
  await game.waitForSelector('body[data-state=stopped]');
  return 'loaded anew five times while it played: Start played on, Stop stopped';
}

/** The second player is informed, presses further, and takes nothing; both may stop. */
export async function twoPlayersDoNotFight(t) {
  const watcher = await t.watcher();
  const first = await openGame(t.plain, watcher.url, {}, { init: GOES_ON });
  await watcher.steered();
  const second = await openPage(t.plain, pageUrl(watcher.url, '/', { lang: 'en', quality: 'low' }));
  await pressStart(second);
  for (let k = 0; k < 5; k += 1) {
    await second.waitForSelector('body[data-state=watching]');
    await until('the second player told', async () => /Another screen has the controls/.test(await instruction(second)));
    await second.click('[data-testid=play]');
  }
  const lost = await first.evaluate(() => window.wentOn);
  expect(await first.getAttribute('body', 'data-state') !== 'watching', 'the first player was put aside');
  await second.click('[data-testid=stop]');
  await watcher.neutral();
  for (const page of [first, second]) await page.waitForSelector('body[data-state=stopped]');
  return `the second player pressed five times and was told; the first lost the controls ${lost} times; the second one's Stop stopped both`;
}

/** A therapist loads another level while it pours: the flow ends, the page shows the change, and a press plays the new level. */
export async function levelChangedWhileItPours(t) {
  const watcher = await openWatcher(t.plain, (await t.program()).url);
  await watcher.page.selectOption('[data-testid=level]', '1');
  await watcher.page.click('[data-testid=arm]:enabled');
  await watcher.rendering();
  const game = await openGame(t.plain, watcher.url, {}, { init: GOES_ON });
  await watcher.steered();
  let due_tick = 0;
  await watcher.until('it pours', async (now) => {
    if (now.values.flow_l_s > 0) return true;
    if (now.tick > due_tick && now.values.squeeze_n === 0) {
      due_tick = now.tick + 10_000;
      await game.keyboard.press('Space', { delay: 150 });
    }
    return false;
  });
  await watcher.page.selectOption('[data-testid=level]', '2');
  await watcher.page.click('[data-testid=load]');
  await watcher.until('level 2, and nothing flows', (now) => now.level === 2 && now.values.flow_l_s === 0 && now.values.glass_l === 0);
  const shown = await until('the page shows what is', async () => {
    const state = await game.getAttribute('body', 'data-state');
    return ['loading', 'welcome'].includes(state) ? '' : state;
  });
  const words = shown === 'stopped' || shown === 'left' ? await game.locator('.overlay').innerText() : await instruction(game);
  expect(words.trim() !== '', `the page shows "${shown}" without a word`);
  if (shown === 'watching') await game.click('[data-testid=play]');
  await watcher.steered();
  await game.click('[data-testid=stop]');
  await watcher.neutral();
  return `the page said "${words.replace(/\s+/g, ' ').slice(0, 80)}"; a press played level 2, Stop stopped`;
}

/** Records what a screen reader announces: changes in live regions, and the names of dialogs that get the focus. */
const LISTENS = () => {
  window.heard = [];
  const hear = (words) => { if (words && window.heard.at(-1) !== words) window.heard.push(words); };
  const textOf = (ids) => (ids ?? '').split(' ').map((id) => document.getElementById(id)?.textContent ?? '').join(' ').trim();
  addEventListener('DOMContentLoaded', () => {
    new MutationObserver((changes) => {
      const live = new Set(changes.map(({ target }) => (target.nodeType === Node.TEXT_NODE ? target.parentElement : target)?.closest('[aria-live], [role=status], [role=alert]')));
      for (const region of live) if (region) hear(region.innerText.replace(/\s+/g, ' ').trim());
    }).observe(document.body, { childList: true, subtree: true, characterData: true });
    document.addEventListener('focusin', ({ target }) => {
      const dialog = target.closest('[role=dialog], [role=alertdialog]');
      if (dialog) hear(`${dialog.getAttribute('role')}: ${textOf(dialog.getAttribute('aria-labelledby'))} ${textOf(dialog.getAttribute('aria-describedby'))}`.trim());
    });
  });
};

/** A whole drink, and a stop, by announcements only. */
export async function screenReaderHearsADrink(t) {
  const watcher = await openWatcher(t.plain, (await t.program()).url, { role: 'watcher' });
  const game = await openGame(t.plain, watcher.url, {}, { init: [GOES_ON, LISTENS] });
  await playOneDrink(game, watcher);
  await game.waitForSelector('[data-testid=success]');
  await expectAccessible(game, 'a drink that is done');
  await game.click('[data-testid=stop]');
  await game.waitForSelector('body[data-state=stopped]');
  await expectAccessible(game, 'stopped');
  const heard = await game.evaluate(() => window.heard);
  let at = 0;
  for (const words of [/^dialog: Welcome to the bar/, /Reach for the/, /Squeeze gently/, /Let go/, /^dialog: Well done! .+ ready/, /^alertdialog: Stopped The robot no longer pushes/]) {
    const found = heard.findIndex((one, i) => i >= at && words.test(one));
    expect(found >= 0, `a screen reader does not say ${words} in its turn: ${heard.join(' | ')}`);
    at = found + 1;
  }
  return heard.join(' | ').slice(0, 600);
}

/** Large and small screens, upright and on their side, with and without browser zoom [px]. */
const SIZES = [[1280, 800], [1280, 720], [960, 600], [844, 390], [740, 360], [820, 1180], [900, 900], [390, 844], [320, 640]];
const COVERS = ['.playself', '.task', '.meter', '.recorded', '.say b', '.strip .button'];

/** While the computer squeezes: "Play yourself", card, meter and the recording notice are inside the window, and do not overlap. */
export async function watchedPlayIsUncovered(t) {
  const { url } = await startProgram({ ...t, args: ['--level', '4'] });
  const game = await openPage(t.plain, pageUrl(url, '/', { lang: 'fr', quality: 'low' }));
  await game.click('[data-testid=watch]:enabled');
  await game.waitForSelector('body[data-state=watching] [data-testid=play]');
  for (const [width, height] of SIZES) {
    await game.setViewportSize({ width, height });
    await game.waitForFunction(() => !document.querySelector('.meter').hidden);
    const faults = await game.evaluate((selectors) => {
      const seen = selectors.flatMap((selector) => [...document.querySelectorAll(selector)].filter((one) => one.checkVisibility({ visibilityProperty: true }))
        .map((one) => ({ selector: one.dataset.testid ?? selector, one, at: one.getBoundingClientRect() })));
      const beyond = seen.filter(({ at }) => at.left < 0 || at.top < 0 || at.right > innerWidth || at.bottom > innerHeight).map(({ selector }) => `${selector} is beyond the edge`);
      const over = seen.flatMap((a, i) => seen.slice(i + 1).filter((b) => a.one !== b.one && a.at.left < b.at.right && b.at.left < a.at.right && a.at.top < b.at.bottom && b.at.top < a.at.bottom).map((b) => `${a.selector} lies over ${b.selector}`));
      return [...beyond, ...over];
    }, COVERS);
    expect(faults.length === 0, `${width} × ${height}: ${faults.join('; ')}`);
  }
  return `nothing lies over "Play yourself" in ${SIZES.length} windows`;
}

/** On a laptop, a tablet and a telephone nothing of the first card lies below its buttons or beyond its edge, in any language. */
export async function firstCardFits(t) {
  const { url } = await t.program();
  const game = await openPage(t.plain, pageUrl(url, '/', { lang: 'en', quality: 'low' }));
  await game.waitForSelector('[data-testid=start]:enabled');
  for (const [width, height] of [[1280, 720], [1280, 800], [820, 1180], [390, 844]]) {
    await game.setViewportSize({ width, height });
    for (const language of ['de', 'fr', 'en']) {
      await game.click(`[data-lang=${language}]`);
      const beyond = await game.evaluate(() => {
        const card = document.querySelector('.welcome');
        const { left, right } = card.getBoundingClientRect();
        const wide = [...card.querySelectorAll('button, h1, p, b')].filter((one) => one.getBoundingClientRect().right > right || one.getBoundingClientRect().left < left || (one.matches('button') && one.scrollWidth > one.clientWidth + 1));
        return [...wide.map((one) => one.textContent), ...(card.scrollHeight > card.clientHeight + 2 ? [`${card.scrollHeight - card.clientHeight} px below the buttons`] : [])];
      });
      expect(beyond.length === 0, `${width} × ${height}, ${language}: ${beyond.join('; ')}`);
    }
  }
  return 'three languages in four windows';
}

/** In a window of 320 px: every card and the play have all their buttons inside, and Stop is pressed there. */
export async function narrowWindowPlays(t) {
  const watcher = await t.watcher();
  const game = await openPage(t.plain, pageUrl(watcher.url, '/', { lang: 'de', quality: 'low' }), { width: 320, height: 640, init: GOES_ON });
  const fits = async (what) => {
    const beyond = await game.evaluate(() => [...document.querySelectorAll('button, a')].filter((one) => one.checkVisibility()).filter((one) => { const { left, right } = one.getBoundingClientRect(); return left < 0 || right > innerWidth; }).map((one) => one.outerHTML.slice(0, 90)));
    expect(beyond.length === 0, `${what}: beyond the edge of 320 px: ${beyond.join(' ')}`);
    expect(await game.evaluate(() => document.documentElement.scrollWidth) <= 320, `${what} is scrolled sideways`);
  };
  await game.waitForSelector('[data-testid=start]:enabled');
  await fits('the first card');
  await pressStart(game);
  await watcher.steered();
  await fits('the play');
  await game.click('[data-testid=help]');
  await game.waitForSelector('[data-testid=help-card]');
  await fits('the help');
  await game.keyboard.press('Escape');
  await game.click('[data-testid=rest-now]');
  await game.waitForSelector('[data-testid=go-on]:enabled');
  await fits('the rest');
  await game.click('[data-testid=go-on]');
  await watcher.steered();
  await game.click('[data-testid=stop]');
  await game.waitForSelector('body[data-state=stopped]');
  await fits('the stop');
  return 'first card, play, help, rest and stop in 320 px';
}

/** Names of 60 letters are accepted; those of other alphabets are refused with an explanation, before anything is sent. */
export async function namesOfAnyKind(t) {
  const { page } = await openWatcher(t.plain, (await t.program()).url);
  const name = page.locator('[data-testid=profile]');
  const long = 'Wolfeschlegelsteinhausenbergerdorff-Rosenquist-Hunderttausend'.slice(0, 60);
  await name.fill(long);
  await page.click('[data-testid=save-profile]');
  await page.getByText(long).first().waitFor();
  const wide = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
  expect(wide <= 0, `a name of 60 letters scrolls the console sideways by ${wide} px`);
  for (const other of ['Ольга Иванова', '山田太郎', 'محمد', '👩‍🦽', '../../etc/passwd', '<b>x</b>']) {
    await name.fill(other);
    await page.getByText(/Only A to Z/).waitFor();
    expect(await page.isDisabled('[data-testid=save-profile]'), `"${other}" can be saved`);
  }
  return 'a name of 60 letters is kept and shown; six others are refused by words';
}

const KEPT_MIN = Number(process.env.WHOLEHAND_KEPT_MIN ?? 10);
/** With the program and a drawn page they keep two processors busy beyond a load of 8; the figure has the load. */
const LOOPS = 2;

/** Minutes of play by one key, in a drawn game, on a busy machine: the controls are never lost. WHOLEHAND_KEPT_MIN: another number of minutes than 10. */
export async function controlsAreKept(t) {
  const watcher = await t.watcher();
  const game = await openGame(t.drawing, watcher.url, {}, { smooth: true, init: GOES_ON });
  await watcher.steered();
  await game.evaluate(() => { window.wentOn = 0; });
  for (let k = 0; k < LOOPS; k += 1) start('/bin/sh', ['-c', 'while :; do :; done'], { stdio: 'ignore' });
  const ends_ms = Date.now() + 60_000 * KEPT_MIN;
  let drinks = 0, pressed_ms = 0;
  while (Date.now() < ends_ms) {
    const shown = await game.getAttribute('body', 'data-state');
    if (shown === 'success') {
      drinks += 1;
      await game.click('.overlay .go');
      await game.waitForSelector('body:not([data-state=success])');
    } else if ((shown === 'reach' || shown === 'squeeze') && Date.now() - pressed_ms > 8000) {
      pressed_ms = Date.now();
      await game.keyboard.press('Space', { delay: 150 });
    }
    await new Promise((go) => setTimeout(go, 200));
  }
  const lost = await game.evaluate(() => window.wentOn), words = `controls lost ${lost} times in ${KEPT_MIN} minutes, ${drinks} drinks, load ${loadavg()[0].toFixed(1)}`;
  console.log(`figure: ${words}`);
  expect(lost === 0, words);
  return words;
}
