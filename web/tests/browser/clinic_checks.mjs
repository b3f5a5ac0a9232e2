// A therapist's use of /clinic with the real program and the real records process.
import { execFileSync } from 'node:child_process';
import { mkdtempSync, readFileSync } from 'node:fs';
import { join } from 'node:path';
import { expect, expectAccessible, expectNoFaults, expectNothingScrollsSideways, expectZoomable, HANGS_MS, openPage, pageUrl, until } from './browser.mjs';
import { startProgram } from './program.mjs';
import { recordings } from './recorded_checks.mjs';
import { RENDERING, STOPPED } from './watcher.mjs';

const PHRASE = 'a phrase for the test', PIN = '2468', CANARY = 'Canaria Zwitschermann';
/** Largest numbers of presses and fields until the first force, for a new and for a returning patient (from the issue). */
const MOST_ACTIONS = 12, MOST_PRESSES = 5;
const LANGUAGES = ['fr', 'de', 'en'];

export const id = (name) => `[data-testid="${name}"]`;

/** What a screen reader calls a control that is pressed or filled: a role that can be, and a name. The snapshot is YAML, which quotes a name with a colon. */
const NAMED = /^- '?(button|link|textbox|radio|checkbox|slider|spinbutton|combobox|summary) "[^"]*\p{L}/u;

