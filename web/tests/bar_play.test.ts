// The game's texts for the bar, each at one moment.
import { expect, test } from 'vitest';
import { barOf, Stage } from '../src/exercises/cocktail_bar/bar';
import { BarPlay, filledPercent } from '../src/exercises/cocktail_bar/play';
import { ExerciseValues } from '../src/exercises/values';
import { SceneT } from '../src/protocol';
import { moment, playOfSunset, sceneOfSunset } from './sunset';

test('Bar_OfAnotherExerciseOrInvalidJson_IsUndefined', () => {
  const scene = new SceneT();
  for (const json of ['', '{', '{"kind":"free_grasping"}', 'null', '{"kind":"cocktail_bar"}']) {
    scene.exerciseJson = json;
    expect(barOf(scene), json).toBeUndefined();
  }
});

test('ExerciseValues_UnknownOrNonFiniteValue_ReturnsDefault', () => {
  const values = new ExerciseValues(sceneOfSunset().valueNames);
  expect(values.get(moment({}), 'no_such_value', 7)).toBe(7);
  expect(new ExerciseValues(['layer_l/1', 'stage']).get({ values: [0.02, 3] }, 'stage')).toBe(3);
  expect(values.get(moment({ flow_l_s: NaN }), 'flow_l_s', 3)).toBe(3);
});

test.each([[0, 'none'], [3.9, 'soft'], [4, 'right'], [8, 'right'], [8.1, 'strong']] as const)('SqueezeMeter_At%fN_IsInZone_%s', (squeeze_n, zone) => {
  const meter = playOfSunset().meter(moment({ stage: Stage.Squeeze, squeeze_n }));
  expect(meter.zone).toBe(zone);
  // Position of the mark: force divided by the meter's range of 20 N.
  expect(meter.value).toBeCloseTo(squeeze_n / 20, 12);
  expect([meter.low, meter.high, meter.shown]).toEqual([0.2, 0.4, true]);
});

test('SqueezeMeter_BeyondItsRange_StaysAtTheEnd', () => {
  expect(playOfSunset().meter(moment({ stage: Stage.Pour, squeeze_n: 55 })).value).toBe(1);
});

test('RecipeCard_InTheSecondStep_HasOneDoneAndOneCurrentRow', () => {
  const recipe = playOfSunset().card(moment({ stage: Stage.Pour, poured_l: 0.0124 }))!;
  expect([recipe.title, recipe.count]).toEqual(['Sunset', 'Drink 2 of 2']);
  expect(recipe.steps).toMatchObject([
    { name: 'Lemon', askedWords: '30 ml', done: 30, is: 'done' },
    { name: 'Cherry', askedWords: '20 ml', doneWords: '12 of 20 ml', done: 12, is: 'now' },
  ]);
});

test('RecipeCard_OfADoneDrink_HasOnlyDoneRows', () => {
  const recipe = playOfSunset().card(moment({ stage: Stage.DrinkDone, 'layer_l/1': 0.021 }))!;
  expect(recipe.steps.map((step) => [step.is, step.done])).toEqual([['done', 30], ['done', 21]]);
});

test('Prompt_InEachStage_NamesOneAction', () => {
  const titleAt = (values: Record<string, number>) => playOfSunset().prompt(moment(values), false).title;
  expect(titleAt({ stage: Stage.Reach })).toBe('Reach for the cherry');
  expect(titleAt({ stage: Stage.Squeeze })).toBe('Squeeze gently');
  expect(titleAt({ stage: Stage.Pour, flow_l_s: 0.004, over_glass: 0 })).toBe('Not over the glass');
  expect(titleAt({ stage: Stage.Breathe })).toBe('Let go a little');
  expect(titleAt({ stage: Stage.LetGo })).toBe('Let go');
  expect(titleAt({ stage: Stage.DrawBack })).toBe('Draw your hand back');
});

test('Prompt_AtTheWrongBottle_WarnsOnlyWhileItIsSqueezed', () => {
  const wrong = { stage: Stage.Reach, engaged_dispenser: 0 };
  const promptAt = (squeeze_n: number) => {
    const state = moment({ ...wrong, squeeze_n });
    return playOfSunset(state).prompt(state, false);
  };
  expect(promptAt(0.5).title).toBe('Reach for the cherry');
  expect(promptAt(3)).toMatchObject({ title: 'That is the lemon', urgent: true });
});

test('GoalText_WhileFilling_ShowsWholeMillilitres', () => {
  expect(playOfSunset().goal(moment({ stage: Stage.Pour, poured_l: 0.01249 }))?.amount).toBe('12 of 20 ml');
  expect(playOfSunset().goal(moment({ stage: Stage.Reach }))).toBeNull();
});

/** Two seconds of states at 60 Hz of a bottle that loses `flow_l_s`, or takes in as much air. */
function poured(flow_l_s: number, long_s: number, pressed_l: (t_s: number) => number = () => 0): ReturnType<typeof moment>[] {
  return Array.from({ length: Math.round(60 * long_s) + 1 }, (_, i) => moment({ stage: Stage.Pour, flow_l_s, pressed_l: pressed_l(i / 60), poured_l: 0.006 }, { sentMonotonicNs: BigInt(Math.round(1e9 * (i / 60))) }));
}

