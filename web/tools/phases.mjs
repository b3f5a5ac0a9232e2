// The upper row of the paper's Fig. 7: the hand and its collision shapes in each phase of the exercise.
// node tools/phases.mjs <program> <folder> <page>: runs the exercise, shows its recording, and writes a page of the pictures.
import { execFileSync, spawn } from 'node:child_process';
import { readFileSync, writeFileSync } from 'node:fs';
import { openBrowser } from '../tests/browser/browser.mjs';

const [program, folder, page] = process.argv.slice(2);
execFileSync(program, ['experiment', 'exercise', '--out', folder], { stdio: 'ignore' });
const { phases } = JSON.parse(readFileSync(`${folder}/exercise.json`, 'utf8'));
const WORDS = ['① bumps into it', '② approaches', '③ squeezes', '④ lets go, retrieves'];
/** The moment of each phase that is shown, as a share of it. */
const SHARES = [0.05, 0.7, 0.4, 0.03];

/** In the page: waits for `count` frames. */
const framesPass = (count) => new Promise((resolve) => {
  const next = () => { if (count-- > 0) requestAnimationFrame(next); else resolve(); };
  next();
});

const replay = spawn(program, ['replay', `${folder}/exercise.h5`, '--web', '--port', '0'], { stdio: ['ignore', 'pipe', 'inherit'] });
const address = await new Promise((resolve) => replay.stdout.on('data', (text) => {
  const found = /http:\/\/\S+/.exec(String(text));
  if (found) resolve(found[0]);
}));
const browser = await openBrowser();
try {
  const tab = await browser.newPage({ viewport: { width: 1280, height: 900 }, deviceScaleFactor: 2 });
  await tab.goto(`${address}${address.includes('?') ? '&' : '?'}lang=en&theme=light`);
  await tab.waitForFunction(() => window.wholehandReplay?.loaded === 1 && window.wholehandReplay.quality !== 'none', null, { timeout: 180_000 });
  const line = tab.getByTestId('time-line'), view = tab.locator('.panel.view').first();
  await tab.addStyleTag({ content: '.panel.view > :not(canvas) { opacity: 0 }' });
  const pictures = [];
  for (const [i, phase] of phases.entries()) {
    const at_s = phase.start_s + SHARES[i] * (phase.end_s - phase.start_s);
    const [from_s, to_s] = await line.evaluate((it) => [Number(it.getAttribute('aria-valuemin')), Number(it.getAttribute('aria-valuemax'))]);
    const box = await line.boundingBox();
    await line.click({ position: { x: box.width * (at_s - from_s) / (to_s - from_s), y: 6 } });
    for (const look of ['Skin', 'Colliders']) {
      await tab.getByRole('radio', { name: look }).or(tab.getByRole('button', { name: look, exact: true })).first().click();
      await tab.waitForFunction(() => window.wholehandReplay.exact);
      await tab.waitForTimeout(2000);  // the picture switches to full quality
      await tab.evaluate(framesPass, 10);  // on a busy machine two seconds may contain no frame
      pictures.push({ i, look, at_s, png: (await view.screenshot()).toString('base64') });
    }
  }
  const row = (look) => pictures.filter((it) => it.look === look).map(({ i, at_s, png }) =>
    `<figure><img src="data:image/png;base64,${png}">${look === 'Skin' ? `<figcaption>${WORDS[i]}, ${at_s.toFixed(1)} s</figcaption>` : ''}</figure>`).join('');
  writeFileSync(page, `<!doctype html><meta charset="utf-8"><title>Phases</title><style>
    body { margin: 0; font: 15px sans-serif; } .paper { width: 1190px; padding: 12px; background: #fff; display: grid; grid-template-columns: repeat(4, 1fr); gap: 8px; }
    figure { margin: 0; display: flex; flex-direction: column-reverse; } figcaption { padding: 0 0 4px; } img { width: 100%; border-radius: 6px; }
    </style><body data-state="shown"><div class="paper">${row('Skin')}${row('Colliders')}</div>`);
} finally {
  await browser.close();
  replay.kill();
}
