import { describe, expect, it } from 'vitest';
import { AimModel, placeOnAxis, type Perception } from '../src/input/aim_model';
import { postureOf, squeezeOfFingers } from '../src/input/posture';
import { restingWish, type Wish } from '../src/input/wish';

const DEGREE = Math.PI / 180;
// The six axes of the rehabilitation robot, config/devices/lambda-pride.toml.
const AXES = [
  { name: 'x', lower: -0.085, upper: 0.085 },
  { name: 'y', lower: -0.12, upper: 0.12 },
  { name: 'z', lower: -0.12, upper: 0.12 },
  { name: 'finger_flexion', lower: 0, upper: Math.PI },
  { name: 'thumb_circumduction', lower: 0, upper: Math.PI / 2 },
  { name: 'thumb_flexion', lower: 0, upper: 80 * DEGREE },
];
const START = [0, 0, 0, 65 * DEGREE, 5 * DEGREE, 0];

function seen(device: readonly number[] = START, more: Partial<Perception> = {}): Perception {
  return { device, squeeze_n: 0, squeezeLow_n: 4, squeezeHigh_n: 8, ...more };
}

function ask(more: Partial<Wish>): Wish {
  return { ...restingWish(), ...more };
}

/** A device that is always where it was aimed, for `time_s` at 60 Hz. */
function play(model: AimModel, wish: Wish, time_s: number, more: Partial<Perception> = {}): void {
  for (let k = 0; k < Math.round(time_s * 60); k += 1) model.step(wish, seen([...model.aim], more), 1 / 60);
}

function begun(config = {}): AimModel {
  const model = new AimModel(AXES, config);
  model.begin(START);
  return model;
}

describe('the aim on the arm axes', () => {
  it('moves at the speed asked for: 0.1 m/s for 0.5 s is 50 mm away and nothing else', () => {
    const model = begun();
    play(model, ask({ velocity: { x: 0.1, y: 0, z: 0 } }), 0.5);
    expect(model.aim[0]).toBeCloseTo(0.05, 9);
    expect(model.aim.slice(1)).toEqual(START.slice(1));
  });

  it('never moves faster than its limit, whatever is asked', () => {
    const byCursor = begun({ speed_m_s: 0.2 });
    byCursor.step(ask({ place: { y: 1 } }), seen(), 0.01);
    expect(byCursor.aim[1]).toBeCloseTo(0.002, 12);
    const byKeys = begun({ speed_m_s: 0.2 });
    byKeys.step(ask({ velocity: { x: 0, y: 9, z: 0 } }), seen(), 0.01);
    expect(byKeys.aim[1]).toBeCloseTo(0.002, 12);
  });

  it('stops at the end of the range', () => {
    const model = begun();
    play(model, ask({ velocity: { x: 0, y: 0, z: -0.15 } }), 2);
    expect(model.aim[2]).toBe(-0.12);
  });

  it('does not run ahead of a device that is held back', () => {
    const model = begun({ leash_m: 0.03 });
    for (let k = 0; k < 120; k += 1) model.step(ask({ velocity: { x: 0.1, y: 0, z: 0 } }), seen(), 1 / 60);
    expect(model.aim[0]).toBeCloseTo(0.03, 12);
  });

  it('goes to the cursor and stays there', () => {
    const model = begun();
    play(model, ask({ place: { y: -0.5, z: 0.25 } }), 3);
    expect(model.aim[1]).toBeCloseTo(-0.06, 9);
    expect(model.aim[2]).toBeCloseTo(0.03, 9);
  });

  it('begins where the hand is, so that nothing jumps', () => {
    const model = new AimModel(AXES);
    model.begin([0.02, -0.05, 0.01, 1.5, 0.2, 0.3]);
    model.step(restingWish(), seen([0.02, -0.05, 0.01, 1.5, 0.2, 0.3]), 1 / 60);
    expect(model.aim.slice(0, 3)).toEqual([0.02, -0.05, 0.01]);
    expect(Math.abs(model.aim[3] - 1.5)).toBeLessThan(0.07);  // opens at 4 rad/s at most
  });
});

