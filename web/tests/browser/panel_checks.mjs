// An exercise that is not the bar, seen on both pages. Against a program that plays squeeze-to-level.
import { accessibilityFaults, openPage, pageUrl, until } from './browser.mjs';
import { expect } from './checks.mjs';

const PATIENT_MS = 120_000;

/** Number that a row of a panel shows. */
const shown = async (page, name) => parseFloat(await page.locator(`[data-value=${name}] :is(.figure, .num)`).first().innerText());

/** The virtual patient squeezes: game and console show it, in three languages; then a person takes over. */
export async function anyExerciseShowsItsPanel(browser, programUrl) {
  const game = await openPage(browser, pageUrl(programUrl, '/', { lang: 'fr', quality: 'low', watch: '' }));
  await game.waitForSelector('[data-testid=panel]', { state: 'visible', timeout: PATIENT_MS });
  expect((await game.locator('[data-testid=panel] h1').innerText()) === 'Doser sa force', 'the title is not the exercise’s French one');
  const console = await openPage(browser, pageUrl(programUrl, '/console', { lang: 'de' }));
  await console.waitForSelector('.exercise [data-value=squeeze_n]', { timeout: PATIENT_MS });
  await until('a squeeze in both panels', async () => (await shown(game, 'squeeze_n')) > 1 && (await shown(console, 'squeeze_n')) > 1, { within_ms: PATIENT_MS });
  const instruction = await console.locator('[data-testid=exercise-instruction]').innerText();
  expect(instruction.length > 0, 'the console gives no instruction');
  expect(await game.locator('.values .range u').first().isVisible(), 'no goal band is drawn');
  await until('an event in words', async () => (await game.locator('[data-testid=panel-event]').innerText()) !== '' || (await console.locator('[data-testid=exercise-event]').innerText()) !== '', { within_ms: PATIENT_MS });
  await until('all levels done', async () => (await shown(console, 'bands_done')) === 3, { within_ms: PATIENT_MS });
  const score = await shown(console, 'score');
  expect(score > 0 && score <= 100, `the score is ${score}`);
  for (const page of [game, console]) {
    const faults = await accessibilityFaults(page);
    expect(faults.length === 0, faults.join('\n'));
  }
  // A person takes over: what was loaded stays, and the end has a card.
  await game.click('[data-testid=play]');
  await game.waitForSelector('body:is([data-state=free], [data-state=success])', { timeout: PATIENT_MS });
  expect((await game.locator('[data-testid=panel] h1').textContent()) === 'Doser sa force', 'another exercise was loaded');
  for (const page of [game, console]) expect(page.faults.length === 0, page.faults.join('\n'));
  await game.context().close();
  await console.context().close();
  return `score ${score}; "${instruction}"`;
}

/**
 * A profile is saved by the console, and loaded while nothing is armed. The help that the therapist sets is of it;
 * the game then asks the player nothing about it.
 */
export async function profilesAreKept(browser, programUrl, picture = async () => {}) {
  const page = await openPage(browser, pageUrl(programUrl, '/console', { lang: 'en' }));
  await page.waitForSelector('[data-testid=profile]', { timeout: PATIENT_MS });
  await page.click('#group-1');
  await page.waitForSelector('[data-testid=hand-facts]', { state: 'visible', timeout: PATIENT_MS });
  await page.fill('#parameter-fingers_close_rad', '150');
  await page.keyboard.press('Enter');
  const game = await openPage(browser, pageUrl(programUrl, '/', { lang: 'en', quality: 'low' }));
  await game.waitForSelector('[data-testid=welcome] [data-help]', { timeout: PATIENT_MS });
  const help = (key) => page.locator(`[data-testid=set-help] [data-key="${key}"]`);
  const isSet = (key) => until(`help ${key}`, async () => (await help(key).getAttribute('aria-pressed')) === 'true', { within_ms: PATIENT_MS });
  await help(2).click();  // some
  await isSet(2);
  await game.waitForSelector('[data-testid=welcome] [data-help]', { state: 'detached', timeout: PATIENT_MS });
  await picture(page, 'profile_console');
  await picture(game, 'profile_game');
  await page.fill('[data-testid=profile]', 'p-014');
  await page.click('[data-testid=save-profile]');
  await page.waitForSelector('.profile label:has-text("p-014")', { timeout: PATIENT_MS });
  await help(0).click();
  await isSet(0);
  await game.waitForSelector('[data-testid=welcome] [data-help]', { timeout: PATIENT_MS });
  await page.click('[data-testid=load-profile]');
  await isSet(2);
  await until('the fingers of the profile', async () => (await page.inputValue('#parameter-fingers_close_rad')).startsWith('150'), { within_ms: PATIENT_MS });
  await page.waitForSelector('[data-testid=load-profile]:enabled', { timeout: PATIENT_MS });
  expect(!(await page.locator('.notice').allInnerTexts()).join('').includes('refused'), 'the profile was refused');
  // A scene that comes builds the page anew, and closes it.
  await until('an open legend', async () => {
    const words = page.getByText('adaptive damping of an axis');
    if (!(await words.isVisible())) await page.click('[data-testid=legend] summary');
    return words.isVisible();
  }, { within_ms: PATIENT_MS, every_ms: 500 });
  const faults = await accessibilityFaults(page);
  expect(faults.length === 0, faults.join('\n'));
  for (const each of [page, game]) {
    expect(each.faults.length === 0, each.faults.join('\n'));
    await each.context().close();
  }
  return 'p-014 saved and loaded';
}
