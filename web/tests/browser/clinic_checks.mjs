// A therapist's way through /clinic, against the real program and the records' real process.
import { execFileSync } from 'node:child_process';
import { mkdtempSync } from 'node:fs';
import { join } from 'node:path';
import { expect, expectAccessible, expectNoFaults, expectNothingScrollsSideways, openPage, pageUrl, until } from './browser.mjs';
import { RENDERING, STOPPED } from './watcher.mjs';

const PHRASE = 'a phrase for the test', PIN = '2468', CANARY = 'Canaria Zwitschermann';
/** A new patient until the first force, a returning one: presses and fields (the figures). */
const MOST_ACTIONS = 12, MOST_PRESSES = 5;
const LANGUAGES = ['fr', 'de', 'en'];

const id = (name) => `[data-testid="${name}"]`;

/** Presses and fills, and counts both. */
class Hands {
  count = 0;
  constructor(page) { this.page = page; }
  async press(name) {
    await this.page.click(`${id(name)}:not([disabled])`);
    this.count += 1;
  }
  async choose(selector) {
    await this.page.click(selector);
    this.count += 1;
  }
  async fill(name, words) {
    await this.page.fill(id(name), words);
    this.count += 1;
  }
}

const start = async (t) => t.program('--clinic', mkdtempSync(join(t.folder, 'clinic-')), '--no-rehearsal');
// What the records refuse is an answer of theirs, and a process that was ended answers nothing: each test says what may fail.
const open = (t, url, query = {}) => openPage(t.plain, pageUrl(url, '/clinic', { lang: 'en', theme: 'light', ...query }), { cutOff: true });
const runState = (page) => page.evaluate(() => window.wholehandNow?.state?.runState);
const shows = (page, screen) => page.waitForSelector(`body[data-screen=${screen}]`);

async function stopIsInItsCorner(page, words) {
  const { width } = page.viewportSize();
  const box = await page.locator(id('emergency-stop')).boundingBox();
  expect(box && box.x + box.width > width - 24 && box.y < 24 && box.width > 44, `${words}: emergency stop at ${JSON.stringify(box)}`);
}

/** Three languages, light and dark, and a window of 320 px. What was typed is still there at the end. */
async function lookAt(t, page, words, everywhere = true) {
  for (const theme of ['light', 'dark']) {
    for (const language of everywhere ? LANGUAGES : ['en']) {
      await page.selectOption(id('language'), language);
      await page.waitForSelector(`html[lang=${language}]`);
      await expectAccessible(page, `${words}, ${language}, ${theme}:`);
    }
    await page.click(id('theme'));
  }
  await stopIsInItsCorner(page, words);
  await expectNothingScrollsSideways(page, words);
  await t.picture(page, `clinic-${words.replaceAll(' ', '-')}`);
}

async function begin(t, page, look) {
  await page.waitForSelector(id('make-clinic'));
  if (look) await lookAt(t, page, 'first start');
  await page.fill(id('pass-phrase'), PHRASE);
  await page.fill(id('pass-phrase-again'), PHRASE);
  await page.fill(id('tile-name'), 'A. Keller');
  await page.fill(id('tile-pin'), PIN);
  await page.click(id('make-clinic'));
  await page.waitForSelector(id('recovery-code'));
  if (look) await lookAt(t, page, 'recovery code', false);
  const code = await page.innerText(id('recovery-code'));
  await page.check(id('code-kept'));
  await page.click(id('code-done'));
  await page.waitForSelector(id('first-patient'));
  return code;
}

/** A patient with both sliders moved, saved. */
async function addPatient(page, hands, name, side = 'right') {
  await page.waitForSelector(id('patient-name'));
  await hands.fill('patient-name', name);
  await hands.choose(`${id('patient-side')} [data-key=${side}]`);
  await hands.fill(`hand-${side}-length_m`, '171');
  await hands.fill(`hand-${side}-breadth_m`, '77');
  await hands.press('save-patient');
  await page.waitForSelector(id('begin-visit'));
}

