// The cost of drawing in low quality. Only with WHOLEHAND_FULL: drawing alone needs two processors.
import { writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { expect, expectNoFaults, openPage, pageUrl } from './browser.mjs';
import { startProgram } from './program.mjs';

const SCRIPT_MS = 8;
// Two idle processors draw 15 frames a second if a frame takes 100 ms of them for drawing, 20 for the page
// and 13 for the program. Beside other work the same frame takes up to 1.4 times as much processor time.
const DRAWING_MS = 140;
// A game that draws 28 frames a second alone draws 12 of them beside a console with its picture.
const BESIDE_RATIO = 0.47;
/** A shared machine draws fewer frames than this, while the program sends at its full rate. */
const FRAMES_HZ = 15;
const SECONDS = 12;
const wait_s = (seconds) => new Promise((resolve) => setTimeout(resolve, 1000 * seconds));

/** Processor time of scripts in the page's main thread: other processes do not change it. */
async function scriptCpu_s(page) {
  page.metrics ??= await page.context().newCDPSession(page);
  await page.metrics.send('Performance.enable', { timeDomain: 'threadTicks' });
  const { metrics } = await page.metrics.send('Performance.getMetrics');
  return metrics.find(({ name }) => name === 'ScriptDuration').value;
}

/** Processor time so far of the browser's drawing process [ms]. */
async function drawing_ms(session) {
  const { processInfo } = await session.send('SystemInfo.getProcessInfo');
  return 1000 * processInfo.filter(({ type }) => type === 'GPU').reduce((sum, { cpuTime }) => sum + cpuTime, 0);
}

const drawn = async (page) => {
  await page.waitForFunction(() => window.wholehandStats?.quality === 'low');
  return () => page.evaluate(() => ({ ...window.wholehandStats }));
};

/** Frames per second, and processor time of scripts and drawing per frame: printed and stored as `name`. */
async function figuresOf(t, url, name, path) {
  const session = await t.drawing.newBrowserCDPSession();
  // A page whose machine stalls for seconds loses its connection correctly.
  const page = await openPage(t.drawing, pageUrl(url, path, { lang: 'en', quality: 'low', theme: 'light' }), { cutOff: true, smooth: true });
  if (path === '/') await page.click('[data-testid=watch]:enabled');
  const stats = await drawn(page);
  await wait_s(5);  // the hand is made with the first states
  const [script_s, before_ms, { frames }] = [await scriptCpu_s(page), await drawing_ms(session), await stats()];
  await wait_s(SECONDS);
  const { frames: last, script_ms_p95, state_age_ms_p99 } = await stats();
  const figures = {
    fps: (last - frames) / SECONDS, script_ms_p95, state_age_ms_p99,
    drawing_cpu_ms_mean: ((await drawing_ms(session)) - before_ms) / Math.max(1, last - frames),
    script_cpu_ms_mean: (1000 * ((await scriptCpu_s(page)) - script_s)) / Math.max(FRAMES_HZ * SECONDS, last - frames),
  };
  writeFileSync(join(t.output, `cost-${name}.json`), `${JSON.stringify(figures, null, 2)}\n`);
  console.log(`figure ${name}: ${JSON.stringify(figures, (_, value) => (typeof value === 'number' ? +value.toFixed(2) : value))}`);
  expectNoFaults(page);
  await page.context().close();
  return figures;
}

export async function costOf(t, name, path) {
  const { url } = await t.watcher();
  const { drawing_cpu_ms_mean: drawing, script_cpu_ms_mean: script } = await figuresOf(t, url, name, path);
  expect(script <= SCRIPT_MS, `script above ${SCRIPT_MS} ms of processor a frame: ${script}`);
  expect(drawing <= DRAWING_MS, `drawing above ${DRAWING_MS} ms of processor a frame: ${drawing}`);
  return `gated: ${DRAWING_MS} ms of processor a frame for drawing, ${SCRIPT_MS} for script`;
}

/** The game's frame rate beside a drawing console, each in its own browser, relative to its frame rate alone just before. */
export async function besideAConsole(t) {
  const { url } = await startProgram({ file: t.file, folder: t.folder, args: ['--no-rehearsal'] });
  const alone = await figuresOf(t, url, 'game-alone', '/');
  const console3d = await openPage(await t.browser(), pageUrl(url, '/console', { lang: 'en', quality: 'low', role: 'watcher' }), { smooth: true });
  await drawn(console3d);
  const ratio = (await figuresOf(t, url, 'game-beside-a-console', '/')).fps / alone.fps;
  expectNoFaults(console3d);
  const words = `${ratio.toFixed(2)} of the frames alone; gated: ${BESIDE_RATIO}`;
  expect(ratio >= BESIDE_RATIO, words);
  return words;
}
