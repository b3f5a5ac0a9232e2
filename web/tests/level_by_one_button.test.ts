// All bands of squeezing to a level with full help, by one button, on the simulated clock: a person who presses when the
// screen asks for a grip, and does nothing else.
import { expect, it } from 'vitest';
import { targetsOf } from '../src/exercises';
import { Instruction } from '../src/exercises/squeeze_to_level/grip';
import { AimModel } from '../src/input/aim_model';
import { Perceiver } from '../src/input/perceiver';
import { restingWish } from '../src/input/wish';
import { ShapeType } from '../src/protocol';
import { LOOK_S, SteeredHand } from './steered_hand';

/** Time limit for three bands, each reached, held for 2 s and left: as long as three steps of drinks with full help. */
const ALL_S = 90;

it.each(['right', 'left'])('three presses hold all bands, %s hand', async (side) => {
  const hand = await SteeredHand.start(1, 'squeeze-to-level', `adult-median-${side}`);
  try {
    // config/scenes/squeeze-to-level.toml: the grip is the fixed cylinder.
    for (const body of hand.scene.bodies) Object.assign(body, { fixed: true, shapes: [{ type: body.name === 'grip' ? ShapeType.Cylinder : ShapeType.Box, radiusM: 0.025, lengthM: 0.2 }] });
    const seen = new Perceiver(hand.scene, targetsOf(hand.scene)), model = new AimModel(hand.axes, { help: 'full' });
    model.begin(hand.now.q_m);
    let t = 0, presses = 0, asked_s = 0, most_n = 0;
    for (; t < ALL_S && hand.value('done') !== 1; t += LOOK_S) {
      asked_s = hand.value('instruction') === Instruction.Reach && !model.onItsWay && model.squeeze === 0 ? asked_s + LOOK_S : 0;
      const down = asked_s > 1 && asked_s < 1.2;
      if (down && asked_s < 1 + 1.5 * LOOK_S) presses += 1;
      await hand.aim([...model.step({ ...restingWish(), squeeze: down }, seen.onState(hand.state), LOOK_S)], t === 0);
      expect(hand.now.faults, 'faults that stopped the loop').toBe(0);
      if (hand.value('bands_done') === 0) most_n = Math.max(most_n, hand.value('squeeze_n'));
    }
    console.log(`figure: squeeze to a level by one button, ${side}: ${t.toFixed(1)} s, ${presses} presses, score ${hand.value('score').toFixed(0)}, at most ${most_n.toFixed(2)} N in the first band`);
    expect(hand.value('bands_done')).toBe(3);
    expect(presses).toBe(3);
    expect(hand.value('score')).toBeGreaterThan(70);   // two stars of three, play.ts
  } finally {
    hand.stop();
  }
}, 600_000);
