// A page that was open before shows the same pixels as one that was loaded after (tests/same_page.test.ts compares all changes without pixels).
import { expect, openPage, pageUrl, until } from './browser.mjs';
import { startProgram } from './program.mjs';
import { openWatcher, RENDERING, STOPPED } from './watcher.mjs';

const SIZE = { width: 640, height: 400 };
/** Share of pixels that may differ, and the difference of a channel that counts, of 255. */
const MOST_SHARE = 1e-3, COUNTS = 8;
const EXERCISES = ['drawer', 'light-switch', 'coffee-mill', 'cocktail-bar', 'press-lever', 'squeeze-to-level', 'flip-top-lid', 'cupboard-door', 'free-grasping', 'cocktail-bar-free'];
/** Times, stars and cards are the person's own; the picture and what the exercise writes are compared. */
const PLAIN = '.overlay, .recorded, .playself, .strip, #toast { display: none !important; } #picture { filter: none !important; } .task, .values { visibility: visible !important; display: block !important; }';

/** Share of the pixels that differ, and the pictures' share of pixels unlike the first one, which is 0 for an empty picture. Runs in a page. */
async function unlike([one, other], counts) {
  const [a, b] = await Promise.all([one, other].map(async (base64) => {
    const bitmap = await createImageBitmap(await (await fetch(`data:image/png;base64,${base64}`)).blob()), pen = new OffscreenCanvas(bitmap.width, bitmap.height).getContext('2d');
    pen.drawImage(bitmap, 0, 0);
    return pen.getImageData(0, 0, bitmap.width, bitmap.height).data;
  }));
  let differ = 0, full = 0;
  for (let i = 0; i < a.length; i += 4) {
    if ([0, 1, 2].some((k) => Math.abs(a[i + k] - b[i + k]) > counts)) differ += 1;
    if ([0, 1, 2].some((k) => Math.abs(a[i + k] - a[k]) > counts)) full += 1;
  }
  return { differ: 4 * differ / a.length, full: 4 * full / a.length };
}

/** Opens the game to watch. */
async function watching(t, url) {
  const page = await openPage(t.drawing, pageUrl(url, '/', { lang: 'en', quality: 'low', watch: '' }), SIZE);
  await page.addStyleTag({ content: PLAIN });
  return page;
}

/** The picture when it is complete and moves no more. */
async function stillPicture(page) {
  await page.waitForFunction(() => window.wholehandStats?.quality === 'low');
  let last = '';
  await until('a still picture', async () => {
    const now = (await page.screenshot()).toString('base64'), same = now === last;
    last = now;
    return same;
  }, { every_ms: 1000 });
  return last;
}

/** Ten changes of exercise, each played for half a second and stopped: then nothing moves, in one page that stays open. */
export async function tenChangesAsPixels(t) {
  const { url } = await startProgram({ ...t, args: ['--wait', '--no-rehearsal', '--exercise', EXERCISES.at(-1)] });
  const watcher = await openWatcher(t.plain, url), open = await watching(t, url), shares = [];
  for (const name of EXERCISES) {
    await watcher.page.selectOption('[data-testid=exercise]', name);
    await watcher.page.click('[data-testid=load]:enabled');
    await watcher.until(name, async () => (await exerciseOf(watcher.page)) === name);
    const { session } = await watcher.now();
    await watcher.arm();
    // A busy machine may end it itself, by a late tick: that is a stop as good as ours.
    await watcher.until(`${name} for a moment`, (now) => now.session > session && (now.runState === STOPPED || (now.runState === RENDERING && now.tick >= 500)));
    await watcher.page.click('[data-testid=emergency-stop]');
    await watcher.neutral();
    const fresh = await watching(t, url), pictures = [await stillPicture(fresh), await stillPicture(open)];
    await fresh.context().close();
    const { differ, full } = await watcher.page.evaluate(new Function(`return (${unlike})(...arguments[0])`), [pictures, COUNTS]);
    expect(full > 0.2, `${name}: the picture is empty`);
    shares.push(`${name} ${(100 * differ).toFixed(3)} %`);
    expect(differ <= MOST_SHARE, `pixels that differ: ${shares.join(', ')}`);
  }
  console.log(`figure: pixels of an open page unlike a fresh one: ${shares.join(', ')}`);
  return `${shares.length} changes, at most ${100 * MOST_SHARE} % of the pixels differ`;
}

const exerciseOf = (page) => page.evaluate(() => String(window.wholehandNow?.scene?.exerciseName));
