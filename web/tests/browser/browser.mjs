// Debian's Chromium, with and without 3D, and detection of errors in its pages.
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { pathToFileURL } from 'node:url';
import { chromium } from 'playwright-core';

/** A time limit for hangs, longer than any step takes on a slow machine. It is not a performance limit. */
export const HANGS_MS = 180_000;

const require = createRequire(import.meta.url);
const AXE = readFileSync(require.resolve('axe-core/axe.min.js'), 'utf8');
// Only 3D uses the software renderer: the processor draws pages and plots directly.
const SOFTWARE_3D = ['--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--ignore-gpu-blocklist', '--disable-gpu-rasterization', '--disable-accelerated-2d-canvas'];

// Requests of a page that has lost the program: they may fail only while `cutOff` is set.
const CUT_OFF = ['/ws', '/api/recordings'];
// Notices about software rendering, which are not faults. Chromium prints WebGL's errors as warnings too.
const SOFTWARE_NOTICES = [/GPU stall due to ReadPixels/, /Automatic fallback to software WebGL/];
// The page's own warning in a browser without 3D.
const WITHOUT_3D = /cannot be drawn here: Error: WebGL 2 is not there/;

export async function openBrowser({ with3d = true, args = [] } = {}) {
  const browser = await chromium.launch({
    executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
    headless: true, handleSIGINT: false, handleSIGTERM: false, handleSIGHUP: false,  // run.mjs handles signals and ends everything
    args: ['--no-sandbox', ...(with3d ? SOFTWARE_3D : ['--disable-3d-apis']), ...args],
  });
  browser.with3d = with3d;
  return browser;
}

/** Address of a page of the program; WHOLEHAND_PAGES takes the pages from a development server instead. */
export function pageUrl(programUrl, path, query = {}) {
  const pages = process.env.WHOLEHAND_PAGES;
  const url = new URL(path, pages ?? programUrl);
  for (const [key, value] of Object.entries(query)) url.searchParams.set(key, value);
  if (pages) url.searchParams.set('server', `127.0.0.1:${new URL(programUrl).port}`);
  return url.href;
}

const pathOf = (url) => (/^\w+:\/\//.test(url) ? new URL(url).pathname : url);

/** The fault in a message of a page's console, or null. `cutOff`: the page may have lost the program. */
function faultOf(message, { with3d, cutOff }) {
  const text = message.text();
  if (/WebGL|\bGL_/.test(text) && ['warning', 'error'].includes(message.type())) {
    const known = SOFTWARE_NOTICES.some((notice) => notice.test(text)) || (!with3d && WITHOUT_3D.test(text));
    return known ? null : text;
  }
  if (message.type() !== 'error') return null;
  // HTTP refusals are counted as responses, with their address.
  if (text.startsWith('Failed to load resource: the server responded')) return null;
  const address = text.startsWith('Failed to load resource') ? message.location().url : text.match(/^WebSocket connection to '([^']+)'/)?.[1];
  if (address === undefined) return text;
  return cutOff && CUT_OFF.includes(pathOf(address)) ? null : `${text} (${address})`;
}

/** Reduces the frame rate to ten per second, or five with 3D: tests need the content, and smooth drawing takes two processors. */
const drawsSeldom = (every_ms) => {
  const frame = window.requestAnimationFrame.bind(window);
  window.requestAnimationFrame = (run) => setTimeout(() => frame(run), every_ms);
  window.cancelAnimationFrame = clearTimeout;
};

/** Opens a page that records its errors and refused requests. `smooth`: full frame rate. `init`: one or several scripts that run first. */
export async function openPage(browser, url, { width = 1280, height = 800, locale = 'en-GB', cutOff = false, smooth = false, init = null, ...more } = {}) {
  const context = await browser.newContext({ viewport: { width, height }, locale, ...more });
  if (!smooth) await context.addInitScript(drawsSeldom, browser.with3d ? 200 : 100);
  for (const script of [init ?? []].flat()) await context.addInitScript(script);
  const page = await context.newPage();
  page.setDefaultTimeout(HANGS_MS);
  page.faults = [];
  page.cutOff = cutOff;
  page.on('pageerror', (error) => page.faults.push(error.message));
  page.on('response', (answer) => {
    // A page that lost its connection for a moment on a busy machine asks for the reason; 426 shows that the program is there.
    const asked = answer.status() === 426 && pathOf(answer.url()) === '/ws';
    const excused = asked || (page.cutOff && CUT_OFF.includes(pathOf(answer.url())));
    if (answer.status() >= 400 && !excused) page.faults.push(`${answer.status()} ${answer.url()}`);
  });
  page.on('console', (message) => {
    const fault = faultOf(message, { with3d: browser.with3d, cutOff: page.cutOff });
    if (fault !== null) page.faults.push(fault);
  });
  // The load event is not awaited: a page with software rendering keeps its machine busy.
  await page.goto(url, { waitUntil: 'commit' });
  return page;
}

/** A page in a file, opened from the disk, and its requests. */
export async function openFile(browser, path, { state = 'shown', theme = 'light', ...more } = {}) {
  const page = await openPage(browser, 'about:blank', more);
  const asked = [];
  page.on('request', (request) => { if (!/^(data|blob):/.test(request.url())) asked.push(request.url()); });
  await page.goto(`${pathToFileURL(path).href}?lang=en&theme=${theme}`, { waitUntil: 'commit' });
  await page.waitForSelector(`body[data-state=${state}]`);
  return { page, asked };
}

