import { expect, test } from 'vitest';
import { RunState, SceneT, Steering, WorldStateT } from '../src/protocol';
import { cueTowards } from '../src/game/cues';
import { openedHand } from '../src/game/takeover';
import { faultsOf, figure, readScript, type Script } from '../src/game/script';
import {
  callOutOf, causeOf, clock, filledPercent, instructionOf, meterOf, pageState, praiseOf, recipeOf, Stage, wrongBottle, type Situation,
} from '../src/game/view';

const NAMES = ['stage', 'drink', 'drinks', 'step', 'steps', 'target_dispenser', 'engaged_dispenser', 'squeeze_n', 'squeeze_low_n', 'squeeze_high_n',
  'squeeze_full_n', 'flow_l_s', 'over_glass', 'poured_l', 'asked_l', 'glass_l', 'spilt_l', 'stars', 'drink_time_s', 'layer_l/0', 'layer_l/1', 'layer_l/2'];

function scriptOfSunset(): Script {
  const scene = new SceneT();
  scene.exerciseJson = JSON.stringify({
    kind: 'cocktail_bar', dispensers: [{ body: 'dispenser_lemon', liquid: 'lemon' }, { body: 'dispenser_cherry', liquid: 'cherry' }],
    drinks: [{ name: 'lemonade', steps: [{ liquid: 'lemon', amount_l: 0.04, tolerance_l: 0.005 }] },
      { name: 'sunset', steps: [{ liquid: 'lemon', amount_l: 0.03, tolerance_l: 0.003 }, { liquid: 'cherry', amount_l: 0.02, tolerance_l: 0.003 }] }],
  });
  scene.valueNames = NAMES;
  scene.faultNames = ['device read failed', 'device write failed', 'stop requested'];
  return readScript(scene)!;
}

function moment(values: Record<string, number>, more: Partial<WorldStateT> = {}): WorldStateT {
  const state = new WorldStateT();
  const usual: Record<string, number> = { drink: 1, drinks: 2, step: 1, steps: 2, target_dispenser: 1, engaged_dispenser: -1, squeeze_low_n: 4, squeeze_high_n: 8, squeeze_full_n: 20, over_glass: 1, 'layer_l/0': 0.0304, asked_l: 0.02 };
  state.values = NAMES.map((name) => values[name] ?? usual[name] ?? 0);
  state.runState = RunState.Rendering;
  state.steering = Steering.Person;
  state.qM = state.intention = [0, 0, 0];
  return Object.assign(state, more);
}

const script = scriptOfSunset();
const playing: Situation = { status: 'open', problem: null, everOpen: true, attempts: 0, wish: 'play', loading: false, resting: 'no', framing: false, unseen: 'no', loss: '', held: { heldByYou: true, held: true } };

test('Script_OfAnotherExerciseOrBrokenText_IsNone', () => {
  const scene = new SceneT();
  for (const json of ['', '{', '{"kind":"free_grasping"}', 'null', '{"kind":"cocktail_bar"}']) {
    scene.exerciseJson = json;
    expect(readScript(scene), json).toBeNull();
  }
});

test('Figure_OfAnUnknownOrNotFiniteValue_IsWhatTheCallerSays', () => {
  expect(figure(script, moment({}), 'no_such_value', 7)).toBe(7);
  expect(figure(script, moment({ flow_l_s: NaN }), 'flow_l_s', 3)).toBe(3);
});

test.each([
  [Stage.Reach, 'reach'], [Stage.Squeeze, 'squeeze'], [Stage.Pour, 'pour'], [Stage.LetGo, 'letgo'], [Stage.DrinkDone, 'success'],
  [Stage.LevelDone, 'success'], [Stage.DrawBack, 'drawback'],
] as const)('PageState_WhilePlayingInStage%i_Is%s', (stage, expected) => {
  expect(pageState(playing, script, moment({ stage }))).toBe(expected);
});

