// A device is commissioned through its page: one rail behind tests/devices/handled_driver.c; the test acts as the person.
import { closeSync, openSync, readFileSync, readSync, writeFileSync, writeSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { expect, expectAccessible, expectNoFaults, openPage, pageUrl, until } from './browser.mjs';
import { startProgram } from './program.mjs';

const ROOT = join(dirname(fileURLToPath(import.meta.url)), '..', '..', '..');
const [HAND, ENABLED, EFFORT, LARGEST] = [0, 4, 5, 7];  // fields of the driver's shared file
const ONE_FIFTH_N = 0.2 * 8.0;

/** The rail's memory, shared with its driver. */
class Rail {
  constructor(path) {
    writeFileSync(path, Buffer.alloc(64));
    this.file = openSync(path, 'r+');
  }

  get(at) {
    const bytes = Buffer.alloc(8);
    readSync(this.file, bytes, 0, 8, 8 * at);
    return bytes.readDoubleLE();
  }

  set(at, value) {
    const bytes = Buffer.alloc(8);
    bytes.writeDoubleLE(value);
    writeSync(this.file, bytes, 0, 8, 8 * at);
  }

  /** Moves by hand in small steps: a jump would look like a wrapping encoder. */
  async carry(to_m) {
    for (let at_m = this.get(HAND); Math.abs(at_m - to_m) > 1e-9;) {
      at_m += Math.max(-0.004, Math.min(0.004, to_m - at_m));
      this.set(HAND, at_m);
      await new Promise((resolve) => setTimeout(resolve, 10));
    }
    await new Promise((resolve) => setTimeout(resolve, 100));
  }

  close() { closeSync(this.file); }
}

/** The desktop device's file with only its axis x. */
function railFile(folder) {
  const [head, ...axes] = readFileSync(join(ROOT, 'config', 'devices', 'desktop-3axis.toml'), 'utf8').split('[[axes]]');
  const path = join(folder, 'rail.toml');
  writeFileSync(path, [head, ...axes.filter((axis) => /name = "x"/.test(axis))].join('[[axes]]'));
  return path;
}

const startCommission = ({ file, folder }) => startProgram({ file, folder, command: ['device', 'commission', '--web'], args: ['--operator', 'A. Name',
  '--device', railFile(folder), '--driver', join(process.env.WHOLEHAND_DRIVERS ?? join(dirname(file), 'drivers'), 'handled.so'), '--driver-settings', join(folder, 'rail')] });

/** Number of attempts. */
const SOON = { timeout: 2000 };
const task = (page, wanted) => page.waitForSelector(`body[data-task=${wanted}]`);
const press = (page, id) => page.click(`[data-testid="${id}"]:enabled`);

/**
 * Holds the button until a condition is true. A shared machine may be so late that a press ends, and with it the step, or
 * that the page loses the lead: then it is pressed again, as a person would do.
 */
async function holdUntil(what, page, [down, up], isSo) {
  await until(what, async () => {
    const now = await page.evaluate(() => ({ task: document.body.dataset.task, held: document.querySelector('.hold')?.classList.contains('held') }));
    if (isSo(now.task)) return true;
    if (now.task === 'lead') await press(page, 'lead');
    if (now.task === 'next') await press(page, 'answer-done');
    if (now.task === 'hold' && !now.held) {
      await up();
      // The button may disappear meanwhile, with the step that ended: the page is checked again.
      await down().catch((error) => { if (error.name !== 'TimeoutError') throw error; });
    }
    return false;
  });
}

/** Holds until the task is another one than holding. */
async function hold(page, press, wanted) {
  await holdUntil(`the task ${wanted}`, page, press, (now) => now === wanted);
  await press[1]();
}

const byMouse = (page) => [async () => { await page.hover('[data-testid=hold]', SOON); await page.mouse.down(); }, () => page.mouse.up()];
const bySpace = (page) => [async () => { await page.focus('[data-testid=hold]', SOON); await page.keyboard.down('Space'); }, () => page.keyboard.up('Space')];

/** Up to the first long move: another console only watches, and a pointer or a key must be held. */
async function leadToGravity(t, page, other, rail) {
  await task(page, 'lead');
  await press(page, 'lead');
  await task(page, 'yes-no');
  await task(other, 'watch');
  await press(page, 'answer-yes');
  await until('the question whether nobody is attached', async () => {
    if (await page.isVisible('text=/nobody attached/i')) return true;
    // The page may have lost the lead meanwhile (see hold()), so the sequence starts again.
    if (await page.evaluate(() => document.body.dataset.task) === 'lead') {
      await press(page, 'lead');
      await task(page, 'yes-no');
      if (!await page.isVisible('text=/nobody attached/i')) await press(page, 'answer-yes');
    }
    return false;
  });
  await t.picture(page, 'commission-question');
  await press(page, 'answer-yes');
  await task(page, 'hold');
  await page.click('[data-testid=hold]');
  await new Promise((resolve) => setTimeout(resolve, 500));
  expect(await page.getAttribute('[data-step=home]', 'data-state') === 'UnderWay', 'a click homed it');
  await hold(page, byMouse(page), 'done');
  await rail.carry(0.012);
  await press(page, 'answer-done');
  await task(page, 'hold');
  expect(rail.get(LARGEST) === 0, 'effort before the button is held');
  await hold(page, bySpace(page), 'number');
  expect(rail.get(LARGEST) > 0, 'no effort while it was held');
  await rail.carry(-0.061);
  await rail.carry(0.061);
  await page.fill('[data-testid=number]', '0,122');
  await press(page, 'answer');
  await task(page, 'hold');
}

/** Commissions up to gravity; the page is lost during a move; another page takes over and repeats the step. */
export async function commissionedThroughThePage(t) {
  const rail = new Rail(join(t.folder, 'rail'));
  const { url, ended } = await startCommission(t);
  try {
    const query = { lang: 'en', theme: 'light' };
    const page = await openPage(t.plain, pageUrl(url, '/commission', query), { cutOff: true });
    const other = await openPage(t.plain, pageUrl(url, '/commission', query), { cutOff: true });
    await leadToGravity(t, page, other, rail);
    await holdUntil('effort', page, byMouse(page), () => rail.get(ENABLED) === 1 && Math.abs(rail.get(EFFORT)) > 0.01);
    await t.picture(page, 'commission-moving');
    await expectAccessible(page);
    expectNoFaults(page);
    await page.context().close();
    await until('neutral', () => rail.get(EFFORT) === 0 && rail.get(ENABLED) === 0, { every_ms: 5 });
    expect(rail.get(LARGEST) <= ONE_FIFTH_N + 1e-9, `an effort of ${rail.get(LARGEST)} N`);
    await task(other, 'lead');
    await press(other, 'lead');
    await task(other, 'next');
    await t.picture(other, 'commission-failed');
    const failed = await other.innerText('[data-testid=failed]');
    expect(/the key was let go/.test(failed), `it says "${failed}"`);
    await expectAccessible(other);
    await press(other, 'answer-quit');
    expect((await ended).code === 1, 'it did not end as unfinished');
    return 'to gravity and a lost page in mid-move, at neutral, taken over by another';
  } finally {
    rail.close();
  }
}
