// Who may do what while a patient plays: game and console against the real program.
import { openPage, pageUrl, until } from './browser.mjs';
import { expect, openGame } from './checks.mjs';
import { armFrom } from './stop_checks.mjs';
import { openWatcher } from './watcher.mjs';

const RENDERING = 1;
const STOPPED = 3;
const PATIENT_MS = 60_000;
const FINGERS = '#parameter-effort_limit_hand_tip_n';
const TOKENS = { therapist: 'therapist-token-0123', player: 'player-token-01234567' };

const parameter = ({ page }, name) => page.evaluate((wanted) => {
  const { state, scene } = window.wholehandNow;
  return state.parameters[scene.parameters.findIndex((p) => p.name === wanted)];
}, name);

/** What stands at a console's limit: the program's value, the field, the ramp, a refusal, the run state. */
const limitOf = async (watcher) => watcher.page.evaluate((field) => {
  const row = document.querySelector(field).closest('.par');
  const { state, scene } = window.wholehandNow;
  const i = scene.parameters.findIndex((p) => p.name === 'effort_limit_hand_tip_n');
  return JSON.stringify({ holds: state.parameters[i], field: document.querySelector(field).value, says: row.innerText, runState: state.runState, session: state.session });
}, FINGERS);

const limitIs = async (watcher, wanted_n) => {
  try {
    await until(`a limit of ${wanted_n} N`, async () =>
      Math.abs((await parameter(watcher, 'effort_limit_hand_tip_n')) - wanted_n) < 1e-4, { within_ms: PATIENT_MS });
  } catch (late) {
    throw new Error(`${late.message}: ${await limitOf(watcher)}`);
  }
};

const ask = async ({ page }, value_n) => {
  await page.locator(FINGERS).fill(String(value_n));
  await page.locator(FINGERS).press('Enter');
};

/** Selects the number, lets the ramp write it anew under the selection, and types over it. */
const typeOverMoving = async ({ page }, value_n) => {
  await page.locator(FINGERS).selectText();
  const before = await page.inputValue(FINGERS);
  await until('the number moving', async () => (await page.inputValue(FINGERS)) !== before, { within_ms: PATIENT_MS });
  await page.keyboard.type(String(value_n));
  await page.keyboard.press('Enter');
};

const rendering = (watcher) => watcher.until('rendering', (now) => now.runState === RENDERING, { within_ms: PATIENT_MS });

/** A therapist's console that has started it, and a game that plays. */
async function bothPages(browser, programUrl) {
  const therapist = await openWatcher(browser, programUrl);
  if ((await therapist.now()).runState !== RENDERING) await armFrom(therapist);
  await rendering(therapist);
  const game = await openGame(browser, programUrl);
  await therapist.until('the person steering', (now) => now.steering === 1, { within_ms: PATIENT_MS });
  return { therapist, game };
}

/** Limits, pause and steering, all while the game has the controls. */
export async function therapistLeadsWhileAPatientPlays(browser, programUrl, picture = async () => {}) {
  const { therapist, game } = await bothPages(browser, programUrl);
  const { page } = therapist;
  await page.waitForSelector('[data-testid=holder]:has-text("player")', { timeout: PATIENT_MS });
  await ask(therapist, 5);
  await limitIs(therapist, 5);
  await picture(game, 'game-rest-beside-stop');
  await picture(page, 'console-while-a-patient-plays');
  await page.click('[data-testid=pause]');
  await game.waitForSelector('text=/Paused/', { timeout: PATIENT_MS });
  await page.click('[data-testid=resume]');
  await therapist.until('going on', (now) => now.values.paused < 0.5, { within_ms: PATIENT_MS });
  await page.click('[data-testid=take-controls-banner]');
  await game.waitForSelector('[data-testid=left]', { timeout: PATIENT_MS });
  const said = await game.locator('[data-testid=left]').innerText();
  expect(/therapist/.test(said), `the game says "${said}"`);
  await page.click('[data-testid=take-controls]');
  await page.waitForSelector('[data-testid=holder]:has-text("free")', { timeout: PATIENT_MS });
  await game.click('[data-testid=take-again]');
  await therapist.until('the person steering again', (now) => now.steering === 1, { within_ms: PATIENT_MS });
  await game.context().close();
  await page.context().close();
  return 'a limit of 5 N, a pause and the steering, all while the game had the controls';
}

