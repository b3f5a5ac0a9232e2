// Takes pictures of a page: node tools/shot.mjs <folder> '<name>=<address> <step> ...' ...
// Steps: wait:<ms>, key:<key>, state:<value to wait for of document.body.dataset.state>, only:<selector of the captured part>, else a selector that is clicked.
// Environment: W, H (of the screen), SCALE (dots to a pixel), SETTLE (ms before the first step), CHROMIUM.
import { mkdirSync } from 'node:fs';
import { chromium } from 'playwright-core';

const [folder, ...pages] = process.argv.slice(2);
mkdirSync(folder, { recursive: true });
const browser = await chromium.launch({ executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium', args: ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'] });
const page = await browser.newPage({ viewport: { width: Number(process.env.W ?? 1280), height: Number(process.env.H ?? 800) }, deviceScaleFactor: Number(process.env.SCALE ?? 1) });
page.on('pageerror', (error) => console.error('page error:', error.message));
page.on('console', (message) => { if (message.type() === 'error' || message.type() === 'warning') console.error(`${message.type()}:`, message.text().slice(0, 300)); });
for (const entry of pages) {
  const at = entry.indexOf('=');
  const name = entry.slice(0, at), [address, ...steps] = entry.slice(at + 1).split(' ');
  await page.goto(address, { waitUntil: 'load' });
  await page.waitForTimeout(Number(process.env.SETTLE ?? 3000));
  let only;
  for (const step of steps) {
    if (step.startsWith('wait:')) await page.waitForTimeout(Number(step.slice(5)));
    else if (step.startsWith('state:')) await page.waitForFunction((state) => document.body.dataset.state === state, step.slice(6), { timeout: 120_000 });
    else if (step.startsWith('only:')) only = page.locator(step.slice(5));
    else if (step.startsWith('key:')) await page.keyboard.press(step.slice(4));
    else await page.dispatchEvent(step, 'click', {}, { timeout: 20000 });
  }
  await (only ?? page).screenshot({ path: `${folder}/${name}.png`, timeout: 60000 });
  const stats = await page.evaluate(() => ({ ...window.wholehandStats, state: document.body.dataset.state }));
  console.log(name, JSON.stringify(stats));
}
await browser.close();
