// The first drink by every input method, with full help, by a person who does only what the screen says.
import { build } from 'esbuild';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { expect, openPage, pageUrl } from './browser.mjs';
import { GOES_ON, pressStart } from './checks.mjs';
import { startProgram } from './program.mjs';
import { openWatcher } from './watcher.mjs';

export const HANDS = join(dirname(fileURLToPath(import.meta.url)), '..', '..', '..', 'config', 'hands');
/** Time limit of a first drink with full help [s]; less than 1 ml is spilt. */
const DRINK_S = 30;
const NOTHING_L = 0.0005;
const wait = (ms) => new Promise((resolve) => setTimeout(resolve, ms));

/** The page's own modules, for the picture position of a world point. */
async function pagesCamera() {
  const sources = join(dirname(fileURLToPath(import.meta.url)), '..', '..', 'src');
  const contents = `export { placeCamera } from './scene/camera'; export { toThree } from './scene/frames';
    export { barOf } from './exercises/cocktail_bar/bar'; export { outlineOf } from './exercises/cocktail_bar/outline';
    export { PerspectiveCamera } from 'three';`;
  const { outputFiles } = await build({ stdin: { contents, resolveDir: sources, loader: 'ts' }, bundle: true, format: 'esm', write: false, logLevel: 'error' });
  return import(`data:text/javascript;base64,${Buffer.from(outputFiles[0].text).toString('base64')}`);
}

/** Position of a bottle in a picture of this size, by default of the current one [px]. `first` placed the camera. */
async function bottleIn({ width, height }, first) {
  const { placeCamera, toThree, barOf, outlineOf, PerspectiveCamera } = await pagesCamera();
  const point = ([x, y, z]) => ({ x, y, z });
  const bodies = Object.keys(first.bodies), bar = barOf(first), camera = new PerspectiveCamera();
  const state = { bodies: bodies.map((name) => ({ positionM: point(first.bodies[name]) })) };
  const row_z = -first.bodies[first.dispensers[0]][0];
  placeCamera(camera, 'game', { right: first.rightHand, counter_y: bar.counter_z_m, row_z }, outlineOf(bar, { bodies: bodies.map((name) => ({ name })) }, state), width, height);
  camera.updateMatrixWorld(true);
  return (now, dispenser = now.values.target_dispenser) => {
    const at = toThree(point(now.bodies[now.dispensers[dispenser]])).project(camera);
    return { x: (at.x * 0.5 + 0.5) * width, y: (0.5 - at.y * 0.5) * height };
  };
}

/** Presses on a place of the picture, or a key. */
const PRESSES = {
  click: async (page, { x, y }) => { await page.mouse.move(x - 60, y + 40); await page.mouse.move(x, y, { steps: 4 }); await page.mouse.down(); await wait(150); await page.mouse.up(); },
  twice: async (page, { x, y }) => { await page.mouse.dblclick(x, y, { delay: 60 }); },
  trembling: async (page, { x, y }) => {
    const shake = async (k) => page.mouse.move(x + 14 * Math.sin(7 * k), y + 14 * Math.cos(5 * k));
    for (let k = 0; k < 10; k += 1) await shake(k);
    // Sent at once: a page with software rendering answers each move after a frame, which would make the press long.
    await Promise.all([page.mouse.down(), shake(10), shake(11), page.mouse.up()]);
    for (let k = 12; k < 22; k += 1) await shake(k);
  },
  tap: async (page, { x, y }) => { await page.touchscreen.tap(x, y); },
  key: async (page) => { await page.keyboard.down('Space'); await wait(150); await page.keyboard.up('Space'); },
};

const DESKTOP = { side: 'right', lang: 'en', level: 1, width: 1280, height: 800 };
/** Every combination is played on the simulated clock (tests/every_drink.test.ts). */
const WAYS = [
  { name: 'mouse', press: 'click' }, { name: 'touch', press: 'tap' }, { name: 'keys', press: 'key' },
  { name: 'trembling', press: 'trembling' }, { name: 'double clicks', press: 'twice' },
  { name: 'level 2, a wrong click first', press: 'click', level: 2, wrong: true },
  { name: 'German', press: 'click', lang: 'de' }, { name: 'French', press: 'click', lang: 'fr' },
  { name: 'tablet', press: 'tap', width: 820, height: 1180 }, { name: 'landscape', press: 'tap', width: 844, height: 390 },
  { name: 'left', press: 'click', side: 'left' },
].map((way) => ({ ...DESKTOP, ...way }));

export const drinksByEveryWay = (t) => drinksBy(t, WAYS);
export const firstDrinkByMouse = (t) => drinksBy(t, WAYS.filter(({ name }) => name === 'mouse'));

/** A new page for each input method: each is somebody's first drink. */
async function drinksBy(t, ways) {
  const took = [], late = [];
  let program, watcher, side;
  for (const way of ways) {
    if (way.side !== side) {
      await watcher?.page.context().close();
      await program?.stop();
      program = await startProgram({ ...t, args: ['--wait', '--hand', join(HANDS, `adult-median-${way.side}.toml`)] });
      watcher = await openWatcher(t.plain, program.url, { role: 'watcher' });
      ({ side } = way);
    }
    const { drink_time_s: time_s, spilt_l, lost } = await firstDrink(t.drawing, program.url, watcher, way);
    const words = `${way.name} ${time_s.toFixed(1)} s, ${(1000 * spilt_l).toFixed(1)} ml spilt, controls lost ${lost} times`;
    console.log(`figure: first drink, ${words}`);
    took.push(words);
    if (time_s > DRINK_S || spilt_l > NOTHING_L) late.push(words);
  }
  await watcher.page.context().close();
  await program.stop();
  expect(late.length === 0, late.join('; '));
  return took.join('; ');
}

/** Starts, and presses whenever the screen asks for it, until the praise card. @return the exercise's values then */
async function firstDrink(browser, programUrl, watcher, { press, wrong, lang, level, width, height }) {
  const page = await openPage(browser, pageUrl(programUrl, '/', { lang, quality: 'low', level: String(level) }), { width, height, hasTouch: true, smooth: true, init: GOES_ON });
  // Pointing needs the picture, which is loaded separately from the texts.
  await page.waitForFunction(() => window.wholehandStats?.quality === 'low', null);
  await pressStart(page);
  await page.waitForSelector('body[data-state=reach]');
  const bottle = await bottleIn({ width, height }, await watcher.now());
  const { tick: began, dispensers, values: { target_dispenser } } = await watcher.now();
  if (wrong) {
    await PRESSES[press](page, bottle(await watcher.now(), (target_dispenser + 1) % dispensers.length));
    await wait(1500);
  }
  let pressed_ms = 0, before = '', instructions = [];
  for (;;) {
    const shown = await page.getAttribute('body', 'data-state');
    if (shown === 'success') break;
    const now = await watcher.now();
    expect(now.tick - began < 4 * 1000 * DRINK_S, `no drink: ${JSON.stringify(now.values)}; the screen said ${[...new Set(instructions)].join(' | ')}`);
    instructions.push(await page.textContent('[data-testid=instruction]'));
    const asksAnew = shown === 'reach' && before !== 'reach';
    before = shown;
    if (asksAnew || ((shown === 'reach' || shown === 'squeeze') && Date.now() - pressed_ms > 8000)) {
      pressed_ms = Date.now();
      await wait(500);
      await PRESSES[press](page, bottle(await watcher.now()));
    }
    await wait(200);
  }
  const { values } = await watcher.now(), lost = await page.evaluate(() => window.wentOn);
  await page.context().close();
  return { ...values, lost };
}