/** Rest by Esc: seen at once, neutral, and ended by the same player's press only. */
export async function playerRestsAndGoesOn(browser, programUrl, picture = async () => {}) {
  const { therapist, game } = await bothPages(browser, programUrl);
  const looked_ms = await game.evaluate(() => {
    const began_ms = performance.now();
    document.dispatchEvent(new KeyboardEvent('keydown', { key: 'Escape', bubbles: true }));
    return document.querySelector('[data-testid=rest-now]').classList.contains('pressed') ? performance.now() - began_ms : Infinity;
  });
  expect(looked_ms <= 50, `the press was seen after ${looked_ms} ms`);
  await game.waitForSelector('body[data-state=rest]', { timeout: PATIENT_MS });
  await therapist.until('neutral', (now) => now.runState === STOPPED && now.sent.every((effort) => Math.abs(effort) < 1e-6), { within_ms: PATIENT_MS });
  await game.waitForSelector('[data-testid=go-on]:enabled', { timeout: PATIENT_MS });
  await picture(game, 'game-rest');
  await new Promise((resolve) => setTimeout(resolve, 1500));
  expect((await therapist.now()).runState === STOPPED, 'it started again by itself');
  await game.click('[data-testid=go-on]');
  await rendering(therapist);
  await game.waitForSelector('body[data-state=reach]', { timeout: PATIENT_MS });
  await game.context().close();
  await therapist.page.context().close();
  return `seen ${looked_ms.toFixed(1)} ms after the key; neutral; started by the same player's press`;
}

/** After Stop, whoever stays on the page keeps nobody from starting again. */
export async function stoppedGameGivesTheControlsBack(browser, programUrl) {
  const { therapist, game } = await bothPages(browser, programUrl);
  await game.click('[data-testid=stop]');
  await therapist.until('stopped', (now) => now.runState === STOPPED, { within_ms: PATIENT_MS });
  await therapist.page.waitForSelector('[data-testid=holder]:has-text("free")', { timeout: PATIENT_MS });
  await armFrom(therapist);
  await rendering(therapist);
  expect((await game.getAttribute('body', 'data-state')) !== 'rest', 'the game says that it rests');
  await game.context().close();
  await therapist.page.context().close();
  return 'the controls were free after Stop, and the console started again beside the open game';
}

/** Two consoles set one limit; each shows the one that holds. Twenty presses end where they add up to. */
export async function consolesShowTheLimitThatHolds(browser, programUrl) {
  const one = await openWatcher(browser, programUrl);
  const two = await openWatcher(browser, programUrl);
  if ((await one.now()).runState !== RENDERING) await armFrom(one);
  await rendering(one);
  await ask(one, 2);  // the focus stays in its field
  await typeOverMoving(two, 9);
  await limitIs(one, 9);
  await until('the first console showing 9 N', async () => (await one.page.inputValue(FINGERS)) === '9.0', { within_ms: PATIENT_MS });
  await ask(one, 6);
  await limitIs(one, 6);
  await one.page.focus(`${FINGERS.replace('#', '[data-testid="')}-slider"]`);
  for (let k = 0; k < 20; k += 1) await one.page.keyboard.press('ArrowRight');
  await limitIs(one, 8);
  expect(!(await one.page.isVisible('[data-testid=refused]')), 'an order was refused');
  await one.page.context().close();
  await two.page.context().close();
  return 'both consoles showed the 9 N that hold; 20 steps of 0.1 N from 6.0 ended at 8.0';
}

