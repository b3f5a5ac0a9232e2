// The drawer with full help, by one button, on the simulated clock: a person who presses when the screen asks to take hold,
// and does nothing else.
import { expect, it } from 'vitest';
import { targetsOf } from '../src/exercises';
import { taskOf } from '../src/exercises/kitchen/task';
import { AimModel } from '../src/input/aim_model';
import { Perceiver } from '../src/input/perceiver';
import { restingWish } from '../src/input/wish';
import { ShapeType } from '../src/protocol';
import { LOOK_S, SteeredHand } from './steered_hand';

/** Issue 41: a newcomer with a mouse does the first task within a minute. */
const WITHIN_S = 60;
/** From the drawer's centre of mass to its bar: config/scenes/assets/drawer.urdf. */
const BAR_M = { x: -0.14, y: 0, z: 0.01 };

it.each(['right', 'left'])('one press opens it, shuts it and lets go, %s hand', async (side) => {
  const hand = await SteeredHand.start(2, 'drawer', `adult-median-${side}`);
  try {
    for (const body of hand.scene.bodies) {
      const bar = { type: ShapeType.Cylinder, radiusM: 0.015, lengthM: 0.12, inBody: { positionM: BAR_M } };
      Object.assign(body, { fixed: body.name !== 'drawer', shapes: body.name === 'drawer' ? [bar] : [] });
    }
    const steps = taskOf(hand.scene)!.steps.length, seen = new Perceiver(hand.scene, targetsOf(hand.scene)), model = new AimModel(hand.axes, { help: 'full' });
    model.begin(hand.now.q_m);
    let t = 0, presses = 0, asked_s = 0, most_m = 0;
    for (; t < WITHIN_S && hand.value('done') !== 1; t += LOOK_S) {
      asked_s = hand.value('instruction') === 0 && !model.onItsWay && model.squeeze === 0 ? asked_s + LOOK_S : 0;
      const down = asked_s > 1 && asked_s < 1.2;
      if (down && asked_s < 1 + 1.5 * LOOK_S) presses += 1;
      await hand.aim([...model.step({ ...restingWish(), squeeze: down }, seen.see(hand.state), LOOK_S)], t === 0);
      expect(hand.now.faults, 'faults that stopped the loop').toBe(0);
      most_m = Math.max(most_m, hand.value('joint_q'));
    }
    console.log(`figure: a drawer by one button, ${side}: ${t.toFixed(1)} s, ${presses} presses, score ${hand.value('score').toFixed(0)}, opened ${(100 * most_m).toFixed(1)} cm, step ${hand.value('instruction')}`);
    expect(hand.value('instruction')).toBe(steps);
    expect(presses).toBe(1);
    expect(most_m).toBeGreaterThan(0.09);   // to_m less its tolerance
    expect(hand.value('joint_q')).toBeLessThan(0.01);
  } finally {
    hand.stop();
  }
}, 600_000);
