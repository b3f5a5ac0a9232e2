import { mkdtempSync, mkdirSync, symlinkSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { openBrowser } from './browser.mjs';
import * as replays from './replay_checks.mjs';
const folder = mkdtempSync(join(tmpdir(), 'hb-try-'));
mkdirSync(join(folder, 'web')); symlinkSync('/tmp/hb-dist2', join(folder, 'web', 'dist'));
const recorded = { file: '/tmp/hb-run/root/build/release/wholehand', folder };
const plain = await openBrowser({ with3d: false });
const drawing = process.argv.includes('3d') ? await openBrowser() : plain;
const picture = (page, name) => page.screenshot({ path: join('/tmp/hb-browser', `${name}.png`), timeout: 100000 });
for (const [name, run] of [['one', () => replays.recordingIsReplayed(plain, drawing, recorded, picture)], ['two', () => replays.twoAreReplayed(plain, recorded, picture)], ['bad', () => replays.badRecordingsAreSaid(plain, recorded, picture)]]) {
  if (process.argv.length > 2 && !process.argv.includes(name)) continue;
  const t = Date.now();
  try { console.log('ok', name, await run(), Date.now() - t); } catch (e) { console.log('FAIL', name, e.message, Date.now() - t); }
}
await plain.close(); if (drawing !== plain) await drawing.close();