test('GoalText_WhilePouring_ShowsFlowInWholeMillilitresPerSecond', () => {
  const promptAt = (...states: ReturnType<typeof moment>[]) => playOfSunset(...states).goal(states.at(-1)!);
  expect(promptAt(...poured(0.0052, 2))).toEqual({ amount: '6 of 20 ml', more: '5 ml/s' });
  expect(promptAt(...poured(0.0052, 2), ...poured(0, 2).map((state) => Object.assign(state, { sentMonotonicNs: state.sentMonotonicNs + 3_000_000_000n })))?.more).toBe('Fill to here');
  // A single outlier state does not change the shown flow: 9 instead of 5 ml/s for 17 ms.
  expect(promptAt(...poured(0.0052, 2), moment({ stage: Stage.Pour, flow_l_s: 0.009 }, { sentMonotonicNs: 2_016_000_000n }))?.more).toBe('5 ml/s');
});

test('Flow_WhileTheShellReturns_ReportsAir', () => {
  const air = (rate_l_s: number) => { const states = poured(0, 0.5, (t_s) => 0.01 + rate_l_s * t_s); return playOfSunset(...states).flow(states.at(-1)!).air; };
  expect(air(-0.01)).toBeCloseTo(0.5, 6);   // 10 of 20 ml/s
  expect(air(0.01)).toBe(0);
});

test('SqueezeMeter_OfASpentBottle_ShowsEnough', () => {
  expect(playOfSunset().meter(moment({ stage: Stage.Breathe, squeeze_n: 6 }))).toMatchObject({ shown: true, zone: 'stop' });
  expect(playOfSunset().todo(moment({ stage: Stage.Breathe }))).toBe('ease 1 1');   // hints are shown
});

test('FilledPercent_IsOneMinusTheMissedShare', () => {
  const sunset = barOf(sceneOfSunset())!.drinks[1];
  expect(filledPercent(sunset, [0.03, 0.02])).toBe(100);
  // 1 ml too much and 2 ml too little of 50 ml: 1 - 3/50.
  expect(filledPercent(sunset, [0.031, 0.018])).toBe(94);
  expect(filledPercent(sunset, [])).toBe(0);
});

test('Praise_CountsOnlyLiquidSpiltInThisDrink', () => {
  const begun = moment({ step: 0, spilt_l: 0.005, 'layer_l/0': 0 });
  const praise = playOfSunset(begun).praise(moment({ stage: Stage.DrinkDone, drinks: 3, 'layer_l/1': 0.02, spilt_l: 0.0071, stars: 3, drink_time_s: 71.6 }), true)!;
  expect(praise).toMatchObject({ lead: 'Your Sunset is ready.', stars: 3, levelDone: false });
  expect(praise.figures.map(({ shown }) => shown)).toEqual(['99 %', '2 ml', '1:12']);
});

test('Praise_OfTheLastDrink_IsForTheLevel', () => {
  expect(playOfSunset().praise(moment({ stage: Stage.DrinkDone, drink: 1, drinks: 2 }), true)!.levelDone).toBe(true);
  expect(playOfSunset().praise(moment({ stage: Stage.DrinkDone, drink: 0, drinks: 2 }), true)!.levelDone).toBe(false);
});

test('SqueezeMeter_PastTheLine_ShowsStop_AndIsGreyAtAWrongBottle', () => {
  const squeezed = { squeeze_n: 25, squeeze_low_n: 20, squeeze_high_n: 30, squeeze_full_n: 50, target_dispenser: 0, engaged_dispenser: 0, poured_l: 0.01, asked_l: 0.04 };
  const zone = (values: Record<string, number>): string => playOfSunset().meter(moment({ ...squeezed, ...values })).zone;
  expect(zone({ stage: Stage.Pour })).toBe('right');
  expect(zone({ stage: Stage.Pour, poured_l: 0.041 })).toBe('stop');
  expect(zone({ stage: Stage.LetGo })).toBe('stop');
  expect(zone({ stage: Stage.LetGo, squeeze_n: 0 })).toBe('none');
  expect(zone({ stage: Stage.Reach, engaged_dispenser: 1 })).toBe('wrong');
});

test('Prompt_AfterAWrongBottleWasSqueezed_WarnsUntilItIsLeft_ButNotWhenPassingBy', () => {
  const at = (engaged_dispenser: number, squeeze_n: number) => moment({ stage: Stage.Reach, target_dispenser: 0, engaged_dispenser, squeeze_n, squeeze_low_n: 20 });
  const promptAt = (...states: ReturnType<typeof at>[]) => playOfSunset(...states).prompt(states.at(-1)!, false).title;
  expect(promptAt(at(1, 0))).toBe('Reach for the lemon');
  expect(promptAt(at(1, 10))).toBe('That is the cherry');
  expect(promptAt(at(1, 10), at(1, 0))).toBe('That is the cherry');
  expect(promptAt(at(1, 10), at(-1, 0))).toBe('Reach for the lemon');
  expect(promptAt(at(1, 10), at(0, 30))).toBe('Reach for the lemon');
});

test('Praise_AfterANewSceneOfTheSameBar_IsUnchanged', () => {
  const begun = moment({ step: 0, spilt_l: 0.005 });
  const before = playOfSunset(begun), scene = sceneOfSunset(), done = moment({ stage: Stage.DrinkDone, spilt_l: 0.007 });
  const after = new BarPlay(barOf(scene)!, scene, before);
  expect(after.follow(done), 'a part that begins').toBe(false);
  expect(after.praise(done, true)).toEqual(before.praise(done, true));
});
