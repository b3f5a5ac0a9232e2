// Permissions while a patient plays: game and console with the real program.
import { expect, openPage, pageUrl, until } from './browser.mjs';
import { openGame } from './checks.mjs';
import { FULL } from './harness.mjs';
import { openWatcher, RENDERING, STOPPED } from './watcher.mjs';

const FINGERS = '#parameter-effort_limit_hand_tip_n';
const TOKENS = { therapist: 'therapist-token-0123', player: 'player-token-01234567' };

const parameter = ({ page }, name) => page.evaluate((wanted) => {
  const { state, scene } = window.wholehandNow;
  return state.parameters[scene.parameters.findIndex((p) => p.name === wanted)];
}, name);

/** A limit at a console: the program's value, the field, the ramp, a refusal, the run state. */
const limitOf = async (watcher) => watcher.page.evaluate((field) => {
  const row = document.querySelector(field).closest('.par');
  const { state, scene } = window.wholehandNow;
  const i = scene.parameters.findIndex((p) => p.name === 'effort_limit_hand_tip_n');
  return JSON.stringify({ holds: state.parameters[i], field: document.querySelector(field).value, says: row.innerText, runState: state.runState, session: state.session });
}, FINGERS);

const limitIs = async (watcher, wanted_n) => {
  try {
    await until(`a limit of ${wanted_n} N`, async () => Math.abs((await parameter(watcher, 'effort_limit_hand_tip_n')) - wanted_n) < 1e-4);
  } catch (late) {
    throw new Error(`${late.message}: ${await limitOf(watcher)}`);
  }
};

const ask = async ({ page }, value_n) => {
  await page.locator(FINGERS).fill(String(value_n));
  await page.locator(FINGERS).press('Enter');
};

/** Selects the number, waits until the ramp of `moves` rewrites it under the selection, and types over it. */
const typeOverMoving = async ({ page }, value_n, moves) => {
  await page.locator(FINGERS).selectText();
  const before = await page.inputValue(FINGERS);
  await moves();
  await until('the number moving', async () => (await page.inputValue(FINGERS)) !== before);
  await page.keyboard.type(String(value_n));
  await page.keyboard.press('Enter');
};

/** A therapist's console for a rendering program, and a playing game. */
async function bothPages(t) {
  const therapist = await t.watcher();
  const game = await openGame(t.plain, therapist.url);
  await therapist.steered();
  return { therapist, game, page: therapist.page };
}

/** Limits, pause and steering, all while the game has the controls. */
export async function therapistLeadsWhileAPatientPlays(t) {
  const { therapist, game, page } = await bothPages(t);
  await page.waitForSelector('[data-testid=holder]:has-text("player")');
  await page.waitForSelector('[data-testid=held]:not([hidden])');
  const before = Number(await page.inputValue(FINGERS));
  for (const limit_n of [5, before]) {
    await ask(therapist, limit_n);
    await limitIs(therapist, limit_n);
  }
  await t.picture(game, 'game-rest-beside-stop');
  await t.picture(page, 'console-while-a-patient-plays');
  await page.click('[data-testid=pause]');
  await game.waitForSelector('text=/Paused/');
  await page.click('[data-testid=resume]');
  await therapist.until('going on', (now) => now.values.paused < 0.5);
  await page.click('[data-testid=take-controls-banner]');
  const shown = await (await game.waitForSelector('[data-testid=left]')).innerText();
  expect(/therapist/.test(shown), `the game says "${shown}"`);
  await page.click('[data-testid=take-controls]');
  await therapist.free();
  await game.click('[data-testid=take-again]');
  await therapist.steered();
  return `a limit of 5 N and back to ${before} N, a pause and the steering, all while the game had the controls`;
}

/** Rest by Esc: shown at once, neutral, and ended only by a press of the same player. */
export async function playerRestsAndGoesOn(t) {
  const { therapist, game } = await bothPages(t);
  expect(await game.evaluate(() => {
    document.dispatchEvent(new KeyboardEvent('keydown', { key: 'Escape', bubbles: true }));
    return document.querySelector('[data-testid=rest-now]').classList.contains('pressed');
  }), 'the press is not seen before the program has answered');
  await game.waitForSelector('body[data-state=rest]');
  await therapist.neutral();
  await game.waitForSelector('[data-testid=go-on]:enabled');
  await t.picture(game, 'game-rest');
  await therapist.pass(1500);
  expect((await therapist.now()).runState === STOPPED, 'it started again by itself');
  await game.click('[data-testid=go-on]');
  await therapist.rendering();
  await game.waitForSelector('body[data-state=reach]');
  return 'seen with the key; neutral; started by the same player\'s press';
}

/** After Stop, a person who stays on the page prevents nobody from starting again. */
export async function stoppedGameGivesTheControlsBack(t) {
  const { therapist, game } = await bothPages(t);
  await game.click('[data-testid=stop]');
  await therapist.neutral();
  await therapist.free();
  await therapist.arm();
  await therapist.rendering();
  expect((await game.getAttribute('body', 'data-state')) !== 'rest', 'the game says that it rests');
  return 'the controls were free after Stop, and the console started again beside the open game';
}