test('PageState_TheMostSeriousComesFirst', () => {
  const state = moment({ stage: Stage.Pour });
  const problem = { theirs: 2, ours: 1 };
  expect(pageState({ ...playing, problem, status: 'lost' }, script, state)).toBe('version');
  expect(pageState({ ...playing, everOpen: false, attempts: 2, status: 'lost' }, null, null)).toBe('absent');
  expect(pageState({ ...playing, status: 'lost' }, script, moment({}, { runState: RunState.Stopped }))).toBe('lost');
  for (const runState of [RunState.Stopping, RunState.Stopped, RunState.Faulted])
    expect(pageState({ ...playing, wish: 'undecided' }, script, moment({}, { runState }))).toBe('stopped');
  // A level that we load stops the run for a moment: that is no stop to speak of.
  expect(pageState({ ...playing, loading: true }, script, moment({}, { runState: RunState.Stopping }))).toBe('loading');
  expect(pageState({ ...playing, wish: 'undecided' }, script, state)).toBe('welcome');
  expect(pageState({ ...playing, resting: 'between' }, script, state)).toBe('rest');
  expect(pageState(playing, null, state)).toBe('free');
  expect(pageState({ ...playing, framing: true }, script, state)).toBe('framing');
  expect(pageState({ ...playing, framing: true }, script, moment({}, { runState: RunState.Stopped }))).toBe('stopped');
  expect(pageState({ ...playing, unseen: 'lost' }, script, state)).toBe('unseen');
  expect(pageState({ ...playing, unseen: 'lost', wish: 'watch' }, script, state)).toBe('watching');
});

test('PageState_WhenThePageLostTheControls_SaysSoUntilTheyAreTakenAnew', () => {
  const lost: Situation = { ...playing, loss: 'left', held: { heldByYou: false, held: false } };
  const state = moment({ stage: Stage.Pour });
  expect(pageState(lost, script, state)).toBe('left');
  expect(pageState({ ...lost, resting: 'between' }, script, state)).toBe('left');
  expect(pageState({ ...lost, loading: true }, script, state)).toBe('loading');
  expect(pageState({ ...lost, wish: 'watch' }, script, state)).toBe('watching');
  expect(pageState(lost, script, moment({}, { runState: RunState.Stopped }))).toBe('stopped');
});

test('PageState_WithoutTheControlsOrWhileTheProgramSteers_IsWatching', () => {
  const state = moment({ stage: Stage.Pour });
  expect(pageState({ ...playing, held: { heldByYou: false, held: true } }, script, state)).toBe('watching');
  expect(pageState(playing, script, moment({}, { steering: Steering.VirtualPatient }))).toBe('watching');
  expect(pageState({ ...playing, wish: 'watch' }, script, state)).toBe('watching');
  // On a real device it is the person's hand that steers, whatever the program says of virtual patients.
  expect(pageState(playing, script, moment({ stage: Stage.Pour }, { steering: Steering.VirtualPatient, intention: [] }))).toBe('pour');
});

test.each([[0, 'none'], [3.9, 'soft'], [4, 'right'], [8, 'right'], [8.1, 'strong']] as const)('Meter_At%fN_SaysWord_%s', (squeeze_n, zone) => {
  const meter = meterOf(script, moment({ stage: Stage.Squeeze, squeeze_n }));
  expect(meter.zone).toBe(zone);
  // The mark's place: newtons over the end of the meter, 20 N.
  expect(meter.value).toBeCloseTo(squeeze_n / 20, 12);
  expect([meter.low, meter.high, meter.shown]).toEqual([0.2, 0.4, true]);
});

test('Meter_BeyondItsEnd_StaysAtTheEnd', () => {
  expect(meterOf(script, moment({ stage: Stage.Pour, squeeze_n: 55 })).value).toBe(1);
});