/** The number of printed sheets. */
export const sheetsOf = async (page) => ((await page.pdf({ preferCSSPageSize: true })).toString('latin1').match(/\/Type\s*\/Page\b/g) ?? []).length;

/** Throws an error unless a condition holds. */
export function expect(condition, words) {
  if (!condition) throw new Error(words);
}

/** Expects that no page reported a fault. */
export const expectNoFaults = (...pages) => pages.forEach(({ faults }) => expect(faults.length === 0, faults.join('\n')));

/** Expects no serious accessibility fault. `all`: nor any minor one. */
export async function expectAccessible(page, words = '', { all = false } = {}) {
  const faults = await accessibilityFaults(page, all);
  expect(faults.length === 0, `${words} ${faults.join('\n')}`);
}

/** At 200 % on a screen of 1280 x 800: no horizontal scrolling, nothing cut off, and no serious accessibility fault. */
export async function expectZoomable(page, words) {
  const before = page.viewportSize();
  await page.setViewportSize({ width: 640, height: 400 });
  await until(`${words} as wide as a window of 640 px`, () => page.evaluate(() => document.documentElement.scrollWidth <= 640 && innerWidth === 640));
  const cut = await page.evaluate(cutOff);
  expect(cut.length === 0, `${words} at 200 %, cut off: ${cut.join(' | ')}`);
  await expectAccessible(page, `${words} at 200 %:`, { all: true });
  await page.setViewportSize(before);
}

/** Controls and texts that extend beyond the window, or beyond a parent that does not scroll. Runs in the page. */
function cutOff() {
  const beyond = (inner, outer) => inner.left < outer.left - 1 || inner.right > outer.right + 1;
  const hidden = (element) => ['hidden', 'clip'].includes(getComputedStyle(element).overflowX);
  return [...document.querySelectorAll('main :is(h2, h3, p, b, small, dt, dd, th, td, label, button, a, input, select, textarea), header :is(button, select, b)')].filter((element) => {
    const box = element.getBoundingClientRect();
    if (box.width === 0 || box.height === 0 || getComputedStyle(element).visibility === 'hidden') return false;
    if (beyond(box, { left: 0, right: innerWidth }) || (element.matches('button, .b') && element.scrollWidth > element.clientWidth + 1)) return true;
    for (let outer = element.parentElement; outer; outer = outer.parentElement) if (hidden(outer) && beyond(box, outer.getBoundingClientRect())) return true;
    return false;
  }).map((element) => element.outerHTML.slice(0, 120));
}

/** In a window of 320 px, which is 1280 px zoomed to 400 %, nothing scrolls horizontally (WCAG 2.2, SC 1.4.10). */
export async function expectNothingScrollsSideways(page, words) {
  const before = page.viewportSize();
  await page.setViewportSize({ width: 320, height: 640 });
  // Content that adapts to its size follows one frame later.
  await until(`${words} as wide as a window of 320 px`, () => page.evaluate(() => document.documentElement.scrollWidth <= 320));
  await page.setViewportSize(before);
}

/** Serious and critical accessibility faults by axe-core; or all. */
async function accessibilityFaults(page, all) {
  await page.evaluate(AXE);
  // Content that is still fading in would be tested half transparent.
  await page.evaluate(() => { for (const a of document.getAnimations()) if (Number.isFinite(a.effect?.getComputedTiming().endTime)) a.finish(); });
  const { violations } = await page.evaluate(() => globalThis.axe.run({ resultTypes: ['violations'] }));
  return violations
    .filter(({ impact }) => all || impact === 'serious' || impact === 'critical')
    .map(({ id, help, nodes }) => `${id}: ${help} (${nodes.map(({ html }) => html.slice(0, 100)).join(' | ')})`);
}

/** A person presses again so many times at most what a busy machine refused. */
const MOST_PRESSES = 5;
/** After this time a page has taken away the words of the press before. */
const TAKES_A_PRESS_MS = 300;

/** Presses until it acts. A refusal is read, and its button pressed again; one that comes every time fails at once, by its words. */
export async function pressUntil(what, page, { press, acted, refusal }) {
  for (let presses = 1; ; presses += 1) {
    await press();
    await new Promise((resolve) => setTimeout(resolve, TAKES_A_PRESS_MS));
    const words = await until(what, async () => (await acted() ? 'acted' : (await page.locator(refusal).filter({ visible: true }).allInnerTexts()).join(' ').trim()));
    if (words === 'acted') return;
    if (presses === MOST_PRESSES) throw new Error(`${what}: refused ${presses} times: ${words.replace(/\s+/g, ' ')}`);
  }
}

/** Calls `look` until it returns something true, and returns that. */
export async function until(what, look, { within_ms = HANGS_MS, every_ms = 100 } = {}) {
  const end_ms = Date.now() + within_ms;
  for (;;) {
    const found = await look();
    if (found) return found;
    if (Date.now() > end_ms) throw new Error(`not within ${within_ms / 1000} s: ${what}`);
    await new Promise((resolve) => setTimeout(resolve, every_ms));
  }
}
