// Comparisons of two bottles with full help, by one button, on the simulated clock: a person who presses when the screen
// asks for a squeeze, and answers by pointing at one of the bottles and pressing once.
import { afterEach, expect, it } from 'vitest';
import { targetsOf } from '../src/exercises';
import { Instruction } from '../src/exercises/tell_apart/bottles';
import { AimModel } from '../src/input/aim_model';
import { Perceiver } from '../src/input/perceiver';
import { restingWish } from '../src/input/wish';
import { ShapeType } from '../src/protocol';
import { LOOK_S, SteeredHand } from './steered_hand';

/** Comparisons; a block has fifty, with WHOLEHAND_FULL all of them. */
const ALL = 50, COMPARED = process.env.WHOLEHAND_FULL ? ALL : 4;
/** A block of fifty ends within eight minutes, the rests included (issue of the exercise). */
const BLOCK_S = 480;
/** A person presses this long after the screen asks, and holds the button for so long. */
const ASKED_S = 0.6, HELD_S = 0.2;

const open: SteeredHand[] = [];
afterEach(() => { for (const hand of open.splice(0)) hand.stop(); });

it.each([['firmer', 'right'], ['thicker', 'left'], ['farther', 'right'], ['heavier', 'left'], ['later', 'right']])('which is %s, %s hand: every comparison by two presses, no squeeze is repeated', async (quantity, side) => {
  const hand = await SteeredHand.start(1, `tell-apart-${quantity}`, `adult-median-${side}`);
  open.push(hand);
  // config/scenes/tell-apart.toml: the bottles are its fixed cylinders.
  for (const body of hand.scene.bodies) Object.assign(body, { fixed: true, shapes: [{ type: /bottle/.test(String(body.name)) ? ShapeType.Cylinder : ShapeType.Box }] });
  const seen = new Perceiver(hand.scene, targetsOf(hand.scene)), model = new AimModel(hand.axes, { help: 'full' });
  model.begin(hand.now.q_m);
  let t = 0, presses = 0, asked_s = 0, lowerAgain = 0, before = -1;
  for (; t < BLOCK_S && hand.value('answers') < COMPARED && hand.value('done') !== 1; t += LOOK_S) {
    const now = hand.value('instruction'), answers = now === Instruction.Answer, begins = now === Instruction.First;
    asked_s = (answers || begins) && !model.onItsWay && model.squeeze === 0 || (asked_s > ASKED_S && asked_s < ASKED_S + HELD_S) ? asked_s + LOOK_S : 0;
    const down = asked_s > ASKED_S && asked_s < ASKED_S + HELD_S;
    if (down && asked_s < ASKED_S + 1.5 * LOOK_S) presses += 1;
    // A squeeze that ends before its mark is asked for again.
    if (now === Instruction.First && before === Instruction.LetGo && hand.value('answers') === 0) lowerAgain += 1;
    before = now;
    const pointed = answers ? presses % 2 : undefined;
    await hand.aim([...model.step({ ...restingWish(), squeeze: down, ...(pointed === undefined ? {} : { pointed, place: { y: 0 } }) }, seen.onState(hand.state), LOOK_S)], t === 0);
    expect(hand.now.faults, 'faults that stopped the loop').toBe(0);
  }
  console.log(`figure: ${hand.value('answers')} comparisons of ${quantity} by one button, ${side}: ${t.toFixed(1)} s, ${presses} presses`);
  expect(hand.value('answers')).toBe(COMPARED);
  expect(lowerAgain).toBe(0);
  // A press begins a comparison, and one answers it.
  expect(presses).toBeLessThanOrEqual(2 * COMPARED);
  expect(t * ALL / COMPARED).toBeLessThanOrEqual(BLOCK_S);
}, 1_200_000);