test('Recipe_InTheSecondStep_HasOneDoneAndOneNow', () => {
  const recipe = recipeOf(script, moment({ stage: Stage.Pour, poured_l: 0.0124 }))!;
  expect([recipe.name, recipe.drink, recipe.drinks]).toEqual(['sunset', 2, 2]);
  expect(recipe.rows).toEqual([
    { liquid: 'lemon', asked_ml: 30, got_ml: 30, is: 'done' },
    { liquid: 'cherry', asked_ml: 20, got_ml: 12, is: 'now' },
  ]);
});

test('Recipe_OfADoneDrink_HasEveryRowDone', () => {
  const recipe = recipeOf(script, moment({ stage: Stage.DrinkDone, 'layer_l/1': 0.021 }))!;
  expect(recipe.rows.map((row) => [row.is, row.got_ml])).toEqual([['done', 30], ['done', 21]]);
});

test('Instruction_NamesOneThingToDo', () => {
  const say = (values: Record<string, number>) => { const { title, liquid } = instructionOf(script, moment(values)); return [title, liquid]; };
  expect(say({ stage: Stage.Reach })).toEqual(['game.reach', 'cherry']);
  expect(say({ stage: Stage.Squeeze })).toEqual(['game.squeeze', 'cherry']);
  expect(say({ stage: Stage.Pour, flow_l_s: 0.004, over_glass: 0 })[0]).toBe('game.offGlass');
  expect(say({ stage: Stage.LetGo })[0]).toBe('game.letGo');
  expect(say({ stage: Stage.DrawBack })[0]).toBe('game.drawBack');
});

test('Instruction_ForTheWrongBottle_SpeaksOnlyWhenItIsSqueezed', () => {
  const wrong = { stage: Stage.Reach, engaged_dispenser: 0 };
  expect(instructionOf(script, moment({ ...wrong, squeeze_n: 0.5 })).title).toBe('game.reach');
  expect(instructionOf(script, moment({ ...wrong, squeeze_n: 3 }))).toMatchObject({ title: 'game.wrong', liquid: 'lemon' });
});

test('CallOut_InWholeMillilitres_WhileThereIsSomethingToFill', () => {
  expect(callOutOf(script, moment({ stage: Stage.Pour, poured_l: 0.01249 }))).toEqual({ shown: true, got_ml: 12, asked_ml: 20 });
  expect(callOutOf(script, moment({ stage: Stage.Reach })).shown).toBe(false);
});

test('FilledPercent_IsOneMinusTheMissedPart', () => {
  const { steps } = script.drinks[1];
  expect(filledPercent(script.drinks[1], [0.03, 0.02])).toBe(100);
  // 1 ml too much and 2 ml too little of 50 ml: 1 - 3/50.
  expect(filledPercent(script.drinks[1], [0.031, 0.018])).toBe(94);
  expect(filledPercent({ name: '', steps }, [])).toBe(0);
});

test('Praise_CountsOnlyWhatWasSpiltInThisDrink', () => {
  const praise = praiseOf(script, moment({ stage: Stage.DrinkDone, drinks: 3, 'layer_l/1': 0.02, spilt_l: 0.0071, stars: 3, drink_time_s: 71.6 }), 0.005)!;
  expect(praise).toMatchObject({ drink: 'sunset', stars: 3, spilt_ml: 2, levelDone: false, filled_percent: 99 });
  expect(clock(praise.time_s)).toBe('1:12');
});

test('Cause_OfAFault_IsTheFaultAndNotTheStop', () => {
  expect(faultsOf(script.faultNames, 0b110)).toEqual(['device write failed', 'stop requested']);
  expect(causeOf(script, moment({}, { runState: RunState.Faulted, latchedFaults: 0b101 }))).toBe('the device gave no position');
  expect(causeOf(script, moment({}, { runState: RunState.Stopped, latchedFaults: 0b100 }))).toBe('');
});

test('Praise_OfTheLastDrink_IsThatOfTheLevel', () => {
  expect(praiseOf(script, moment({ stage: Stage.DrinkDone, drink: 1, drinks: 2 }), 0)!.levelDone).toBe(true);
  expect(praiseOf(script, moment({ stage: Stage.DrinkDone, drink: 0, drinks: 2 }), 0)!.levelDone).toBe(false);
});

