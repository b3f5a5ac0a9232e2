// An hour of play with a game and a console with 3D, and a level change every minute. The memory of the program, the pages
// and the graphics card must not grow. WHOLEHAND_HOUR_MIN: another number of minutes than 60.
import { readdirSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { expect, openPage, pageUrl } from './browser.mjs';
import { openWatcher, RENDERING } from './watcher.mjs';

const MINUTES = Number(process.env.WHOLEHAND_HOUR_MIN ?? 60);
const LEVELS = 4;
// Growth beyond these amounts is not noise.
const MAY_GROW = { rss_mb: 16, threads: 0, descriptors: 2, heap_mb: 3, nodes: 200, listeners: 20, geometries: 0, textures: 1 };
const LAST_MIN = 10;
const TICK_RATIO = 1.2;

const status = (pid, key) => Number(readFileSync(`/proc/${pid}/status`, 'utf8').match(new RegExp(`^${key}:\\s+(\\d+)`, 'm'))[1]);

function heldByProgram(pid) {
  return { rss_mb: status(pid, 'VmRSS') / 1024, threads: status(pid, 'Threads'), descriptors: readdirSync(`/proc/${pid}/fd`).length };
}

/** Memory after garbage collection. */
async function heldByPage(page) {
  const devtools = await page.context().newCDPSession(page);
  await devtools.send('Performance.enable');
  for (let k = 0; k < 3; k += 1) await devtools.send('HeapProfiler.collectGarbage');  // objects freed in one round may hold others
  const { metrics } = await devtools.send('Performance.getMetrics');
  await devtools.detach();
  const of = Object.fromEntries(metrics.map(({ name, value }) => [name, value]));
  const card = await page.evaluate(() => ({ ...window.wholehandStats?.card }));
  return { heap_mb: of.JSHeapUsedSize / 2 ** 20, nodes: of.Nodes, listeners: of.JSEventListeners, ...card };
}

const median = (numbers) => [...numbers].sort((a, b) => a - b)[Math.floor(numbers.length / 2)];

/**
 * The growth beyond noise, in words. A page's memory depends on the level and on the current drawing,
 * so the minimum of each level in the first third is compared with its minimum in the last third.
 */
export function growthOf(who, samples) {
  const third = Math.floor(samples.length / 3);
  const least = (part, level, key) => Math.min(...part.filter((s) => s.level === level).map((s) => s[who][key]));
  return Object.keys(samples[0][who]).flatMap((key) => [...new Set(samples.map(({ level }) => level))].flatMap((level) => {
    const before = least(samples.slice(0, third), level, key), after = least(samples.slice(-third), level, key);
    return after - before > (MAY_GROW[key] ?? Infinity) ? [`${who}, level ${level}: ${key} ${before.toFixed(1)} → ${after.toFixed(1)}`] : [];
  }));
}

async function loadLevel(therapist, level) {
  await therapist.page.selectOption('[data-testid=level]', String(level));
  await therapist.page.click('[data-testid=load]');
  try {
    await therapist.until(`level ${level}, and rendering`, (now) => now.level === level && now.runState === RENDERING);
  } catch (error) {
    const shown = await therapist.page.evaluate(() => document.body.innerText.replace(/\s+/g, ' ').slice(0, 600));
    throw new Error(`${error.message}; the console says: ${shown}`, { cause: error });
  }
}

/** p99.9 of the tick [µs of processor time], one from each status line of the program. */
const ticksIn = (output) => [...output.join('').matchAll(/tick \d+\/\d+\/(\d+) µs/g)].map(([, p999]) => Number(p999));

export async function hourOfPlayLeaksNothing(t) {
  const program = await t.program('--no-rehearsal');
  const therapist = await openWatcher(t.plain, program.url);
  await therapist.arm();
  await therapist.rendering();
  const game = await openPage(t.drawing, pageUrl(program.url, '/', { lang: 'en', quality: 'low', watch: '1' }), { smooth: true });
  const console3d = await openPage(t.drawing, pageUrl(program.url, '/console', { lang: 'en', role: 'watcher' }), { smooth: true });
  const pages = { game, console: console3d, therapist: therapist.page };
  const samples = [];
  for (let minute = 0; minute < MINUTES; minute += 1) {
    const until_ms = Date.now() + 60_000;
    const level = 1 + minute % LEVELS;
    await loadLevel(therapist, level);
    await new Promise((resolve) => setTimeout(resolve, Math.max(until_ms - Date.now(), 0)));
    const sample = { minute, level, program: heldByProgram(program.pid), tick_us: median(ticksIn(program.output.splice(0))) };
    for (const [name, page] of Object.entries(pages)) sample[name] = await heldByPage(page);
    samples.push(sample);
    writeFileSync(join(t.output, 'hour.json'), `${JSON.stringify(samples, null, 1)}\n`);
    if (minute % 5 === 0) console.log(`      minute ${minute}: ${JSON.stringify(sample)}`);
  }
  const warm = samples.slice(LEVELS);   // the first round of levels fills caches
  const grown = ['program', ...Object.keys(pages)].flatMap((who) => growthOf(who, warm));
  expect(grown.length === 0, grown.join('; '));
  const tick = (part) => median(part.map(({ tick_us }) => tick_us));
  const ratio = tick(samples.slice(-LAST_MIN)) / tick(samples.slice(0, LAST_MIN));
  expect(ratio <= TICK_RATIO, `p99.9 of the tick in the last ${LAST_MIN} minutes: ${ratio.toFixed(2)} × the first`);
  const held = samples.at(-1);
  return `${MINUTES} minutes: program ${held.program.rss_mb.toFixed(0)} MB, ${held.program.threads} threads, ${held.program.descriptors} descriptors; heap of the game ${held.game.heap_mb.toFixed(1)} MB; p99.9 of the tick ${ratio.toFixed(2)} × the first ten minutes`;
}