/** A half-typed number outlives a recording that begins, and a theme. */
export async function halfTypedNumberStays(browser, programUrl) {
  const therapist = await openWatcher(browser, programUrl);
  const { page } = therapist;
  await page.waitForSelector('[data-testid=arm]:enabled', { timeout: PATIENT_MS });  // a click on a disabled button is lost
  await page.locator(FINGERS).fill('4.');
  await page.evaluate(() => document.querySelector('[data-testid=arm]').click());
  await rendering(therapist);  // a new session, and a recording: the scene is told anew
  expect((await page.inputValue(FINGERS)) === '4.', `"${await page.inputValue(FINGERS)}" was left of "4."`);
  await page.locator(FINGERS).press('Enter');
  await limitIs(therapist, 4);
  await page.context().close();
  return '"4." stood while a session and its recording began, and was asked for by Enter';
}

/** A token leaves the address, opens its own role, and says in words what it does not open. */
export async function tokensOpenTheirRoles(browser, programUrl) {
  const open = (path, token) => openPage(browser, pageUrl(programUrl, path, { lang: 'en', quality: 'low', token }));
  const console_ = await open('/console', TOKENS.therapist);
  await console_.waitForSelector('[data-testid=arm]:enabled', { timeout: PATIENT_MS });
  expect(!console_.url().includes('token'), `the address still has the token: ${console_.url()}`);
  await console_.reload();
  await console_.waitForSelector('[data-testid=arm]:enabled', { timeout: PATIENT_MS });
  const wrong = await open('/console', TOKENS.player);
  await wrong.waitForSelector('[data-testid=watching]:not([hidden])', { timeout: PATIENT_MS });
  await wrong.context().close();
  await console_.context().close();
  return 'the token was gone from the address and outlived a reload; a player\'s token on the console watches, and is told so';
}

export const TOKEN_ARGS = Object.entries(TOKENS).flatMap(([role, token]) => ['--token', `${role}=${token}`]);

/** While the program is away the card, and the focus in it, stay through every attempt to reach it. */
export async function lostCardStays(browser, program) {
  const page = await openPage(browser, pageUrl(program.url, '/', { lang: 'en', quality: 'low', watch: '1' }), { cutOff: true });
  await page.waitForSelector('body[data-state=watching]', { timeout: PATIENT_MS });
  await program.stop('SIGKILL');
  await page.waitForSelector('body[data-state=lost] .message', { timeout: PATIENT_MS });
  await page.evaluate(() => { window.firstCard = document.querySelector('.message'); });
  const lit = () => page.locator('.dots .on').count();
  const first = await lit();
  await until('another attempt', async () => (await lit()) !== first, { within_ms: PATIENT_MS });
  expect(await page.evaluate(() => window.firstCard.isConnected), 'the card was built anew at an attempt');
  await page.context().close();
  return 'one card through the attempts, which its dots show';
}

/** Levels come and go; what the graphics card keeps does not grow. In high quality, with its shadow maps, under WHOLEHAND_FULL=1. */
export async function levelsLeaveNothingOnTheCard(browser, programUrl) {
  const quality = process.env.WHOLEHAND_FULL === '1' ? 'high' : 'low';
  const therapist = await openWatcher(browser, programUrl);
  const page = await openPage(browser, pageUrl(programUrl, '/', { lang: 'en', quality, watch: '1' }));
  const kept = async (level) => {
    await therapist.page.selectOption('[data-testid=level]', String(level));
    await therapist.page.click('[data-testid=load]');
    await therapist.until(`level ${level}`, (now) => now.level === level, { within_ms: PATIENT_MS });
    await new Promise((resolve) => setTimeout(resolve, 2000));
    await page.waitForFunction((wanted) => window.wholehandStats.quality === wanted, quality, { timeout: 3 * PATIENT_MS });
    const frames = await page.evaluate(() => window.wholehandStats.frames);
    await page.waitForFunction((seen) => window.wholehandStats.frames > seen + 3, frames, { timeout: 3 * PATIENT_MS });
    return page.evaluate(() => ({ ...window.wholehandStats.card }));
  };
  await kept(2);
  const before = [await kept(1), await kept(2)];
  const after = [await kept(1), await kept(2)];
  expect(JSON.stringify(after) === JSON.stringify(before), `the card keeps ${JSON.stringify(before)}, then ${JSON.stringify(after)}`);
  await page.context().close();
  await therapist.page.context().close();
  return `${JSON.stringify(before[1])} at level 2, twice`;
}