/** Presses and fills, and counts both. Each control has a role and a name. */
export class Hands {
  count = 0;
  constructor(page) { this.page = page; }
  async press(name) { await this.choose(`${id(name)}:not([disabled])`); }
  async choose(selector) {
    await (await this.#named(selector)).click();
    this.count += 1;
  }
  async fill(name, words) {
    await (await this.#named(id(name))).fill(words);
    this.count += 1;
  }
  async #named(selector) {
    const control = this.page.locator(selector).first(), called = await control.ariaSnapshot();
    expect(NAMED.test(called), `a screen reader calls ${selector} "${called}"`);
    return control;
  }
}

/** Starts in a folder of its own: recordings of other tests would appear as sessions without a patient. */
export const start = async (t) => {
  const folder = mkdtempSync(join(t.folder, 'clinic-'));
  return Object.assign(await startProgram({ file: t.file, folder, args: ['--wait', '--clinic', join(folder, 'records'), '--no-rehearsal'] }), { folder });
};
// Refusals of the records are valid answers, and an ended process answers nothing: each test states which may occur.
export const open = (t, url, query = {}) => openPage(t.plain, pageUrl(url, '/clinic', { lang: 'en', theme: 'light', ...query }), { cutOff: true });
export const runState = (page) => page.evaluate(() => window.wholehandNow?.state?.runState);
const shows = (page, screen) => page.waitForSelector(`body[data-screen=${screen}]`);

async function stopIsInItsCorner(page, words) {
  const { width } = page.viewportSize();
  const box = await page.locator(id('emergency-stop')).boundingBox();
  expect(box && box.x + box.width > width - 24 && box.y < 24 && box.width > 44, `${words}: emergency stop at ${JSON.stringify(box)}`);
}

/** Three languages, light and dark, 200 % and a window of 320 px. Typed text is still there at the end. */
async function lookAt(t, page, words, everywhere = true) {
  for (const theme of ['light', 'dark']) {
    for (const language of everywhere ? LANGUAGES : ['en']) {
      await page.selectOption(id('language'), language);
      await page.waitForSelector(`html[lang=${language}]`);
      await expectAccessible(page, `${words}, ${language}, ${theme}:`, { all: true });
      // The texts are longest in French; colours were tested already.
      if (theme === 'light' && language !== 'de') await expectZoomable(page, `${words}, ${language}`);
    }
    await page.click(id('theme'));
  }
  await stopIsInItsCorner(page, words);
  await expectNothingScrollsSideways(page, words);
  await t.picture(page, `clinic-${words.replaceAll(' ', '-')}`);
}

export async function begin(t, page, look) {
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

/** Enters a patient with both sliders moved, and saves. */
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

/** Sets up a clinic with one patient. */
async function withPatient(t) {
  const program = await start(t);
  const page = await open(t, program.url);
  await begin(t, page, false);
  await page.click(id('first-patient'));
  const hands = new Hands(page);
  await addPatient(page, hands, CANARY);
  return { program, page, hands };
}

export async function enterPin(page, pin = PIN) {
  await page.waitForSelector(id('pin'));
  await page.fill(id('pin'), pin);
  await page.click(id('pin-ok'));
}

/** The records process of a program. */
export const recordsOf = (program) => execFileSync('pgrep', ['-P', String(program.pid)], { encoding: 'utf8' }).trim().split('\n').map(Number)
  .find((pid) => execFileSync('ps', ['-o', 'args=', '-p', String(pid)], { encoding: 'utf8' }).includes('clinic'));
/** Removes expected faults: refusals while nobody was signed in, and unanswered requests. */
export const forgive = (page) => { page.faults = page.faults.filter((fault) => !/^(401|403|409|423) http|net::ERR_|Failed to load resource/.test(fault)); };

async function endVisit(page) {
  await page.click(`${id('end-visit')}:enabled`);
  await page.waitForSelector(id('finish-done'));
  expect((await runState(page)) !== RENDERING, 'it still renders at the end of the visit');
}

/** From the first start to the end of a visit, and the next visit of the same person. */
export async function therapistTreatsAPatient(t) {
  const program = await start(t);
  const page = await open(t, program.url);
  await begin(t, page, true);
  await lookAt(t, page, 'no patients');
  // The presses for a new patient are counted from the account tile.
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
  // A session without a tick of a person is not a trial.
  await until('half a second of it', () => page.evaluate(() => window.wholehandNow.state.timeS > 0.5));
  await endVisit(page);
  await page.click(id('pain-after-0'));
  await lookAt(t, page, 'end of visit');
  await page.click(id('finish-done'));
  await page.waitForSelector(id('patient-card'));
  await lookAt(t, page, 'patient card', false);
  await page.click(id('to-patient'));
  await page.waitForSelector('[data-testid=visits] li');
  await until('both recordings measured', async () => (await page.innerText(id('visits'))).match(/being measured/g) === null && (await page.locator('[data-testid=visits] .trial').count()) >= 2)
    .catch(async ({ message }) => { throw new Error(`${message}: ${await page.innerText(id('visits'))}`); });
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

/** The limits of a person: typed, saved with the hand, and in force at the next visit's first force. */
export async function limitsHold(t) {
  const { program, page, hands } = await withPatient(t);
  await hands.press('limits');
  await page.waitForSelector(id('limit-x-upper'));
  await hands.fill('limit-x-upper', '12');
  await page.press(id('limit-x-upper'), 'Tab');
  await hands.press('save-limits');
  expect(/The device goes from/.test(await page.innerText('[data-axis=x]')), 'a limit beyond the device was not refused at its field');
  for (const [field, value] of [['limit-x-upper', '5'], ['limit-x-lower', '-8.5'], ['limit-finger_flexion-lower', '10'], ['limit-finger_flexion-upper', '170']]) {
    await hands.fill(field, value);
    await page.press(id(field), 'Tab');
  }
  await lookAt(t, page, 'limits');
  await hands.press('save-limits');
  await page.waitForSelector(id('begin-visit'));
  await until('the patient’s page says that there are limits', async () => /limits on 2 axes/.test(await page.innerText('main.patient')));
  await beginVisit(page, hands);
  await until('half a second of it', () => page.evaluate(() => window.wholehandNow.state.timeS > 0.5));
  await endVisit(page);
  await page.click(id('finish-done'));
  const recorded = recordings(program.folder).map((name) => readFileSync(join(program.folder, 'out', 'recordings', name), 'latin1'));
  expect(recorded.some((text) => text.includes('within_m = [-0.085, 0.05]')), `none of ${recorded.length} recordings holds the limits`);
  expectNoFaults(page);
  return 'limits of two axes in the recording';
}

/** Hidden names are not in the page; typed text is restored for the same account after a reload and a killed tab; the visit stays usable. */
export async function namesDisappear(t) {
  const { program, page, hands } = await withPatient(t);
  const patient = Number(/patient\/(\d+)/.exec(page.url())[1]);
  // A second therapist at the same browser.
  await page.click(id('to-settings'));
  await page.fill(id('account-name'), 'B. Rossi');
  await page.fill(id('account-pin'), '97531');
  await page.click(id('add-account'));
  await page.waitForSelector('.people :text("B. Rossi")');
  await page.goto(`${page.url().replace(/#.*/, '')}#/patient/${patient}`);
  await page.fill(id('note'), 'Shoulder first, says Canaria');
  await page.waitForSelector('[data-testid=note-state]:has-text("saved")');
  await beginVisit(page, hands);
  // Five minutes without input: the page's clock is moved.
  await page.evaluate(() => { const now = performance.now.bind(performance); performance.now = () => now() + 301_000; });
  await page.waitForSelector(id('show-names'));
  const left = await page.evaluate(() => `${document.documentElement.outerHTML} ${document.title} ${location.href} ${JSON.stringify({ ...localStorage, ...sessionStorage })}`);
  expect(!/Canaria|Zwitschermann|Shoulder/.test(left), 'a name or a note is left in the page while names are hidden');
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
  // Other patients need the PIN.
  await page.goto(`${page.url().replace(/#.*/, '')}#/patient/${patient}`);
  await page.waitForSelector(id('show-names'));
  expect(!(await page.content()).includes('Canaria'), 'an address led past the PIN');
  await page.click(id('show-names'));
  await page.waitForSelector(id('pin'));
  await lookAt(t, page, 'PIN');
  await enterPin(page);
  await page.waitForSelector(`header :text("${CANARY}")`);
  // Text that is not saved yet survives a reload.
  await page.fill(id('note'), 'Half a sent');
  await page.reload();
  await page.waitForSelector(id('note'));
  expect((await page.inputValue(id('note'))) === 'Half a sent' || (await page.locator(':text("Half a sent")').count()) > 0, 'a reload lost what was typed');
  // The records are absent, then the tab is killed. Typed text waits, encrypted, for the same person.
  const records = recordsOf(program);
  process.kill(records, 'SIGSTOP');
  await page.fill(id('note'), 'Half a sentence of Canaria');
  await page.waitForSelector('[data-testid=note-state]:has-text("when the records answer")');
  const killed = page.context();
  const again = await killed.newPage();
  await page.close();
  process.kill(records, 'SIGCONT');
  again.setDefaultTimeout(HANGS_MS);
  await again.goto(pageUrl(program.url, '/clinic', { lang: 'en' }));
  expect(!/Canaria/.test(await again.evaluate(() => JSON.stringify({ ...localStorage }))), 'what was typed can be read in the browser');
  const enter = async (name, pin) => {
    await again.click(`.tile:has-text("${name}")`);
    await enterPin(again, pin);
    await again.waitForSelector(id('to-patients'));
    await again.goto(`${again.url().replace(/#.*/, '')}#/patient/${patient}`);
    await again.waitForSelector(id('note'));
  };
  await again.waitForSelector('.tile');
  await enter('B. Rossi', '97531');
  // The records may have taken the text before the tab was killed: then it is a note of A. Keller's in everybody's list.
  expect((await again.inputValue(id('note'))) === '', 'another therapist is given what was typed');
  await again.click(id('to-settings'));
  await again.click(id('sign-out'));
  // The open visit stays; the choice of the account is behind it.
  await again.click(id('show-names'));
  await again.waitForSelector('.tile');
  await enter('A. Keller', PIN);
  const there = async () => (await again.inputValue(id('note'))) === 'Half a sentence of Canaria' || (await again.locator('.note-list :text("Half a sentence of Canaria")').count()) > 0;
  await until('the note, in its field or in the list', () => again.reload().then(() => again.waitForSelector(id('note'))).then(there), { every_ms: 2000 });
  return 'no name in the page, and nothing typed was lost';
}

/** The records process is killed in a session: the session continues, stop and marks work, and nothing is lost. */
export async function recordsAreKilled(t) {
  const { program, page, hands } = await withPatient(t);
  await beginVisit(page, hands);
  process.kill(recordsOf(program), 'SIGKILL');
  await page.waitForSelector(`[data-testid=records-silent]:not([hidden]), ${id('show-names')}`);
  expect((await runState(page)) === RENDERING, 'the session did not go on without records');
  await page.click(id('mark-tired'));
  await stopIsInItsCorner(page, 'records killed');
  await expectAccessible(page, 'records killed:');
  await page.click(id('emergency-stop'));
  await until('stopped', async () => (await runState(page)) === STOPPED);
  // After the program restarts the process, it needs the pass phrase.
  await page.waitForSelector(id('show-names'));
  await page.click(id('show-names'));
  await page.waitForSelector(id('unlock'));
  await lookAt(t, page, 'unlock', false);
  await page.fill(id('unlock-words'), PHRASE);
  await page.click(id('unlock'));
  await enterPin(page);
  await page.waitForSelector(`header :text("${CANARY}")`);
  await until('the mark saved', () => page.evaluate(() => Object.keys(localStorage).every((key) => !key.includes('outbox'))));
  forgive(page);
  expectNoFaults(page);
  return 'the session went on, and the mark is in the records';
}

/** Without records a session starts only under the gentle preset, from the page, and is assigned to a patient later. */
export async function sessionWithoutRecords(t) {
  const { program, page } = await withPatient(t);
  // Somebody leaves a raised limit at the console.
  const gentle = await page.evaluate(() => JSON.parse(localStorage['wholehand.gentle']));
  const limit = () => page.evaluate(() => { const { scene, state } = window.wholehandNow; return state.parameters[scene.parameters.findIndex(({ name }) => String(name) === 'effort_limit_hand_tip_n')]; });
  expect(gentle.effort_limit_hand_tip_n === 3, `the gentle preset is ${JSON.stringify(gentle)}`);
  const console_page = await openPage(t.plain, pageUrl(program.url, '/console', { lang: 'en' }));
  for (let i = 0; i < 3; i += 1) await console_page.click(`${id('more-effort_limit_hand_tip_n')}`);
  await until('a raised limit', async () => (await limit()) > 3);
  await console_page.close();
  const records = recordsOf(program);
  process.kill(records, 'SIGSTOP');
  await page.waitForSelector(id('to-alone'));
  await lookAt(t, page, 'patient, records gone', false);
  await page.click(id('to-alone'));
  await page.waitForSelector(id('alone'));
  await until('the gentle limit', async () => (await limit()) === 3);
  await lookAt(t, page, 'session without records');
  expect(/gentle preset/.test(await page.innerText('header')) && /3 N/.test(await page.innerText(id('alone'))), 'the screen does not name the gentle preset');
  expect(await page.isDisabled(id('arm')), 'it may be started before somebody said which hand is in the device');
  await page.click(id('side-right'));
  await page.click(`${id('arm')}:enabled`);
  await until('rendering', async () => (await runState(page)) === RENDERING);
  // A page that is opened now shows the session, with Stop and Pause.
  const other = await open(t, program.url);
  await other.waitForSelector(`${id('alone')}`);
  await other.waitForSelector(`${id('pause')}:enabled`);
  await stopIsInItsCorner(other, 'opened without records');
  await other.close();
  process.kill(records, 'SIGCONT');
  await page.waitForSelector(`${id('records-silent')}[hidden]`, { state: 'attached' });
  expect((await runState(page)) === RENDERING, 'the session ended when the records answered again');
  await page.click(`${id('gentle-stop')}:enabled`);
  await until('stopped', async () => (await runState(page)) === STOPPED);
  await page.click(id('to-patients'));
  await page.waitForSelector('[data-testid^=session-]');
  await lookAt(t, page, 'session without a patient');
  await page.click('[data-testid^=session-]');
  await page.click(`${id('give-sessions')}:enabled`);
  await page.click('[data-testid^=pick-]:not(input):not([data-testid=pick-cancel])');
  await page.click(id('pick-yes'));
  await until('no session left', async () => (await page.locator(id('loose-sessions')).count()) === 0);
  await page.click('tbody [data-testid^=patient-]');
  await until('the visit in the list', async () => (await page.locator('[data-testid=visits] .trial').count()) === 1);
  forgive(page);
  expectNoFaults(page);
  return 'started at 3 N at the fingertips, given to the patient afterwards';
}

/** Two consoles with one patient: each shows the other one's changes. */
export async function twoConsoles(t) {
  const { program, page, hands } = await withPatient(t);
  const other = await open(t, program.url);
  await enterPin(other);
  await other.click('tbody [data-testid^=patient-]');
  await other.waitForSelector(id('begin-visit'));
  await beginVisit(page, hands);
  await other.waitForSelector(`.hint:has-text("begun by A. Keller")`);
  await other.click(`${id('begin-visit')}:has-text("Go on")`);
  await other.click(id('side-right'));
  await endVisit(other);
  await other.click(id('finish-done'));
  await other.waitForSelector(id('patient-card'));
  await page.waitForSelector(`${id('visit-over')}:has-text("ended on another screen")`);
  expect((await page.locator(`${id('arm')}:enabled`).count()) === 0, 'a visit that was ended can still be started');
  await lookAt(t, page, 'visit ended elsewhere', false);
  // Both change the same patient.
  const edit = async (screen, words) => {
    await screen.click(id('to-patients'));
    await screen.click('tbody [data-testid^=patient-]');
    await screen.click(id('edit-patient'));
    await screen.fill(id('patient-warnings'), words);
  };
  await edit(page, 'mine');
  await edit(other, 'theirs');
  await other.click(id('save-patient'));
  await other.waitForSelector(id('begin-visit'));
  await page.click(id('save-patient'));
  await page.waitForSelector(`${id('both-texts')}:has-text("theirs")`);
  await expectAccessible(page, 'both texts:', { all: true });
  await page.click(id('keep-mine'));
  await page.waitForSelector(`${id('warnings')}:has-text("mine")`);
  forgive(page);
  expectNoFaults(page);
  return 'an ended visit and a changed patient are said on the other screen';
}