describe('help near a dispenser', () => {
  const grip = { x: 0.02, y: -0.01, z: 0.05 };

  it('eases x and y to the grip with the time constant of its config, and leaves z', () => {
    const model = begun({ ease_s: 0.25, speed_m_s: 10 });
    play(model, restingWish(), 0.25, { grip });
    // 15 steps of exp(-1/15) are one time constant: 1 - 1/e of the way.
    expect(model.aim[0]).toBeCloseTo(0.02 * (1 - Math.exp(-1)), 9);
    expect(model.aim[1]).toBeCloseTo(-0.01 * (1 - Math.exp(-1)), 9);
    expect(model.aim[2]).toBe(0);
  });

  it('does not hold a person who draws back', () => {
    const model = begun();
    play(model, ask({ velocity: { x: -0.1, y: 0, z: 0 } }), 0.5, { grip });
    expect(model.aim[0]).toBeCloseTo(-0.05, 9);
  });

  it('does not hold a cursor that is far from the grip', () => {
    const model = begun();
    play(model, ask({ place: { y: 0.5 } }), 3, { grip });
    expect(model.aim[1]).toBeCloseTo(0.06, 9);
  });

  it('can be switched off', () => {
    const model = begun({ assist: false });
    play(model, restingWish(), 1, { grip });
    expect(model.aim[0]).toBe(0);
  });
});

describe('the squeeze', () => {
  it('closes from the open hand to beyond the contact at 131 degrees, and opens again', () => {
    const model = begun();
    expect(model.aim[3] / DEGREE).toBeCloseTo(65, 9);
    play(model, ask({ squeeze: true }), 2);
    expect(model.aim[3] / DEGREE).toBeGreaterThanOrEqual(155);
    play(model, restingWish(), 1);
    expect(model.aim.slice(3)).toEqual([65 * DEGREE, 5 * DEGREE, 0]);
  });

  it('brings the thumb round before it bends it', () => {
    expect(postureOf('thumb_circumduction', 0.3) / DEGREE).toBeCloseTo(20, 9);
    expect(postureOf('thumb_flexion', 0.25)).toBe(0);
    expect(postureOf('thumb_flexion', 1) / DEGREE).toBeCloseTo(62, 9);
  });

  it('is found back from the fingers: half way between open and closed is one half', () => {
    expect(squeezeOfFingers(115 * DEGREE)).toBeCloseTo(0.5, 9);
    expect(squeezeOfFingers(0)).toBe(0);
  });

  it('slows down when something is felt', () => {
    const free = begun();
    const touching = begun();
    play(free, ask({ squeeze: true }), 0.5);
    play(touching, ask({ squeeze: true }), 0.5, { squeeze_n: 1 });
    expect(free.squeeze).toBeCloseTo(0.375, 9);      // 0.75 1/s for 0.5 s
    expect(touching.squeeze).toBeCloseTo(0.06, 9);   // 0.12 1/s for 0.5 s
  });

  it('with help, rests in the middle of the zone and softens above it', () => {
    const model = begun();
    play(model, ask({ squeeze: true }), 0.5);
    const before = model.squeeze;
    play(model, ask({ squeeze: true }), 1, { squeeze_n: 6 });
    expect(model.squeeze).toBe(before);
    play(model, ask({ squeeze: true }), 1, { squeeze_n: 9 });
    expect(model.squeeze).toBeCloseTo(before - 0.12, 9);
  });

  it('without help, presses on for as long as it is held', () => {
    const model = begun({ assist: false });
    play(model, ask({ squeeze: true }), 20, { squeeze_n: 6 });
    expect(model.squeeze).toBe(1);
  });

  it('follows a trigger as far as it is pulled', () => {
    const model = begun();
    play(model, ask({ squeeze: 0.4 }), 1);
    expect(model.squeeze).toBeCloseTo(0.4, 12);
  });
});

it('parts of a range that is not symmetric: the middle is 0, the ends are -1 and 1', () => {
  const axis = { name: 'x', lower: -0.02, upper: 0.06 };
  expect(placeOnAxis(axis, 0)).toBeCloseTo(0.02, 12);
  expect(placeOnAxis(axis, -1)).toBeCloseTo(-0.02, 12);
  expect(placeOnAxis(axis, 3)).toBeCloseTo(0.06, 12);
});
