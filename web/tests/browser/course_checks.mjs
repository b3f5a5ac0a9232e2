// A course as a therapist does it: presses and the time that the program takes. Then what is rarely done: paper, table, recovery code, erasing.
import { readFileSync } from 'node:fs';
import { begin, enterPin, forgive, Hands, id, open, recordsOf, runState, start } from './clinic_checks.mjs';
import { expect, expectNoFaults, sheetsOf, until } from './browser.mjs';
import { RENDERING } from './watcher.mjs';

const VISITS = 3, MOST_PRESSES = 40;
const NAME = 'Berta Kursmann';

/** Counts presses and fields, and the time from each until the next one is possible. */
class TimedHands extends Hands {
  waited_ms = 0;
  /** @param then what the page must show before the therapist can go on */
  async press(name, then) {
    await this.page.waitForSelector(`${id(name)}:not([disabled])`);
    await super.press(name);
    const began_ms = performance.now();
    await then?.();
    this.waited_ms += performance.now() - began_ms;
  }
}

export async function courseOfThreeVisits(t) {
  const program = await start(t);
  const page = await open(t, program.url);
  const code = await begin(t, page, false);
  const hands = new TimedHands(page), shows = (name) => () => page.waitForSelector(`${id(name)}:not([disabled])`), renders = () => until('rendering', async () => (await runState(page)) === RENDERING);
  const person = await aNewPatient(page, hands, shows);
  const first = hands.count;
  for (let visit = 1; visit <= VISITS; visit += 1) await aVisit(page, hands, shows, renders);
  const visits = hands.count;
  await page.evaluate(() => { window.printed = 0; window.print = () => { window.printed += 1; }; });
  await hands.press('print-progress', shows('print'));
  await hands.press('print');
  expect(await page.evaluate(() => window.printed) === 1, 'nothing was printed');
  const words = `${hands.count} presses and fields (${first} for the patient, ${visits - first} for ${VISITS} visits), ${(hands.waited_ms / 1000).toFixed(1)} s of waiting for the program`;
  console.log(`figure: a course: ${words}`);
  expect(hands.count <= MOST_PRESSES, words);
  const paper = await page.innerText('.paper');
  expect(paper.includes(NAME) && (paper.match(/min/g) ?? []).length >= VISITS, `the sheet: ${paper}`);
  expect(await sheetsOf(page) >= 1, 'no paper');
  await tableIsSaved(page, person);
  await aVisitByKeyboard(page);
  await recoveryCodeOpens(program, page, code);
  await personIsErased(page, person);
  forgive(page);
  expectNoFaults(page);
  return words;
}

/** A patient whose plan is filled by a goal. @returns the number in the address */
async function aNewPatient(page, hands, shows) {
  await hands.press('first-patient', shows('patient-name'));
  await hands.fill('patient-name', NAME);
  await hands.choose(`${id('patient-side')} [data-key=right]`);
  await hands.fill('hand-right-length_m', '180');
  await hands.fill('hand-right-breadth_m', '80');
  await hands.choose('[data-testid^=goal-]');
  await hands.press('save-patient', shows('begin-visit'));
  return Number(/patient\/(\d+)/.exec(page.url())[1]);
}

/** Two exercises of the plan, each started and played for a moment; the end, and back to the person. */
async function aVisit(page, hands, shows, renders) {
  await hands.press('begin-visit', shows('side-right'));
  await hands.press('side-right', shows('arm'));
  await hands.press('arm', renders);
  await until('half a second of it', () => page.evaluate(() => window.wholehandNow.state.timeS > 0.5));
  await hands.press('next-item', shows('arm'));
  await hands.press('arm', renders);
  await until('half a second of it', () => page.evaluate(() => window.wholehandNow.state.timeS > 0.5));
  await hands.press('end-visit', shows('finish-done'));
  await hands.press('finish-done', () => page.waitForSelector(id('patient-card')));
  await hands.press('to-patient', shows('begin-visit'));
}

/** Presses a control that the Tab key reaches. */
async function byTab(page, name) {
  await page.waitForSelector(`${id(name)}:not([disabled])`);
  for (let tabs = 0; tabs < 80; tabs += 1) {
    if (await page.evaluate((wanted) => document.activeElement?.getAttribute('data-testid') === wanted, name)) return page.keyboard.press('Enter');
    await page.keyboard.press('Tab');
  }
  throw new Error(`80 presses of Tab do not reach ${name}`);
}

/** A visit as somebody who sees nothing does it: by Tab and Enter; what happened is announced. */
async function aVisitByKeyboard(page) {
  await page.evaluate(() => {
    window.announced = [];
    new MutationObserver((changes) => {
      for (const { target } of changes) {
        const live = (target.nodeType === 1 ? target : target.parentElement)?.closest('[role=status], [role=alert], [aria-live]');
        if (live?.textContent) window.announced.push(live.textContent);
      }
    }).observe(document.body, { subtree: true, childList: true, characterData: true });
  });
  for (const name of ['begin-visit', 'side-right', 'arm']) await byTab(page, name);
  await until('rendering', async () => (await runState(page)) === RENDERING);
  await byTab(page, 'mark-tired');
  await until('an announced mark', () => page.evaluate(() => window.announced.some((words) => /tired/i.test(words))));
  for (const name of ['end-visit', 'finish-done', 'to-patient']) await byTab(page, name);
  await page.waitForSelector(id('begin-visit'));
}

/** The table has a header and a row for each exercise of each visit. */
async function tableIsSaved(page, person) {
  await page.goto(`${page.url().replace(/#.*/, '')}#/patient/${person}`);
  const [saved] = await Promise.all([page.waitForEvent('download'), page.click(id('csv'))]);
  const lines = readFileSync(await saved.path(), 'utf8').trim().split(/\r?\n/), fields = lines[0].split(',').length;
  expect(lines.length > VISITS && fields > 3, `the table: ${lines.slice(0, 4).join(' | ')}`);
}

/** The recovery code opens the records after a restart of their process, as the pass phrase does. */
async function recoveryCodeOpens(program, page, code) {
  process.kill(recordsOf(program), 'SIGKILL');
  await page.waitForSelector(`${id('unlock')}, ${id('show-names')}`);
  if (await page.isVisible(id('show-names'))) await page.click(id('show-names'));
  await page.waitForSelector(id('unlock'));
  await page.click(id('unlock-other'));
  await page.fill(id('unlock-words'), code);
  await page.click(id('unlock'));
  await enterPin(page);
  await page.waitForSelector(id('to-patients'));
}

/** Erasing to its end: refused with a wrong code, then nobody is left in the list. */
async function personIsErased(page, person) {
  await page.goto(`${page.url().replace(/#.*/, '')}#/patient/${person}`);
  await page.waitForSelector(id('begin-visit'));
  await page.click('.mistakes > summary');
  const erase = page.locator('.mistakes details:has([data-testid=erase-yes])');
  await erase.locator('summary').click();
  const [asked] = /P-\d+/.exec(await erase.innerText());
  await page.fill(id('erase-code'), 'P-999');
  await page.click(id('erase-yes'));
  await erase.locator('.wrong').waitFor();
  await page.fill(id('erase-code'), asked);
  await page.click(id('erase-yes'));
  await page.waitForSelector('body[data-screen=patients]');
  await page.waitForSelector(id('empty'));
}
