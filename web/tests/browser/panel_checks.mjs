// Exercises other than the bar on both pages, with programs that play squeeze-to-level and game-scene.
import { expect, expectAccessible, openPage, pageUrl, until } from './browser.mjs';
import { startProgram } from './program.mjs';

/** The number in a row of a panel. */
const shown = async (page, name) => parseFloat((await page.locator(`[data-value=${name}] :is(.figure, .num)`).first().innerText()).replace(',', '.'));

/** The virtual patient squeezes: game and console show it, in three languages; then a person takes over. */
export async function anyExerciseShowsItsPanel(t) {
  const { url } = await startProgram({ ...t, args: ['--exercise', 'squeeze-to-level'] });
  const game = await openPage(t.plain, pageUrl(url, '/', { lang: 'fr', quality: 'low', watch: '' }));
  await game.waitForSelector('[data-testid=task]', { state: 'visible' });
  expect((await game.locator('[data-testid=task] h1').innerText()) === 'Doser sa force', 'the title is not the exercise’s French one');
  const console = await openPage(t.plain, pageUrl(url, '/console', { lang: 'de' }));
  await console.waitForSelector('.exercise [data-value=squeeze_n]');
  await until('a squeeze', async () => (await shown(console, 'squeeze_n')) > 1);
  const instruction = await console.locator('[data-testid=exercise-instruction]').innerText();
  expect(instruction.length > 0, 'the console gives no instruction');
  await until('an event in words', async () => (await console.locator('[data-testid=exercise-event]').innerText()) !== '');
  await until('all levels done', async () => (await shown(console, 'bands_done')) === 3);
  const score = await shown(console, 'score');
  expect(score > 0 && score <= 100, `the score is ${score}`);
  for (const page of [game, console]) await expectAccessible(page);
  // A person takes over: the loaded exercise stays, and its end has a card.
  await game.click('[data-testid=play]');
  await game.waitForSelector('body:not([data-state=watching]):not([data-state=loading])');
  expect((await game.locator('[data-testid=task] h1').textContent()) === 'Doser sa force', 'another exercise was loaded');
  // An exercise without a scene of its own has its panel in the game, too.
  const plain = await startProgram({ ...t, args: ['--exercise', 'game-scene'] });
  const panel = await openPage(t.plain, pageUrl(plain.url, '/', { lang: 'de', quality: 'low', watch: '' }));
  await panel.waitForSelector('[data-testid=panel] h1 >> text=Körper eines Spiels');
  await expectAccessible(panel);
  return `score ${score}; "${instruction}"`;
}

/**
 * A profile is saved by the console, and loaded while nothing is armed. It contains the help that the therapist sets;
 * then the game does not ask the player for it.
 */
export async function profilesAreKept(t) {
  const { url } = await t.program();
  const page = await openPage(t.plain, pageUrl(url, '/console', { lang: 'en', view: 'engineer' }));
  await page.waitForSelector('[data-testid=profile]');
  await page.click('#group-1');
  await page.waitForSelector('[data-testid=hand-facts]', { state: 'visible' });
  await page.fill('#parameter-fingers_close_rad', '150');
  await page.keyboard.press('Enter');
  const game = await openPage(t.plain, pageUrl(url, '/', { lang: 'en', quality: 'low' }));
  await game.waitForSelector('[data-testid=welcome] [data-help]');
  const help = (key) => page.locator(`[data-testid=set-help] [data-key="${key}"]`);
  const isSet = (key) => until(`help ${key}`, async () => (await help(key).getAttribute('aria-pressed')) === 'true');
  await help(2).click();  // some help
  await isSet(2);
  await game.waitForSelector('[data-testid=welcome] [data-help]', { state: 'detached' });
  await t.picture(page, 'profile_console');
  await t.picture(game, 'profile_game');
  await page.fill('[data-testid=profile]', 'p-014');
  await page.click('[data-testid=save-profile]');
  await page.waitForSelector('.profile label:has-text("p-014")');
  await help(0).click();
  await isSet(0);
  await game.waitForSelector('[data-testid=welcome] [data-help]');
  await page.click('[data-testid=load-profile]');
  await isSet(2);
  await until('the fingers of the profile', async () => (await page.inputValue('#parameter-fingers_close_rad')).startsWith('150'));
  await page.waitForSelector('[data-testid=load-profile]:enabled');
  expect(!(await page.locator('.notice').allInnerTexts()).join('').includes('refused'), 'the profile was refused');
  // A new scene rebuilds the page, and closes it.
  await until('an open legend', async () => {
    const words = page.getByText('adaptive damping of an axis');
    if (!(await words.isVisible())) await page.click('[data-testid=legend] summary');
    return words.isVisible();
  }, { every_ms: 500 });
  await expectAccessible(page);
  return 'p-014 saved and loaded';
}