/** From the patient's page to the first force. */
async function beginVisit(page, hands, side = 'right') {
  await hands.press('begin-visit');
  await page.waitForSelector(id(`side-${side}`));
  expect(await page.isDisabled(id('arm')), 'it may be started before somebody said which hand is in the device');
  await hands.press(`side-${side}`);
  await hands.press('arm');
  await until('rendering', async () => (await runState(page)) === RENDERING);
}

async function endVisit(page) {
  await page.click(`${id('end-visit')}:enabled`);
  await page.waitForSelector(id('finish-done'));
  expect((await runState(page)) !== RENDERING, 'it still renders at the end of the visit');
}

/** From the first start to the end of a visit, and the next visit of the same person. */
export async function therapistKeepsAPatient(t) {
  const program = await start(t);
  const page = await open(t, program.url);
  await begin(t, page, true);
  await lookAt(t, page, 'no patients');
  // The way of a new patient is counted from the tile.
  await page.click(id('to-settings'));
  await shows(page, 'settings');
  await lookAt(t, page, 'settings');
  await page.click(id('sign-out'));
  const hands = new Hands(page);
  await page.waitForSelector(id('pin'));
  await lookAt(t, page, 'who works');
  await hands.fill('pin', PIN);
  await hands.press('pin-ok');
  await page.click(id('to-patients'));
  await hands.press('first-patient');
  await addPatient(page, hands, CANARY);
  await beginVisit(page, hands);
  const actions = hands.count;
  expect(actions <= MOST_ACTIONS, `a new patient takes ${actions} actions`);
  await page.click(id('pain-before-0'));
  await page.click(id('mark-tired'));
  await lookAt(t, page, 'visit');
  await page.click(id('next-item'));
  await until('the next item', async () => /Next|End/.test(await page.innerText('.plan [aria-current]')) || (await page.locator('.plan li:nth-child(2)[aria-current]').count()) === 1);
  expect((await runState(page)) !== RENDERING, 'the next item was started without a press');
  await page.click(`${id('arm')}:enabled`);
  await until('rendering', async () => (await runState(page)) === RENDERING);
  await endVisit(page);
  await page.click(id('pain-after-0'));
  await lookAt(t, page, 'end of visit');
  await page.click(id('finish-done'));
  await page.waitForSelector(id('patient-card'));
  await lookAt(t, page, 'patient card', false);
  await page.click(id('to-patient'));
  await page.waitForSelector('[data-testid=visits] li');
  await until('both recordings measured', async () => (await page.innerText(id('visits'))).match(/being measured/g) === null && (await page.locator('[data-testid=visits] .trial').count()) >= 2);
  expect(/pain before 0, after 0/.test(await page.innerText(id('visits'))), 'a pain of 0 was not kept');
  await lookAt(t, page, 'patient');
  await page.click(id('edit-patient'));
  await page.waitForSelector(id('patient-name'));
  await lookAt(t, page, 'edit');
  await page.click(id('form-back'));
  await page.waitForSelector(id('print-progress'));
  await page.click(id('print-progress'));
  await shows(page, 'progress');
  await lookAt(t, page, 'printed progress', false);
  await page.click(id('to-patients'));
  await page.waitForSelector('[data-testid^=patient-]');
  await lookAt(t, page, 'patients');
  const again = new Hands(page);
  await again.choose('tbody [data-testid^=patient-]');
  await page.waitForSelector(`${id('begin-visit')}:enabled`);
  await beginVisit(page, again);
  expect(again.count <= MOST_PRESSES, `a returning patient takes ${again.count} presses`);
  await endVisit(page);
  await page.click(id('finish-done'));
  await page.waitForSelector(id('patient-card'));
  expect(!page.url().includes('Canaria'), `the address says a name: ${page.url()}`);
  expectNoFaults(page);
  return `${actions} actions for a new patient, ${again.count} presses for a returning one`;
}

