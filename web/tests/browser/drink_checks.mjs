// A drink by every way of playing, with full help: what a person does who does only what the screen says.
import { build } from 'esbuild';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { PerspectiveCamera, Vector3 } from 'three';
import { expect, openPage, pageUrl } from './browser.mjs';
import { GOES_ON } from './checks.mjs';
import { startProgram } from './program.mjs';
import { openWatcher } from './watcher.mjs';

const HANDS = join(dirname(fileURLToPath(import.meta.url)), '..', '..', '..', 'config', 'hands');
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

/** The page's own modules, for where in the picture a point of the world is. */
async function pagesCamera() {
  const sources = join(dirname(fileURLToPath(import.meta.url)), '..', '..', 'src');
  const contents = `export { placeCamera } from './scene/camera'; export { toThree } from './scene/frames';
    export { barOf } from './exercises/cocktail_bar/bar'; export { outlineOf } from './exercises/cocktail_bar/outline';
    export { PerspectiveCamera } from 'three';`;
  const { outputFiles } = await build({ stdin: { contents, resolveDir: sources, loader: 'ts' }, bundle: true, format: 'esm', write: false, logLevel: 'error' });
  return import(`data:text/javascript;base64,${Buffer.from(outputFiles[0].text).toString('base64')}`);
}

/** Where in a picture of this size the bottle is drawn that is asked for [px]. The picture was placed by `first`. */
async function bottleIn({ width, height }, first) {
  const { placeCamera, toThree, barOf, outlineOf, PerspectiveCamera } = await pagesCamera();
  const point = ([x, y, z]) => ({ x, y, z });
  const bodies = Object.keys(first.bodies), bar = barOf(first), camera = new PerspectiveCamera();
  const state = { bodies: bodies.map((name) => ({ positionM: point(first.bodies[name]) })) };
  const row_z = -first.bodies[first.dispensers[0]][0];
  placeCamera(camera, 'game', { right: first.rightHand, counter_y: bar.counter_z_m, row_z }, outlineOf(bar, { bodies: bodies.map((name) => ({ name })) }, state), width, height);
  camera.updateMatrixWorld(true);
  return (now) => {
    const at = toThree(point(now.bodies[now.dispensers[now.values.target_dispenser]])).project(camera);
    return { x: (at.x * 0.5 + 0.5) * width, y: (0.5 - at.y * 0.5) * height };
  };
}

/** New buttons are deaf for a moment. */
async function pressEnter(page) {
  await page.waitForSelector('.overlay:not([data-fresh])');
  await page.keyboard.press('Enter');
}

/**
 * Plays until the card that praises; the exercise's own clock is gated.
 * `press` is done once where the screen
 * asks for it, and again where it says so.
 */
async function drink(page, watcher, press) {
  const { tick: began } = await watcher.now();
  let pressed_ms = 0, before = '', said = [];
  for (;;) {
    const shown = await page.getAttribute('body', 'data-state');
    if (shown === 'success') break;
    expect((await watcher.now()).tick - began < 4 * 1000 * DRINK_S, `no drink: ${JSON.stringify((await watcher.now()).values)}; the screen said ${[...new Set(said)].join(' | ')}`);
    said.push(await page.textContent('[data-testid=instruction]'));
    const asksAnew = shown === 'reach' && before !== 'reach';
    before = shown;
    if (asksAnew || ((shown === 'reach' || shown === 'squeeze') && Date.now() - pressed_ms > 20_000)) {
      pressed_ms = Date.now();
      await wait(500);
      await press(await watcher.now());
    }
    await wait(200);
  }
  const { values } = await watcher.now();
  expect(values.drink_time_s <= DRINK_S, `the drink took ${values.drink_time_s} s`);
  return `${values.drink_time_s.toFixed(0)} s`;
}

/** Both hands, every level, four screens. Every combination is played on the simulated clock (tests/every_drink.test.ts). */
const PLACES = [
  { side: 'right', level: 1, width: 1280, height: 800 }, { side: 'left', level: 2, width: 820, height: 1180 },
  { side: 'right', level: 3, width: 1920, height: 1080 }, { side: 'left', level: 4, width: 390, height: 844 },
];

/** A switch, the keys, the mouse, a finger and a pad each mix a drink. */
export async function drinksByEveryWay(t) {
  const took = [];
  for (const place of PLACES) {
    const program = await startProgram({ ...t, args: ['--hand', join(HANDS, `adult-median-${place.side}.toml`), '--level', String(place.level)] });
    const watcher = await openWatcher(t.plain, program.url);
    const words = await drinksAt(t.drawing, program.url, watcher, place);
    console.log(`figure drinks, ${place.side} hand, level ${place.level}, ${place.width} × ${place.height}: ${words}`);
    took.push(words);
    await watcher.page.context().close();
    await program.stop();
  }
  return `${took.length} places: ${took.join('; ')}`;
}

async function drinksAt(browser, programUrl, watcher, { level, width, height }) {
  const page = await openPage(browser, pageUrl(programUrl, '/', { lang: 'en', quality: 'low', level: String(level) }), { width, height, hasTouch: true, smooth: true, init: [PAD, GOES_ON] });
  await page.waitForSelector('[data-testid=start]');
  // Without the picture nobody points: it is loaded apart from the words.
  await page.waitForFunction(() => window.wholehandStats?.quality === 'low', null);
  await pressEnter(page);
  const bottle = await bottleIn({ width, height }, await watcher.now());
  const ways = {
    'one button': async () => { await page.keyboard.down('Space'); await wait(150); await page.keyboard.up('Space'); },
    keys: async () => { await page.keyboard.up('Space'); await wait(400); await page.keyboard.down('Space'); },   // and holds it
    mouse: async (now) => { const { x, y } = bottle(now); await page.mouse.move(x - 60, y + 40); await page.mouse.move(x, y, { steps: 4 }); await page.mouse.down(); await wait(150); await page.mouse.up(); },
    touch: async (now) => { const { x, y } = bottle(now); await page.touchscreen.tap(x, y); },
    pad: async () => { await page.evaluate(() => { window.padDown = true; }); await wait(150); await page.evaluate(() => { window.padDown = false; }); },
  };
  const took = [];
  for (const [name, press] of Object.entries(ways)) {
    await page.waitForSelector('body[data-state=reach]');
    await wait(500);
    took.push(`${name} ${await drink(page, watcher, press)}`);
    await page.keyboard.up('Space');
    if (name !== 'pad') await pressEnter(page);
  }
  await page.context().close();
  return took.join(', ');
}
