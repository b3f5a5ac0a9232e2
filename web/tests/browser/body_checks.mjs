// Recordings with bodies of a game: the replay and the report draw them.
import { spawn } from 'node:child_process';
import { existsSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { openPage, until } from './browser.mjs';
import { expect } from './checks.mjs';
import { letProgram, startProgram } from './program.mjs';
import { replay, replayed, still, withQuery } from './replay_checks.mjs';
import { open } from './report_checks.mjs';

const PATIENT_MS = 120_000;
const PLAYER = join(dirname(fileURLToPath(import.meta.url)), 'play_with_bodies.py');
/** Beside the ball, which may have fallen out of the world. Each takes a few hundred pixels of a picture at least. */
const BODIES = 11;
const PIXELS_OF_BODIES = 3000;

/** A recording of a game that brings bodies, made once, with the Python client that stands beside the program. */
async function recordedBodies({ file, folder }) {
  const path = join(folder, 'bodies.h5');
  if (existsSync(path)) return path;
  const program = await startProgram({ file, folder, args: ['--wait', '--no-rehearsal', '--exercise', 'game-scene', '--record', path] });
  try {
    const python = { ...process.env, PYTHONPATH: join(dirname(file), 'python') };
    const player = spawn('/usr/bin/python3', ['-B', PLAYER, `127.0.0.1:${program.port}`], { env: python, stdio: ['ignore', 'inherit', 'pipe'] });
    const said = [];
    player.stderr.on('data', (data) => said.push(String(data)));
    const code = await new Promise((resolve) => player.once('exit', resolve));
    expect(code === 0, `the game ended with ${code}: ${said.join('')}`);
  } finally {
    await program.stop();
  }
  return path;
}

/** Pixels of the picture in the colour of a game's bodies: blue, in light and in shade. */
async function bluePixels(page) {
  const png = (await page.screenshot()).toString('base64');
  return page.evaluate(async (data) => {
    const bytes = Uint8Array.from(atob(data), (c) => c.charCodeAt(0));   // a report may fetch nothing
    const image = await createImageBitmap(new Blob([bytes], { type: 'image/png' }));
    const canvas = new OffscreenCanvas(image.width, image.height).getContext('2d');
    canvas.drawImage(image, 0, 0);
    const all = canvas.getImageData(0, 0, image.width, image.height).data;
    let blue = 0;
    for (let i = 0; i < all.length; i += 4) if (all[i + 2] > 70 && all[i + 2] > 1.25 * all[i + 1] && all[i + 1] > 1.1 * all[i]) ++blue;
    return blue;
  }, png);
}

/** The moment in the middle of those with all bodies, by looking every tenth of a second. */
async function drawnWithBodies(page) {
  await until('the whole picture', async () => (await replayed(page))?.quality === 'low', { within_ms: PATIENT_MS });
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

/** Bodies of a game come, are drawn and go, in the replay and in a report. */
export async function bodiesAreReplayed(drawing, recorded, picture) {
  const path = await recordedBodies(recorded);
  return replay(recorded, [path], async (url) => {
    const page = await openPage(drawing, withQuery(url, { lang: 'en', theme: 'light', quality: 'low' }));
    const { without, middle_s } = await drawnWithBodies(page);
    while ((await replayed(page)).time_s > middle_s + 0.05) {
      const { time_s } = await replayed(page);
      await page.keyboard.press('Shift+ArrowLeft');
      await still(page, 'a tenth back', (now) => now.time_s < time_s);
    }
    await still(page, 'all bodies', ({ bodies }) => bodies[0] >= BODIES);
    await picture(page, 'replay_bodies');
    const blue = await bluePixels(page);
    expect(blue > without + PIXELS_OF_BODIES, `${blue} blue pixels with bodies, ${without} without`);
    expect(page.faults.length === 0, page.faults.join('\n'));
    await page.context().close();
    return `${blue} pixels of bodies at ${middle_s.toFixed(1)} s, ${without} before; in the report ${await bodiesAreReported(drawing, recorded, path, middle_s, picture)}`;
  });
}

async function bodiesAreReported(drawing, recorded, path, at_s, picture) {
  const report = join(recorded.folder, 'bodies-report.html');
  await letProgram({ ...recorded, args: ['replay', path, '--report', report] });
  const { page, asked } = await open(drawing, report);
  await until('the picture is drawn', async () => (await page.locator('[data-testid=picture] img').count()) === 1, { within_ms: PATIENT_MS });
  await picture(page, 'report_bodies');
  await page.evaluate((time_s) => { location.hash = `replay=${time_s}`; }, at_s);
  await until('the viewer has all bodies', async () => {
    const now = await replayed(page);
    return now?.exact && now.quality !== 'none' && now.bodies[0] >= BODIES;
  }, { within_ms: PATIENT_MS });
  await picture(page, 'report_bodies_viewer');
  const blue = await bluePixels(page);
  expect(blue > PIXELS_OF_BODIES, `${blue} blue pixels in the report's viewer`);
  expect(asked.length === 1, `it asked for nothing but itself: ${asked.join(' ')}`);
  expect(page.faults.length === 0, page.faults.join('\n'));
  await page.context().close();
  return `${blue}`;
}
