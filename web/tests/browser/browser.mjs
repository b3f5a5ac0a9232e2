// Debian's Chromium, with and without 3D, and what its pages say went wrong.
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { chromium } from 'playwright-core';

const require = createRequire(import.meta.url);
const AXE = readFileSync(require.resolve('axe-core/axe.min.js'), 'utf8');
// Only 3D goes to the software renderer: pages and plots are drawn by the processor directly.
const SOFTWARE_3D = ['--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--ignore-gpu-blocklist', '--disable-gpu-rasterization', '--disable-accelerated-2d-canvas'];

export function openBrowser({ with3d = true, args = [] } = {}) {
  return chromium.launch({
    executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
    headless: true,
    args: ['--no-sandbox', ...(with3d ? SOFTWARE_3D : ['--disable-3d-apis']), ...args],
  });
}

/** Address of a page of the program; WHOLEHAND_PAGES takes the pages from a development server instead. */
export function pageUrl(programUrl, path, query = {}) {
  const pages = process.env.WHOLEHAND_PAGES;
  const url = new URL(path, pages ?? programUrl);
  for (const [key, value] of Object.entries(query)) url.searchParams.set(key, value);
  if (pages) url.searchParams.set('server', `127.0.0.1:${new URL(programUrl).port}`);
  return url.href;
}

/** A page that remembers its own errors. */
export async function openPage(browser, url, { width = 1280, height = 800, locale = 'en-GB', ...more } = {}) {
  const context = await browser.newContext({ viewport: { width, height }, locale, ...more });
  const page = await context.newPage();
  page.faults = [];
  page.on('pageerror', (error) => page.faults.push(error.message));
  page.on('console', (message) => {
    // Expected, and said by the browser itself: a program that is down, a browser opened without 3D.
    if (message.type() === 'error' && !/WebSocket|ERR_CONNECTION|Failed to load resource|WebGL/.test(message.text())) page.faults.push(message.text());
  });
  // Not until everything is loaded: a page that draws in software keeps its own machine busy.
  await page.goto(url, { waitUntil: 'commit', timeout: 120_000 });
  return page;
}

/** Faults that keep somebody out: serious and critical ones, by axe-core. */
export async function accessibilityFaults(page) {
  await page.evaluate(AXE);
  const { violations } = await page.evaluate(() => globalThis.axe.run());
  return violations
    .filter(({ impact }) => impact === 'serious' || impact === 'critical')
    .map(({ id, help, nodes }) => `${id}: ${help} (${nodes.map(({ html }) => html.slice(0, 100)).join(' | ')})`);
}

/** Calls `look` until it gives something true, and gives that. */
export async function until(what, look, { within_ms = 10_000, every_ms = 100 } = {}) {
  const end_ms = Date.now() + within_ms;
  for (;;) {
    const found = await look();
    if (found) return found;
    if (Date.now() > end_ms) throw new Error(`not within ${within_ms / 1000} s: ${what}`);
    await new Promise((resolve) => setTimeout(resolve, every_ms));
  }
}
