// A drink by every way of playing, with full help: what a person does who does only what the screen says.
import { build } from 'esbuild';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { PerspectiveCamera, Vector3 } from 'three';
import { openPage, pageUrl } from './browser.mjs';
import { expect, GOES_ON } from './checks.mjs';

const PATIENT_MS = 60_000;
/** A drink with full help. */
const DRINK_S = 60;
const wait = (ms) => new Promise((resolve) => setTimeout(resolve, ms));

/** A pad that presses its first button while window.padDown is true. */
const PAD = () => {
  navigator.getGamepads = () => [{
    connected: true, index: 0, mapping: 'standard', axes: [0, 0, 0, 0],
    buttons: Array.from({ length: 17 }, (_, i) => ({ value: Number(i === 0 && window.padDown === true), pressed: i === 0 && window.padDown === true })),
  }];
};

/** The page's own camera: where in the picture a point of the world is. */
async function cameraOf({ width, height }) {
  const file = join(dirname(fileURLToPath(import.meta.url)), '..', '..', 'src', 'scene', 'camera.ts');
  const { outputFiles } = await build({ entryPoints: [file], bundle: true, format: 'esm', write: false, logLevel: 'error' });
  const { placeCamera } = await import(`data:text/javascript;base64,${Buffer.from(outputFiles[0].text).toString('base64')}`);
  const camera = new PerspectiveCamera();
  placeCamera(camera, 'game', { right: true, counter_y: -0.253, row_z: -0.119 }, [], width, height);
  camera.updateMatrixWorld(true);
  return ([x, y, z]) => {
    const at = new Vector3(-y, z, -x).project(camera);
    return { x: (at.x * 0.5 + 0.5) * width, y: (0.5 - at.y * 0.5) * height };
  };
}

/**
 * Plays until the card that praises; the exercise's own clock is gated, the wall's only ends the waiting.
 * `press` is done once where the screen
 * asks for it, and again where it says so.
 */
async function drink(page, watcher, press) {
  const began_ms = Date.now();
  let pressed_ms = 0, said = [];
  for (;;) {
    const shown = await page.getAttribute('body', 'data-state');
    if (shown === 'success') break;
    expect(Date.now() - began_ms < 4 * 1000 * DRINK_S, `no drink: ${JSON.stringify((await watcher.now()).values)}; the screen said ${[...new Set(said)].join(' | ')}`);
    said.push(await page.textContent('[data-testid=instruction]'));
    if ((shown === 'reach' || shown === 'squeeze') && Date.now() - pressed_ms > 20_000) {
      pressed_ms = Date.now();
      await press(await watcher.now());
    }
    await wait(200);
  }
  const { values } = await watcher.now();
  expect(values.drink_time_s <= DRINK_S, `the drink took ${values.drink_time_s} s`);
  return `${values.drink_time_s.toFixed(0)} s`;
}

/** One page: a switch, the mouse, a finger, a pad; each mixes the drink of level 1. */
export async function drinksByEveryWay(browser, programUrl, watcher) {
  await watcher.page.waitForSelector('[data-testid=holder]:has-text("free")', { timeout: PATIENT_MS });
  const page = await openPage(browser, pageUrl(programUrl, '/', { lang: 'en', quality: 'low', level: '1' }), { hasTouch: true, init: PAD });
  // A starved machine loses the controls: a person presses "Go on".
  try {
    await page.evaluate(GOES_ON);
    await page.waitForSelector('[data-testid=start]', { timeout: PATIENT_MS });
    // Without the picture nobody points: it is loaded apart from the words.
    await page.waitForFunction(() => window.wholehandStats?.quality === 'low', null, { timeout: PATIENT_MS });
    await page.keyboard.press('Enter');
    const pixel = await cameraOf(page.viewportSize());
    const onBottle = (now) => pixel(now.bodies[now.dispensers[now.values.target_dispenser]]);
    const ways = {
      'one button': async () => { await page.keyboard.down('Space'); await wait(150); await page.keyboard.up('Space'); },
      mouse: async (now) => { const { x, y } = onBottle(now); await page.mouse.move(x - 60, y + 40); await page.mouse.move(x, y, { steps: 4 }); await page.mouse.down(); await wait(150); await page.mouse.up(); },
      touch: async (now) => { const { x, y } = onBottle(now); await page.touchscreen.tap(x, y); },
      pad: async () => { await page.evaluate(() => { window.padDown = true; }); await wait(150); await page.evaluate(() => { window.padDown = false; }); },
    };
    const took = [];
    for (const [name, press] of Object.entries(ways)) {
      await page.waitForSelector('body[data-state=reach]', { timeout: PATIENT_MS });
      await wait(500);
      took.push(`${name} ${await drink(page, watcher, press)}`);
      if (name !== 'pad') await page.keyboard.press('Enter');
    }
    return took.join(', ');
  } finally {
    await page.context().close();
  }
}