/** Two consoles set one limit; each shows the one in force. The sum of twenty presses is applied. */
export async function consolesShowTheLimitThatHolds(t) {
  const one = await t.watcher();
  const two = await openWatcher(t.plain, one.url);
  await typeOverMoving(two, 9, () => ask(one, 2));  // the focus stays in its field
  await limitIs(one, 9);
  await until('the first console showing 9 N', async () => (await one.page.inputValue(FINGERS)) === '9.0');
  await ask(one, 6);
  await limitIs(one, 6);
  await one.page.focus(`${FINGERS.replace('#', '[data-testid="')}-slider"]`);
  for (let k = 0; k < 20; k += 1) await one.page.keyboard.press('ArrowRight');
  await limitIs(one, 8);
  // One press: a weak hand gets a thinner liquid. A step is a tenth of the viscosity of the file.
  await one.page.click('[data-testid=less-viscosity_ratio]');
  await until('both consoles showing nine tenths of the viscosity', async () => {
    const shown = await Promise.all([one, two].map(({ page }) => page.innerText('[data-testid=less-viscosity_ratio] + output')));
    return shown.every((words) => words === '0.9 ×');
  });
  expect(!(await one.page.isVisible('[data-testid=refused]')), 'an order was refused');
  return 'both consoles showed the 9 N that hold, and the viscosity; 20 steps of 0.1 N from 6.0 ended at 8.0';
}

/** A half-typed number is kept over a new recording and a new theme; one that is out of range is never sent. */
export async function halfTypedNumberStays(t) {
  const therapist = await openWatcher(t.plain, (await t.program()).url);
  const { page } = therapist;
  await page.waitForSelector('[data-testid=arm]:enabled');  // a click on a disabled button is lost
  await page.locator(FINGERS).fill('4.');
  await page.evaluate(() => document.querySelector('[data-testid=arm]').click());
  await therapist.rendering();  // a new session with a recording: the scene is sent again
  expect((await page.inputValue(FINGERS)) === '4.', `"${await page.inputValue(FINGERS)}" was left of "4."`);
  await page.locator(FINGERS).press('Enter');
  await limitIs(therapist, 4);
  const decay = page.locator('#parameter-damping_decay_s');
  const before = await decay.inputValue();
  await decay.fill('99');
  await decay.press('Enter');
  const refusal = page.locator('#parameter-damping_decay_s-refusal');
  await refusal.waitFor();
  expect((await decay.inputValue()) === before, 'the value out of range was not put back');
  return `"4." stood while a session and its recording began, and was asked for by Enter; "${await refusal.textContent()}"`;
}

/** A token is removed from the address, opens its own role, and the page explains what it does not permit. */
export async function tokensOpenTheirRoles(t) {
  const program = await t.program(...Object.entries(TOKENS).flatMap(([role, token]) => ['--token', `${role}=${token}`]));
  const open = (path, token) => openPage(t.plain, pageUrl(program.url, path, { lang: 'en', quality: 'low', token }));
  const console_ = await open('/console', TOKENS.therapist);
  await console_.waitForSelector('[data-testid=arm]:enabled');
  expect(!console_.url().includes('token'), `the address still has the token: ${console_.url()}`);
  await console_.reload();
  await console_.waitForSelector('[data-testid=arm]:enabled');
  const wrong = await open('/console', TOKENS.player);
  await wrong.waitForSelector('[data-testid=watching]:not([hidden])');
  return 'the token was gone from the address and outlived a reload; a player\'s token on the console watches, and the page says so';
}

/**
 * Levels are changed; the objects on the graphics card do not grow. WHOLEHAND_FULL=1 tests high quality with its shadow
 * maps. The last one is loaded while another renders: the virtual patient plays it.
 */
export async function levelsLeakNoGraphicsMemory(t) {
  const quality = FULL ? 'high' : 'low';
  const therapist = await openWatcher(t.plain, (await t.program()).url);
  const page = await openPage(t.drawing, pageUrl(therapist.url, '/', { lang: 'en', quality, watch: '1' }), { width: 480, height: 300 });
  const load = async (level) => {
    await therapist.page.selectOption('[data-testid=level]', String(level));
    await therapist.page.click('[data-testid=load]');
    return therapist.until(`level ${level}`, (now) => now.level === level);
  };
  const card = () => page.evaluate(() => JSON.stringify(window.wholehandStats.card));
  const kept = async (level) => {
    await load(level);
    await therapist.pass(2000);
    await page.waitForFunction((wanted) => window.wholehandStats?.quality === wanted, quality);
    const frames = await page.evaluate(() => window.wholehandStats.frames);
    await page.waitForFunction((seen) => window.wholehandStats.frames > seen + 3, frames);
    return card();
  };
  await kept(2);
  for (const [level, before] of [[1, await kept(1)], [2, await kept(2)]]) {
    await load(level);
    await until(`${before} on the card at level ${level}, as before`, async () => (await card()) === before)
      .catch(async (error) => { throw new Error(`${error.message}, but ${await card()}`); });
  }
  const words = await card();
  await page.context().close();
  await therapist.arm();
  await therapist.rendering();
  const { dispensers } = await load(3);
  await therapist.free();
  await therapist.until('the virtual patient playing it', (now) => now.runState === RENDERING && now.values.steps > 1);
  return `${words} at level 2, twice; level 3, ${dispensers.length} dispensers, is played`;
}