test('Cue_PointsFromTheHandToTheBottle_AndNotWhenTheHandIsThere', () => {
  const target = { x_px: 600, y_px: 300 };
  // The hand is to the right of the bottle (y points left): the chevrons stand right of it and point left.
  expect(cueTowards(-0.1, 0.064, true, target, 1)).toEqual({ at: { x_px: 666, y_px: 300 }, left: true });
  expect(cueTowards(0.1, -0.064, true, target, 2)).toEqual({ at: { x_px: 468, y_px: 300 }, left: false });
  expect(cueTowards(0.023, 0.064, true, target, 1)).toBeNull();
  // A left hand is the mirror image.
  expect(cueTowards(0.1, -0.064, false, target, 1)).toEqual({ at: { x_px: 534, y_px: 300 }, left: false });
  expect(cueTowards(-0.023, -0.064, false, target, 1)).toBeNull();
});

test('TakeOver_OfAClosedHand_OpensItWhereItIs', () => {
  const axes = ['x', 'y', 'z', 'finger_flexion', 'thumb_circumduction', 'thumb_flexion'].map((name) => ({ name }));
  const [x, y, z, fingers, , thumb] = openedHand(axes, [0.07, -0.04, 0.01, 2.2, 0.36, 0.3]);
  expect([x, y, z]).toEqual([0.07, -0.04, 0.01]);
  // Open is 65 degrees of the fingers and none of the thumb: in front of a bottle without touching it.
  expect(fingers).toBeCloseTo(65 * Math.PI / 180, 12);
  expect(thumb).toBe(0);
});

test('the meter says stop past the line, and is grey at a bottle that is not asked for', () => {
  const squeezed = { squeeze_n: 25, squeeze_low_n: 20, squeeze_high_n: 30, squeeze_full_n: 50, target_dispenser: 0, engaged_dispenser: 0, poured_l: 0.01, asked_l: 0.04 };
  const zone = (values: Record<string, number>): string => meterOf(script, moment({ ...squeezed, ...values })).zone;
  expect(zone({ stage: Stage.Pour })).toBe('right');
  expect(zone({ stage: Stage.Pour, poured_l: 0.041 })).toBe('stop');
  expect(zone({ stage: Stage.LetGo })).toBe('stop');
  expect(zone({ stage: Stage.LetGo, squeeze_n: 0 })).toBe('none');
  expect(zone({ stage: Stage.Reach, engaged_dispenser: 1 })).toBe('wrong');
});

test('a wrong bottle that was squeezed is said until it is left; one that is passed by never', () => {
  const at = (engaged_dispenser: number, squeeze_n: number, before: number): number =>
    wrongBottle(script, moment({ stage: Stage.Reach, target_dispenser: 0, engaged_dispenser, squeeze_n, squeeze_low_n: 20 }), before);
  expect(at(1, 0, -1)).toBe(-1);
  expect(at(1, 10, -1)).toBe(1);
  expect(at(1, 0, 1)).toBe(1);
  expect(at(-1, 0, 1)).toBe(-1);
  expect(at(0, 30, 1)).toBe(-1);
});

test('PageState_OfARestThatThisPageAskedFor_IsRestUntilAnythingElseEnds', () => {
  const off: Situation = { ...playing, resting: 'off' };
  const at = (runState: RunState, rested: boolean): string => pageState(off, script, moment({}, { runState, rested }));
  expect(at(RunState.Rendering, false), 'at once, before the program has answered').toBe('rest');
  expect(at(RunState.Stopping, true)).toBe('rest');
  expect(at(RunState.Stopped, true)).toBe('rest');
  expect(at(RunState.Stopped, false), 'somebody stopped it').toBe('stopped');
  expect(at(RunState.Faulted, true)).toBe('stopped');
});
