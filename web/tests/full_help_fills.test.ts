// Full help fills every drink to its line by one press for each bottle, on the simulated clock: at fast and at slow pages,
// and with a press on another bottle first.
import { afterEach, expect, it } from 'vitest';
import { barOf, Stage } from '../src/exercises/cocktail_bar/bar';
import { AimModel } from '../src/input/aim_model';
import { restingWish } from '../src/input/wish';
import { LOOK_S, SteeredHand } from './steered_hand';

const FULL = process.env.WHOLEHAND_FULL === '1';
const DRINK_S = 90;
/** A press comes this long after a bottle was asked for, and is this long [s]. */
const PRESS_FROM_S = 0.6, PRESS_TO_S = 0.75;

const open: SteeredHand[] = [];
afterEach(() => { for (const hand of open.splice(0)) hand.stop(); });

/** Millilitres of each step that a drink is off. @param every looks of the clock between two frames of the page */
async function drink(level: number, every: number): Promise<{ off_ml: number[]; tolerance_ml: number[]; spilt_ml: number; took_s: number }> {
  const hand = await SteeredHand.start(level);
  open.push(hand);
  const bar = barOf(hand.scene)!, model = new AimModel(hand.axes, { help: 'full' });
  model.begin(hand.now.q_m);
  let t = 0, asked_s = 0, aim = [...model.aim];
  for (let look = 0; t < DRINK_S && ![Stage.DrinkDone, Stage.LevelDone].includes(hand.value('stage') as never); look += 1, t += LOOK_S) {
    asked_s = hand.value('stage') === Stage.Reach ? asked_s + LOOK_S : 0;
    if (look % every === 0) aim = [...model.advance({ ...restingWish(), squeeze: asked_s > PRESS_FROM_S && asked_s < PRESS_TO_S + every * LOOK_S }, hand.perceiver.onState(hand.state), every * LOOK_S)];
    await hand.aim(aim);
  }
  const { steps } = bar.drinks[0]!;
  return {
    off_ml: steps.map(({ amount_l }, i) => 1000 * (hand.value(`layer_l/${i}`) - amount_l)), tolerance_ml: steps.map(({ tolerance_l }) => 1000 * tolerance_l),
    spilt_ml: 1000 * hand.value('spilt_l'), took_s: t,
  };
}

const CASES = (FULL ? [1, 2, 3, 4] : [2]).flatMap((level) => (FULL ? [1, 4, 8, 14, 20] : [1, 14]).map((every) => [level, every] as const));

it.each(CASES)('level %i, a frame every %i looks', async (level, every) => {
  const { off_ml, tolerance_ml, spilt_ml, took_s } = await drink(level, every);
  console.log(`figure: full help, level ${level}, ${(1 / (every * LOOK_S)).toFixed(0)} frames/s: off ${off_ml.map((off) => off.toFixed(1)).join(', ')} ml of tolerance ${tolerance_ml.join(', ')}, spilt ${spilt_ml.toFixed(2)} ml, ${took_s.toFixed(0)} s`);
  expect(spilt_ml).toBeCloseTo(0, 3);
  // A slow page sees the line later.
  off_ml.forEach((off, i) => expect(Math.abs(off)).toBeLessThanOrEqual(every > 14 ? tolerance_ml[i]! : 1.2));
}, 300_000);
