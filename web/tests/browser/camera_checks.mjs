// Playing with a camera: Chromium's fake one, which shows a drawn hand.
import { writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { expect, expectAccessible, openPage, pageUrl, until } from './browser.mjs';
import { GOES_ON } from './checks.mjs';

/** Draws an open hand with its palm at the middle of a 640 × 480 picture, which hand tracking recognizes; returns a JPEG. */
async function pictureOfAHand() {
  const canvas = new OffscreenCanvas(640, 480), g = canvas.getContext('2d');
  const SIZE_PX = 100, at = (x, y) => [320 + SIZE_PX * x, 260 + SIZE_PX * y];
  // Fingers from the knuckle to the tip with their thickness, in lengths of the palm; the last is the thumb.
  const fingers = [[[-0.34, -0.1], [-0.52, -0.85], 0.17], [[-0.12, -0.2], [-0.17, -1.12], 0.19], [[0.11, -0.2], [0.14, -1.18], 0.19], [[0.33, -0.12], [0.47, -1], 0.19], [[0.35, 0.45], [0.92, -0.25], 0.21]];
  const line = (points, width_px, colour) => {
    g.strokeStyle = colour;
    g.lineWidth = width_px;
    g.beginPath();
    points.forEach((point) => g.lineTo(...at(...point)));
    g.stroke();
  };
  g.lineCap = g.lineJoin = 'round';
  g.fillStyle = '#7d8a92';
  g.fillRect(0, 0, 640, 480);
  for (const [colour, edge_px] of [['#a86c4a', 6], ['#d9a17c', 0]]) {
    for (const [from, to, thick] of fingers) line([from, to], SIZE_PX * thick + edge_px, colour);
    line([[0, 0.6], [0, 2.6]], SIZE_PX * 0.5 + edge_px, colour);
    line([[-0.33, -0.1], [0.33, -0.12], [0.3, 0.6], [-0.25, 0.6], [-0.33, -0.1], [0, 0.2], [0, 0.5]], SIZE_PX * 0.25 + edge_px, colour);
    g.fillStyle = colour;
    g.fillRect(...at(-0.3, -0.05), 0.58 * SIZE_PX, 0.6 * SIZE_PX);
  }
  // Creases at the joints and in the palm.
  for (const [[x, y], [tx, ty], thick] of fingers) for (const part of [0.38, 0.68]) {
    const [jx, jy] = [x + part * (tx - x), y + part * (ty - y)];
    line([[jx - 0.4 * thick, jy], [jx + 0.4 * thick, jy]], 2.5, '#b98260');
  }
  line([[0.4, 0.1], [0.02, 0.05], [-0.35, 0.2]], 2.5, '#b98260');
  line([[0.4, 0.15], [0.12, 0.3], [0.1, 0.7]], 2.5, '#b98260');
  const blob = await canvas.convertToBlob({ type: 'image/jpeg', quality: 0.95 });
  return [...new Uint8Array(await blob.arrayBuffer())];
}

/** A browser with a camera that shows the hand in a loop. */
async function browserWithCamera(t) {
  const jpeg = Buffer.from(await (await openPage(t.plain, 'about:blank')).evaluate(pictureOfAHand));
  const file = join(t.folder, 'hand.mjpeg');
  writeFileSync(file, Buffer.concat(Array.from({ length: 30 }, () => jpeg)));
  return t.browser({ args: ['--use-fake-device-for-media-stream', `--use-file-for-fake-video-capture=${file}`] });
}

async function startWithCamera(browser, url, options) {
  const page = await openPage(browser, pageUrl(url, '/', { lang: 'en', quality: 'low' }), { width: 480, height: 400, ...options });
  await page.click('[data-way=webcam]');
  await page.click('[data-testid=start]');
  return page;
}

/** A refused or missing camera is reported, and the game can still be started. */
export async function missingCameraIsReported(t) {
  const { url } = await t.watcher();
  const refusing = await t.browser({ with3d: false, args: ['--use-fake-device-for-media-stream'] });
  const texts = [];
  for (const [browser, permissions, words] of [[refusing, [], /refused/], [t.plain, ['camera'], /No camera/]]) {
    const text = (await startWithCamera(browser, url, { permissions })).getByText(words).first();
    await text.waitFor();
    texts.push(await text.textContent());
  }
  return texts.join(' ');
}

/** The camera is chosen, the hand kept in the frame, and played with; the camera is removed in play, and used again. */
export async function cameraPlays(t) {
  const { url } = await t.watcher();
  const browser = await browserWithCamera(t);
  const page = await startWithCamera(browser, url, { permissions: ['camera'], init: GOES_ON, smooth: true });
  await page.waitForSelector('.framing[data-step=frame].seen');
  await t.picture(page, 'camera-frame');
  expect(await page.evaluate(() => document.body.dataset.state) === 'framing', 'it steers before the hand was kept in the frame');
  const first = Number(await page.textContent('[data-testid=camera-count]'));
  expect(first >= 5 && first <= 10, `the count begins at ${first}`);
  await expectAccessible(page);
  await page.waitForSelector('body:is([data-state=reach], [data-state=squeeze], [data-state=hold], [data-state=drawback])');
  await page.waitForSelector('[data-testid=camera] video');
  await t.picture(page, 'camera-play');
  // Removal, as by a cable.
  await page.evaluate(() => { for (const track of document.querySelector('.camera video').srcObject.getTracks()) { track.stop(); track.dispatchEvent(new Event('ended')); } });
  await page.waitForSelector('text=/The camera has stopped/');
  await t.picture(page, 'camera-gone');
  await expectAccessible(page);
  await page.click('[data-testid=camera-again]');
  await page.waitForSelector('.framing[data-step=frame].seen');
  await page.click('[data-testid=camera-other]');
  await until('the play without the camera', () => page.evaluate(() => document.body.dataset.state !== 'framing' && !document.querySelector('video')));
  return `kept in the frame from ${first}; gone, said, and back`;
}
