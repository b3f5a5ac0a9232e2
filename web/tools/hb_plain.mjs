// Pictures of a page: node tools/shot.mjs <folder> <name>=<address> ... ; waits for window.wholehandStats and then ?settle seconds.
import { mkdirSync } from 'node:fs';
import { chromium } from 'playwright-core';

const [folder, ...pages] = process.argv.slice(2);
mkdirSync(folder, { recursive: true });
const browser = await chromium.launch({ executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium', args: ['--no-sandbox', '--disable-3d-apis'] });
const page = await browser.newPage({ viewport: { width: Number(process.env.W ?? 1280), height: Number(process.env.H ?? 800) } });
page.on('pageerror', (error) => console.error('page error:', error.message));
page.on('console', (message) => { if (message.type() === 'error' || message.type() === 'warning') console.error(`${message.type()}:`, message.text().slice(0, 300)); });
for (const entry of pages) {
  const at = entry.indexOf('=');
  const name = entry.slice(0, at), [address, ...steps] = entry.slice(at + 1).split(' ');
  await page.goto(address, { waitUntil: 'load' });
  await page.waitForTimeout(Number(process.env.SETTLE ?? 3000));
  for (const step of steps) {
    if (step.startsWith('wait:')) await page.waitForTimeout(Number(step.slice(5)));
    else if (step.startsWith('key:')) await page.keyboard.press(step.slice(4));
    else await page.dispatchEvent(step, 'click', {}, { timeout: 20000 });
  }
  await page.screenshot({ path: `${folder}/${name}.png`, timeout: 60000 });
  const stats = await page.evaluate(() => ({ ...window.wholehandReplay, state: document.body.dataset.state }));
  console.log(name, JSON.stringify(stats));
}
await browser.close();