/** Hidden names are not in the page; what was typed comes back to the same account; the visit stays usable. */
export async function namesDisappear(t) {
  const program = await start(t);
  const page = await open(t, program.url);
  await begin(t, page, false);
  await page.click(id('first-patient'));
  const hands = new Hands(page);
  await addPatient(page, hands, CANARY);
  await page.fill(id('note'), 'Shoulder first, says Canaria');
  await page.waitForSelector('[data-testid=note-state]:has-text("saved")');
  await beginVisit(page, hands);
  await page.click(id('hide-names'));
  await page.waitForSelector(id('show-names'));
  const left = await page.evaluate(() => `${document.documentElement.outerHTML} ${document.title} ${location.href}`);
  expect(!/Canaria|Zwitschermann/.test(left), 'a name is left in the page while names are hidden');
  await lookAt(t, page, 'visit, names hidden');
  expect((await runState(page)) === RENDERING, 'hiding names stopped the session');
  await page.click(id('mark-spasm'));
  await page.click(id('next-item'));
  await until('a gentle stop', async () => (await runState(page)) === STOPPED);
  await until('the second item', async () => (await page.locator('.plan li:nth-child(2)[aria-current]').count()) === 1);
  await page.click(`${id('arm')}:enabled`);
  await until('rendering', async () => (await runState(page)) === RENDERING);
  await page.click(id('emergency-stop'));
  await until('stopped', async () => (await runState(page)) === STOPPED);
  await page.click(id('show-names'));
  await page.waitForSelector(id('pin'));
  await lookAt(t, page, 'PIN');
  await page.fill(id('pin'), PIN);
  await page.click(id('pin-ok'));
  await page.waitForSelector(`header :text("${CANARY}")`);
  // What is half typed outlives a reload, before it was saved.
  await page.fill(id('note'), 'Half a sent');
  await page.reload();
  await page.waitForSelector(id('note'));
  expect((await page.inputValue(id('note'))) === 'Half a sent' || (await page.locator(':text("Half a sent")').count()) > 0, 'a reload lost what was typed');
  return 'no name in the page, and nothing typed was lost';
}

/** The records' process is killed in a session: it goes on, stop and marks work, and nothing is lost. */
export async function recordsAreKilled(t) {
  const program = await start(t);
  const page = await open(t, program.url);
  await begin(t, page, false);
  await page.click(id('first-patient'));
  const hands = new Hands(page);
  await addPatient(page, hands, CANARY);
  await beginVisit(page, hands);
  const [child] = execFileSync('pgrep', ['-P', String(program.pid)], { encoding: 'utf8' }).trim().split('\n').map(Number)
    .filter((pid) => execFileSync('ps', ['-o', 'args=', '-p', String(pid)], { encoding: 'utf8' }).includes('clinic'));
  process.kill(child, 'SIGKILL');
  await page.waitForSelector(`[data-testid=records-silent]:not([hidden]), ${id('show-names')}`);
  expect((await runState(page)) === RENDERING, 'the session did not go on without records');
  await page.click(id('mark-tired'));
  await stopIsInItsCorner(page, 'records killed');
  await expectAccessible(page, 'records killed:');
  await page.click(id('emergency-stop'));
  await until('stopped', async () => (await runState(page)) === STOPPED);
  // Started again by the program, they need the pass phrase.
  await page.waitForSelector(id('show-names'));
  await page.click(id('show-names'));
  await page.waitForSelector(id('unlock'));
  await lookAt(t, page, 'unlock', false);
  await page.fill(id('unlock-words'), PHRASE);
  await page.click(id('unlock'));
  await page.waitForSelector(id('pin'));
  await page.fill(id('pin'), PIN);
  await page.click(id('pin-ok'));
  await page.waitForSelector(`header :text("${CANARY}")`);
  await until('the mark saved', () => page.evaluate(() => Object.keys(localStorage).every((key) => !key.endsWith('outbox'))));
  // Refusals while nobody was signed in, and questions that nobody answered, are what was looked for.
  page.faults = page.faults.filter((fault) => !/^(401|423) http|net::ERR_|Failed to load resource/.test(fault));
  expectNoFaults(page);
  return 'the session went on, and the mark is in the records';
}
