// Tests in a real browser against the real program:
//   node web/tests/browser/run.mjs [--program FILE] [--out FOLDER] [--share I/N] [--first | --rest] [--list] [part of a test's name ...]
// FILE: build/release/wholehand. FOLDER: for pictures and figures, web/test-output/browser. The pages are those that
// the program finds; WHOLEHAND_PAGES names others. CHROMIUM names another browser than /usr/bin/chromium.
// I/N: runs only the I-th of every N tests, so that N shares can run in parallel.
// --first: those that ./check runs without --deep; --rest: the others; --list: prints their names.
// WHOLEHAND_FULL=1 also runs the tests whose names end in _slow, and keeps pictures.
import { mkdirSync, mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { dirname, join, resolve } from 'node:path';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';
import { bodiesAreReplayed } from './body_checks.mjs';
import * as cameras from './camera_checks.mjs';
import { chartsAreOneFile } from './chart_checks.mjs';
import * as checks from './checks.mjs';
import * as clinic from './clinic_checks.mjs';
import { commissionedThroughThePage } from './commission_checks.mjs';
import { besideAConsole, costOf } from './cost_checks.mjs';
import { courseOfThreeVisits } from './course_checks.mjs';
import { drinksByEveryWay, firstDrinkByMouse } from './drink_checks.mjs';
import { FULL, Harness } from './harness.mjs';
import { hourOfPlayLeaksNothing } from './hour_checks.mjs';
import { newcomerFinds } from './newcomer_checks.mjs';
import { drawerIsOpenedAndShut, newcomerDoesTheFirstTask } from './kitchen_checks.mjs';
import * as panels from './panel_checks.mjs';
import { lostPictureIsReported } from './picture_checks.mjs';
import { takePictures } from './pictures.mjs';
import * as presence from './presence_checks.mjs';
import { tenChangesAsPixels } from './same_pixels_checks.mjs';
import { stopsAtRandomMoments } from './random_stops.mjs';
import * as recorded from './recorded_checks.mjs';
import * as replays from './replay_checks.mjs';
import * as reports from './report_checks.mjs';
import * as roles from './role_checks.mjs';
import * as stops from './stop_checks.mjs';
import * as trouble from './trouble_checks.mjs';
import { instructionsFit } from './words_fit.mjs';

// Tests in real time, since a page that plays or holds a button loses the controls after 200 ms of silence. A failure is
// judged only if the machine did not delay a sleeping thread meanwhile.
const PACED = { paced: true };
const FIRST = { first: true }, FIRST_PACED = { ...PACED, ...FIRST };
const TESTS = [
  ['a first drink by mouse', firstDrinkByMouse, FIRST_PACED],
  ['a game beside a console_slow', besideAConsole, PACED],
  ['cost of the game_slow', (t) => costOf(t, 'game', '/'), PACED],
  ['cost of the console_slow', (t) => costOf(t, 'console', '/console'), PACED],
  ['pictures in full quality_slow', takePictures],
  ['mouse moves the hand', checks.mouseMovesTheHand, PACED],
  ['keys fill a glass', checks.keysFillAGlass, PACED],
  ['first session is recorded', recorded.firstSessionIsRecorded],
  ['unrecorded session is reported', recorded.unrecordedSessionIsReported],
  ['keys fill a glass without help_slow', checks.keysFillAGlassAlone, PACED],
  ['touch moves and squeezes', checks.touchMovesAndSqueezes, PACED],
  ['a game pad moves and squeezes', checks.padMovesAndSqueezes, PACED],
  ['emergency stop ends all effort', checks.emergencyStopEndsAllEffort, FIRST_PACED],
  ['reconnects after a restart', checks.reconnects, PACED],
  ['pages are accessible', checks.pagesAreAccessible],
  ['instructions are not cut', instructionsFit, FIRST],
  ['a missing camera is reported', cameras.missingCameraIsReported],
  ['a camera plays_slow', cameras.cameraPlays, PACED],
  ['a lost picture is reported', lostPictureIsReported, PACED],
  ['slow timers keep the controls', presence.slowTimersKeepTheControls, PACED],
  // The server's own tests cover an hour in simulated time; this one uses the browser's time.
  ['a hidden page loses the controls once', (t) => presence.hiddenPageLetsGoOnce(t, FULL ? 600 : 6), PACED],
  ['a page hidden for a moment goes on', presence.shortlyHiddenPageGoesOn, PACED],
  ['a page that draws for seconds goes on', presence.busyPageGoesOn, PACED],
  ['watching lets the program play again', presence.watchingBringsThePlayBack, PACED],
  ['Start waits for the connection', presence.startWaitsForTheConnection, PACED],
  ['an unconfirmed stop is reported', presence.unconfirmedStopIsReported, PACED],
  ['a therapist leads while a patient plays', roles.therapistLeadsWhileAPatientPlays, PACED],
  ['a player rests and goes on', roles.playerRestsAndGoesOn, PACED],
  ['a stopped game gives the controls back', roles.stoppedGameGivesTheControlsBack, PACED],
  ['consoles show the limit that holds', roles.consolesShowTheLimitThatHolds, FIRST],
  ['a half-typed number stays', roles.halfTypedNumberStays],
  ['tokens open their roles', roles.tokensOpenTheirRoles],
  ['levels leak no graphics memory', roles.levelsLeakNoGraphicsMemory],
  ['stop while a level is loaded starts nothing', stops.stopWhileLoadingStartsNothing],
  ['pause after a stop starts nothing', stops.pauseAfterAStopStartsNothing],
  ['nothing starts after stops at random moments', stopsAtRandomMoments],
  ['a reloaded page continues to play', trouble.reloadedPagePlaysOn, PACED],
  ['two players do not fight', trouble.twoPlayersDoNotFight, PACED],
  ['a level is changed while it pours', trouble.levelChangedWhileItPours, PACED],
  ['a drink by screen reader', trouble.screenReaderHearsADrink, PACED],
  ['nothing covers the watched play', trouble.watchedPlayIsUncovered],
  ['the first card fits its window', trouble.firstCardFits],
  ['a window of 320 px can be played', trouble.narrowWindowPlays, PACED],
  ['long and foreign names of profiles', trouble.namesOfAnyKind],
  ['any exercise shows its panel', panels.anyExerciseShowsItsPanel],
  ['kitchen: a drawer is opened and shut', drawerIsOpenedAndShut],
  ['kitchen: a newcomer does the first task', newcomerDoesTheFirstTask, FIRST_PACED],
  ['profiles are kept', panels.profilesAreKept],
  ['a device is commissioned through its page', commissionedThroughThePage, PACED],
  ['a therapist treats a patient', clinic.therapistTreatsAPatient, FIRST_PACED],
  ['names are hidden and typed text is kept', clinic.namesDisappear, PACED],
  ['limits of movement hold from the next visit on', clinic.limitsHold, PACED],
  ['records are killed in a session', clinic.recordsAreKilled, PACED],
  ['a session without records is gentle', clinic.sessionWithoutRecords, PACED],
  ['two consoles on one patient', clinic.twoConsoles, PACED],
  ['replay of a recording', replays.recordingIsReplayed],
  ['replay of two recordings', replays.twoAreReplayed],
  ['replay reports unreadable recordings', replays.badRecordingsAreReported],
  ['replay of a game with bodies', bodiesAreReplayed, PACED],
  ['a recording is listed while it runs', replays.recordingIsListedWhileItRuns],
  ['report is one file', reports.reportIsOneFile],
  ['report has its picture', reports.reportHasItsPicture],
  ['report describes its faults', reports.badReportsAreReported],
  ['charts are one file', chartsAreOneFile],
  // These take minutes with software rendering; every combination plays on the simulated clock in tests/every_drink.test.ts.
  ['a newcomer finds everything by visible words_slow', newcomerFinds, PACED],
  ['drinks by every input method_slow', drinksByEveryWay, PACED],
  ['ten changes of exercise as pixels_slow', tenChangesAsPixels],
  ['a course of three visits in few presses_slow', courseOfThreeVisits],
  // Not paced: the machine is kept busy on purpose.
  ['controls are kept_slow', trouble.controlsAreKept],
  ['an hour of play leaks nothing_slow', hourOfPlayLeaksNothing],
];

const WEB = join(dirname(fileURLToPath(import.meta.url)), '..', '..');
const { values: options, positionals: wanted } = parseArgs({
  options: { program: { type: 'string' }, out: { type: 'string' }, share: { type: 'string', default: '1/1' }, first: { type: 'boolean' }, rest: { type: 'boolean' }, list: { type: 'boolean' } }, allowPositionals: true,
});
const [share, shares] = options.share.split('/').map(Number);
const chosen = TESTS.filter(([name, , how]) => (!options.first || how?.first) && !(options.rest && how?.first) && (FULL || !name.endsWith('_slow')) && (wanted.length === 0 || wanted.some((part) => name.includes(part))));
if (options.list) {
  console.log(chosen.map(([name]) => name).join('; '));
  process.exit(0);
}
const output = resolve(options.out ?? join(WEB, 'test-output', 'browser'));
mkdirSync(output, { recursive: true });
// The program stores recordings in its folder: a temporary one leaves nothing behind.
const folder = mkdtempSync(join(tmpdir(), 'wholehand-browser-'));
process.once('exit', () => rmSync(folder, { recursive: true, force: true }));
for (const signal of ['SIGINT', 'SIGTERM', 'SIGHUP']) process.once(signal, () => process.exit(1));
const harness = new Harness({ file: resolve(options.program ?? join(WEB, '..', 'build', 'release', 'wholehand')), folder, output });
const count = { ok: 0, FAIL: 0, 'not judged': 0 };
const again = [];
const realTime = { judged: 0, not: 0 };
try {
  for (const test of chosen.filter((_, i) => i % shares === share - 1)) {
    const verdict = await harness.run(...test);
    if (test[2]?.paced) realTime[verdict === 'not judged' ? 'not' : 'judged'] += 1;
    if (verdict !== 'ok' && !FULL) again.push([verdict, test]);
    else count[verdict] += 1;
  }
  // Tests that did not pass run once more at the end. What depends on no time fails again, though a stall had hidden it. A
  // failed test that passes now is unsteady, and ./check names it (docs/adr/0072-build-and-check.md).
  for (const [before, test] of again) {
    console.log(`once more: ${test[0]}`);
    const verdict = await harness.run(...test);
    count[verdict] += 1;
    if (before === 'FAIL' && verdict !== 'FAIL') console.log(`unsteady: ${test[0]}`);
  }
} finally {
  await harness.close();
}
// Counted by ./check.
console.log(`real time: ${realTime.judged} judged, ${realTime.not} not judged`);
const unjudged = count['not judged'] > 0 ? `, ${count['not judged']} not judged` : '';
console.log(count.FAIL > 0 ? `FAILED ${count.FAIL} browser tests, passed ${count.ok}${unjudged}` : `passed ${count.ok} browser tests${unjudged}`);
process.exit(count.FAIL === 0 && count.ok + count['not judged'] > 0 ? 0 : 1);
