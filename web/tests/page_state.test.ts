import { expect, test } from 'vitest';
import { Stage } from '../src/exercises/cocktail_bar/bar';
import { RunState, Steering } from '../src/protocol';
import { cueTowards } from '../src/game/cues';
import { openedHand } from '../src/game/takeover';
import { causeOf, faultsOf, pageState, type Situation } from '../src/game/page_state';
import { moment, playOfSunset, sceneOfSunset } from './sunset';

const play = playOfSunset();
const playing: Situation = { status: 'open', problem: null, everOpen: true, attempts: 0, wish: 'play', loading: false, resting: 'no', framing: false, unseen: 'no', loss: '', held: { heldByYou: true, held: true } };

test.each([
  [Stage.Reach, 'reach'], [Stage.Squeeze, 'squeeze'], [Stage.Pour, 'hold'], [Stage.Breathe, 'ease'], [Stage.LetGo, 'letgo'], [Stage.DrinkDone, 'success'],
  [Stage.LevelDone, 'success'], [Stage.DrawBack, 'drawback'],
] as const)('PageState_WhilePlayingInStage%i_Is%s', (stage, expected) => {
  expect(pageState(playing, play, moment({ stage }))).toBe(expected);
});

test('PageState_WithSeveralConditions_IsTheMostSevere', () => {
  const state = moment({ stage: Stage.Pour });
  const problem = { theirs: 2, ours: 1 };
  expect(pageState({ ...playing, problem, status: 'lost' }, play, state)).toBe('version');
  expect(pageState({ ...playing, everOpen: false, attempts: 2, status: 'lost' }, null, null)).toBe('absent');
  expect(pageState({ ...playing, status: 'lost' }, play, moment({}, { runState: RunState.Stopped }))).toBe('lost');
  for (const runState of [RunState.Stopping, RunState.Stopped, RunState.Faulted])
    expect(pageState({ ...playing, wish: 'undecided' }, play, moment({}, { runState }))).toBe('stopped');
  // A level that this page loads stops the run for a moment, which is not shown as a stop.
  expect(pageState({ ...playing, loading: true }, play, moment({}, { runState: RunState.Stopping }))).toBe('loading');
  expect(pageState({ ...playing, wish: 'undecided' }, play, state)).toBe('welcome');
  expect(pageState({ ...playing, resting: 'between' }, play, state)).toBe('rest');
  expect(pageState(playing, null, state)).toBe('free');
  expect(pageState({ ...playing, framing: true }, play, state)).toBe('framing');
  expect(pageState({ ...playing, framing: true }, play, moment({}, { runState: RunState.Stopped }))).toBe('stopped');
  expect(pageState({ ...playing, unseen: 'lost' }, play, state)).toBe('unseen');
  expect(pageState({ ...playing, unseen: 'lost', wish: 'watch' }, play, state)).toBe('watching');
});

test('PageState_AfterTheControlsWereLost_ShowsTheLossUntilTheyAreTakenAgain', () => {
  const lost: Situation = { ...playing, loss: 'left', held: { heldByYou: false, held: false } };
  const state = moment({ stage: Stage.Pour });
  expect(pageState(lost, play, state)).toBe('left');
  expect(pageState({ ...lost, resting: 'between' }, play, state)).toBe('left');
  expect(pageState({ ...lost, loading: true }, play, state)).toBe('loading');
  expect(pageState({ ...lost, wish: 'watch' }, play, state)).toBe('watching');
  expect(pageState(lost, play, moment({}, { runState: RunState.Stopped }))).toBe('stopped');
});

test('PageState_WithoutTheControlsOrWhileTheProgramSteers_IsWatching', () => {
  const state = moment({ stage: Stage.Pour });
  expect(pageState({ ...playing, held: { heldByYou: false, held: true } }, play, state)).toBe('watching');
  expect(pageState(playing, play, moment({}, { steering: Steering.VirtualPatient }))).toBe('watching');
  expect(pageState({ ...playing, wish: 'watch' }, play, state)).toBe('watching');
  // On a real device the person's hand steers, whatever the program reports on virtual patients.
  expect(pageState(playing, play, moment({ stage: Stage.Pour }, { steering: Steering.VirtualPatient, intention: [] }))).toBe('hold');
});

test('Cause_OfAFault_IsTheFaultAndNotTheStop', () => {
  expect(faultsOf(sceneOfSunset().faultNames, 0b110)).toEqual(['device write failed', 'stop requested']);
  expect(causeOf(sceneOfSunset(), moment({}, { runState: RunState.Faulted, latchedFaults: 0b101 }))).toBe('the device gave no position');
  expect(causeOf(sceneOfSunset(), moment({}, { runState: RunState.Stopped, latchedFaults: 0b100 }))).toBe('');
});

test('Cue_PointsFromTheHandToTheTarget_AndIsHiddenAtTheTarget', () => {
  const target = { x_px: 600, y_px: 300 };
  // The hand is to the right of the target (y points left): the chevrons are to the right of it and point left.
  expect(cueTowards(-0.1, 0.064, true, target, 1)).toEqual({ at: { x_px: 666, y_px: 300 }, left: true });
  expect(cueTowards(0.1, -0.064, true, target, 2)).toEqual({ at: { x_px: 468, y_px: 300 }, left: false });
  expect(cueTowards(0.023, 0.064, true, target, 1)).toBeNull();
  // A left hand has the mirror image.
  expect(cueTowards(0.1, -0.064, false, target, 1)).toEqual({ at: { x_px: 534, y_px: 300 }, left: false });
  expect(cueTowards(-0.023, -0.064, false, target, 1)).toBeNull();
});

test('TakeOver_OfAClosedHand_OpensItInPlace', () => {
  const axes = ['x', 'y', 'z', 'finger_flexion', 'thumb_circumduction', 'thumb_flexion'].map((name) => ({ name }));
  const [x, y, z, fingers, , thumb] = openedHand(axes, [0.07, -0.04, 0.01, 2.2, 0.36, 0.3]);
  expect([x, y, z]).toEqual([0.07, -0.04, 0.01]);
  // Open: 65 degrees of the fingers and none of the thumb, which touches no target in front of the hand.
  expect(fingers).toBeCloseTo(65 * Math.PI / 180, 12);
  expect(thumb).toBe(0);
});

test('PageState_AfterARestOfThisPage_IsRestUntilAnotherStop', () => {
  const off: Situation = { ...playing, resting: 'off' };
  const at = (runState: RunState, rested: boolean): string => pageState(off, play, moment({}, { runState, rested }));
  expect(at(RunState.Rendering, false), 'at once, before the program has answered').toBe('rest');
  expect(at(RunState.Stopping, true)).toBe('rest');
  expect(at(RunState.Stopped, true)).toBe('rest');
  expect(at(RunState.Stopped, false), 'somebody stopped it').toBe('stopped');
  expect(at(RunState.Faulted, true)).toBe('stopped');
});
