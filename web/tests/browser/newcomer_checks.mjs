// A person who sees the pages for the first time, and finds things only by visible words.
import { expect, openPage, pageUrl, until } from './browser.mjs';

/** After this time of searching a person would ask somebody [s]. */
const PATIENCE_S = 10;

/** Larger text, rest, stop, the own recording, the other hand: each by the visible words of a button, link or choice. */
export async function newcomerFinds(t) {
  const program = await t.program();
  const took = [];
  const find = async (what, look) => {
    const began_ms = Date.now();
    await look();
    const took_s = (Date.now() - began_ms) / 1000;
    took.push(`${what} ${took_s.toFixed(1)} s`);
    expect(took_s <= PATIENCE_S, `it took ${took_s.toFixed(1)} s to find ${what}`);
  };
  const game = await openPage(t.plain, pageUrl(program.url, '/', { lang: 'en', quality: 'low' }));
  const button = (page, name) => page.getByRole('button', { name, exact: true });
  // A start may be under way: a press meanwhile ends it.
  const plays = () => game.getByText('One moment …').waitFor({ state: 'hidden' });
  const words_px = () => game.locator('body *:visible').evaluateAll((all) => all.reduce((sum, words) => sum + parseFloat(getComputedStyle(words).fontSize), 0) / all.length);
  await button(game, 'Start').waitFor();

  const before_px = await words_px();
  await find('larger text', () => button(game, 'Text: Large').click());
  await until('larger text', async () => (await words_px()) > before_px);

  await button(game, 'Start').click();
  await plays();
  await find('rest', async () => {
    await button(game, 'Rest').click();
    await game.getByRole('heading', { name: 'Take a rest' }).waitFor();
  });
  await button(game, 'Go on').click();
  await plays();
  await find('stop', async () => {
    await button(game, 'Stop').click();
    await game.getByRole('heading', { name: 'Stopped' }).waitFor();
  });

  await game.getByRole('link', { name: 'open the console' }).click();
  await game.getByRole('heading', { name: 'Recordings' }).waitFor();
  await find('her own recording', async () => {
    const opened = game.waitForEvent('popup');
    // The newest recording is the first; its title contains the person.
    await game.getByRole('link', { name: 'Replay' }).first().click();
    await (await opened).getByRole('button', { name: /^Play/ }).waitFor();
  });

  await find('the other hand', async () => {
    await game.getByRole('combobox', { name: 'Hand', exact: true }).selectOption({ label: 'Median, left' });
    await button(game, 'Load').click();
    await game.getByText('left hand').first().waitFor();
  });
  return took.join(', ');
}
