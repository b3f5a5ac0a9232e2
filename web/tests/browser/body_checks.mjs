// Recordings with bodies of a game: the replay and the report draw them.
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { expect, openFile, openPage, until } from './browser.mjs';
import { letProgram } from './program.mjs';
import { replay, replayed, still, withQuery } from './replay_checks.mjs';

const PLAYER = join(dirname(fileURLToPath(import.meta.url)), 'play_with_bodies.py');
/** Bodies beside the ball, which may have fallen out of the world. Each covers at least a few hundred pixels of a picture. */
const BODIES = 11;
const PIXELS_OF_BODIES = 3000;

/** Records a game that adds bodies, played by the Python client that is shipped with the program. */
async function recordedBodies(t) {
  const path = join(t.folder, 'bodies.h5');
  const program = await t.program('--no-rehearsal', '--exercise', 'game-scene', '--record', path);
  await letProgram({ file: '/usr/bin/python3', folder: t.folder, args: ['-B', PLAYER, `127.0.0.1:${program.port}`], env: { ...process.env, PYTHONPATH: join(dirname(t.file), 'python') } });
  await program.stop();
  return path;
}

/** Number of pixels in the blue of a game's bodies, lit or shaded. */
async function bluePixels(page) {
  const png = (await page.screenshot()).toString('base64');
  return page.evaluate(async (data) => {
    const bytes = Uint8Array.from(atob(data), (c) => c.charCodeAt(0));   // a report may not use fetch()
    const image = await createImageBitmap(new Blob([bytes], { type: 'image/png' }));
    const canvas = new OffscreenCanvas(image.width, image.height).getContext('2d');
    canvas.drawImage(image, 0, 0);
    const all = canvas.getImageData(0, 0, image.width, image.height).data;
    let blue = 0;
    for (let i = 0; i < all.length; i += 4) if (all[i + 2] > 70 && all[i + 2] > 1.25 * all[i + 1] && all[i + 1] > 1.1 * all[i]) ++blue;
    return blue;
  }, png);
}

/** The middle of the time with all bodies, found by seeking in steps of a tenth of a second. */
async function drawnWithBodies(page) {
  await until('the whole picture', async () => (await replayed(page))?.quality === 'low');
  await page.keyboard.press('Home');
  await still(page, 'no body at first', ({ rows, bodies }) => rows[0] === 0 && bodies[0] === 0);
  const without = await bluePixels(page);
  const times = [];
  const counts = [];
  for (let last_s = -1; ;) {
    const now = await still(page, `a tenth of a second after ${last_s} s`, ({ time_s }) => time_s > last_s);
    counts.push(now.bodies[0]);
    if (now.bodies[0] >= BODIES) times.push(now.time_s);
    last_s = now.time_s;
    if ((times.length > 0 && now.bodies[0] === 0) || last_s > now.window.to_s - 0.01) break;
    await page.keyboard.press('Shift+ArrowRight');
  }
  expect(times.length > 2, `all ${BODIES} bodies at ${times.length} moments; bodies were ${counts.join(' ')}`);
  return { without, middle_s: times[Math.floor(times.length / 2)] };
}

/** Bodies of a game appear, are drawn and disappear, in the replay and in a report. */
export async function bodiesAreReplayed(t) {
  const path = await recordedBodies(t);
  const page = await openPage(t.drawing, withQuery(await replay(t, path), { lang: 'en', theme: 'light', quality: 'low' }));
  const { without, middle_s } = await drawnWithBodies(page);
  while ((await replayed(page)).time_s > middle_s + 0.05) {
    const { time_s } = await replayed(page);
    await page.keyboard.press('Shift+ArrowLeft');
    await still(page, 'a tenth back', (now) => now.time_s < time_s);
  }
  await still(page, 'all bodies', ({ bodies }) => bodies[0] >= BODIES);
  await t.picture(page, 'replay_bodies');
  const blue = await bluePixels(page);
  expect(blue > without + PIXELS_OF_BODIES, `${blue} blue pixels with bodies, ${without} without`);
  return `${blue} pixels of bodies at ${middle_s.toFixed(1)} s, ${without} before; in the report ${await bodiesAreReported(t, path, middle_s)}`;
}

async function bodiesAreReported(t, path, at_s) {
  const report = join(t.folder, 'bodies-report.html');
  await letProgram({ ...t, args: ['replay', path, '--report', report] });
  const { page, asked } = await openFile(t.drawing, report);
  await page.waitForSelector('[data-testid=picture] img');
  await t.picture(page, 'report_bodies');
  await page.evaluate((time_s) => { location.hash = `replay=${time_s}`; }, at_s);
  await until('the viewer has all bodies', async () => {
    const now = await replayed(page);
    return now?.exact && now.quality !== 'none' && now.bodies[0] >= BODIES;
  });
  await t.picture(page, 'report_bodies_viewer');
  const blue = await bluePixels(page);
  expect(blue > PIXELS_OF_BODIES, `${blue} blue pixels in the report's viewer`);
  expect(asked.length === 1, `it asked for nothing but itself: ${asked.join(' ')}`);
  return `${blue}`;
}
