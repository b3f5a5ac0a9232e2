import { PerspectiveCamera, Vector3 } from 'three';
import { describe, expect, it } from 'vitest';
import { placeCamera, pointInRow } from '../src/scene/camera';
import { AimModel } from '../src/input/aim_model';
import type { Perception } from '../src/input/perceiver';
import { placeOnAxis } from '../src/input/axis_range';
import { nearestGrip } from '../src/input/guide';
import { limitsOf } from '../src/input/limits';
import { postureOf, squeezeOfFingers } from '../src/input/posture';
import { Drag } from '../src/input/touch';
import { restingWish, type Wish } from '../src/input/wish';
import type { SceneT, WorldStateT } from '../src/protocol';

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
  return { device, grips: [], beside: 1, squeeze_n: 0, squeezeLow_n: 4, squeezeHigh_n: 8, target: -1, letGo: false, touches: [], ...more };
}

function ask(more: Partial<Wish>): Wish {
  return { ...restingWish(), ...more };
}

/** A device that is always at its aim, for `time_s` at 60 Hz. */
function play(model: AimModel, wish: Wish, time_s: number, more: Partial<Perception> = {}): void {
  for (let k = 0; k < Math.round(time_s * 60); k += 1) model.step(wish, seen([...model.aim], more), 1 / 60);
}

function begun(config = {}): AimModel {
  const model = new AimModel(AXES, config);
  model.begin(START);
  return model;
}

describe('limits set by a therapist', () => {
  const scene = { parameters: [{ name: 'wall_fade_s' }, { name: 'reach_left_m' }, { name: 'reach_right_m' }, { name: 'reach_forward_m' }, { name: 'fingers_open_rad' }, { name: 'fingers_close_rad' }] } as unknown as SceneT;

  it('are read by name from the program\'s values, for each axis and side', () => {
    const state = { parameters: [1, 0.05, 0.07, 0.04, 0.3, 2.6] } as unknown as WorldStateT;
    expect(limitsOf(scene, state)).toEqual({ x: [-Infinity, 0.04], y: [-0.07, 0.05], finger_flexion: [0.3, 2.6] });
  });

  it('are absent if the exercise has none, or before the first state', () => {
    expect(limitsOf({ parameters: [{ name: 'lead_in_m' }] } as unknown as SceneT, { parameters: [0.01] } as unknown as WorldStateT)).toEqual({});
    expect(limitsOf(scene, { parameters: [] } as unknown as WorldStateT)).toEqual({});
  });
});

describe('the aim on the arm axes', () => {
  it('moves at the requested speed: 0.1 m/s for 0.5 s is 50 mm away, along one axis only', () => {
    const model = begun();
    play(model, ask({ velocity: { x: 0.1, y: 0, z: 0 } }), 0.5);
    expect(model.aim[0]).toBeCloseTo(0.05, 9);
    expect(model.aim.slice(1)).toEqual(START.slice(1));
  });

  it('never exceeds its speed limit', () => {
    const byCursor = begun({ speed_m_s: 0.2 });
    byCursor.step(ask({ place: { y: 1 } }), seen(), 0.01);
    expect(byCursor.aim[1]).toBeCloseTo(0.002, 12);
    const byKeys = begun({ speed_m_s: 0.2 });
    byKeys.step(ask({ velocity: { x: 0, y: 9, z: 0 } }), seen(), 0.01);
    expect(byKeys.aim[1]).toBeCloseTo(0.002, 12);
  });

  it('stops at the end of the person\'s reach, and returns gently when the reach becomes shorter', () => {
    const model = begun();
    model.limits = { y: [-0.05, 0.03], x: [-Infinity, 0.04] };
    play(model, ask({ velocity: { x: 0.15, y: 0.15, z: 0 } }), 2);
    expect(model.aim.slice(0, 2)).toEqual([0.04, 0.03]);
    play(model, ask({ place: { y: -1 } }), 2);
    expect(model.aim[1]).toBe(-0.05);
    model.limits = { y: [-0.03, 0.03] };
    play(model, ask({}), 1 / 60);
    expect(model.aim[1]).toBeCloseTo(-0.05 + model.config.speed_m_s / 60, 9);
    play(model, ask({}), 1);
    expect(model.aim[1]).toBe(-0.03);
  });

  it('keeps the fingers within the person\'s range', () => {
    const model = begun({ help: 'none' });
    model.limits = { finger_flexion: [0.6, 2.4] };
    play(model, ask({ squeeze: true }), 3);
    expect(model.aim[3]).toBe(2.4);
    // A stretched open hand beside a bottle has an aim of 8 degrees.
    play(model, ask({ velocity: { x: 0.1, y: 0, z: 0 } }), 2, { grips: [{ x: 0, y: 0, z: 0 }] });
    expect(model.aim[3]).toBe(0.6);
  });

  it('stops at the end of the axis\'s range', () => {
    const model = begun();
    play(model, ask({ velocity: { x: 0, y: 0, z: -0.15 } }), 2);
    expect(model.aim[2]).toBe(-0.12);
  });

  it('does not run ahead of a blocked device', () => {
    const model = begun({ leash_m: 0.03 });
    for (let k = 0; k < 120; k += 1) model.step(ask({ velocity: { x: 0.1, y: 0, z: 0 } }), seen(), 1 / 60);
    expect(model.aim[0]).toBeCloseTo(0.03, 12);
  });

  it('moves to the cursor and stays there', () => {
    const model = begun();
    play(model, ask({ place: { y: -0.5, z: 0.25 } }), 3);
    expect(model.aim[1]).toBeCloseTo(-0.06, 9);
    expect(model.aim[2]).toBeCloseTo(0.03, 9);
  });

  it('begins at the hand\'s position, so that nothing jumps', () => {
    const model = new AimModel(AXES);
    model.begin([0.02, -0.05, 0.01, 1.5, 0.2, 0.3]);
    model.step(restingWish(), seen([0.02, -0.05, 0.01, 1.5, 0.2, 0.3]), 1 / 60);
    expect(model.aim.slice(0, 3)).toEqual([0.02, -0.05, 0.01]);
    expect(Math.abs(model.aim[3] - 1.5)).toBeLessThan(0.07);  // opens at 4 rad/s at most
  });
});

describe('help near a dispenser', () => {
  // A right hand's grip at x = 70 mm; the hand enters 24 mm to the right of the palm's contact position.
  const grip = { x: 0.07, y: -0.01, z: 0.004 };
  const back = [-0.077, -0.03, 0, 65 * DEGREE, 5 * DEGREE, 0];
  const forward = ask({ velocity: { x: 0.12, y: 0, z: 0 } });

  it('enters beside the dispenser with stretched fingers, then moves to it', () => {
    const model = begun();
    model.begin(back);
    for (let k = 0; k < 300 && model.aim[0] < 0.04; k += 1) model.step(forward, seen([...model.aim], { grips: [grip] }), 1 / 60);
    expect(model.aim[1]).toBeCloseTo(-0.034, 3);
    expect(model.aim[3] / DEGREE).toBeCloseTo(8, 1);
    play(model, forward, 3, { grips: [grip] });
    expect(model.aim[0]).toBeCloseTo(0.07, 3);
    expect(model.aim[1]).toBeCloseTo(-0.01, 3);
  });

  it('waits in front of the row until the hand is in its lane', () => {
    const model = begun();
    model.begin([-0.077, 0.03, 0, 65 * DEGREE, 0, 0]);
    play(model, forward, 0.3, { grips: [grip] });
    // 54 mm of x would take less time at 0.12 m/s; the hand first moves sideways.
    expect(model.aim[0]).toBeLessThan(-0.07);
    play(model, forward, 3, { grips: [grip] });
    expect(model.aim[0]).toBeCloseTo(0.07, 3);
  });

  it('leaves on the same path: first sideways, then back', () => {
    const model = begun();
    model.begin([0.07, -0.01, 0, 8 * DEGREE, 5 * DEGREE, 0]);
    const near = ask({ velocity: { x: -0.12, y: 0, z: 0 } });
    play(model, near, 0.1, { grips: [grip] });
    expect(model.aim[0]).toBeGreaterThan(0.068);  // 58 mm if it moved at once
    play(model, near, 4, { grips: [grip] });
    expect(model.aim[0]).toBeCloseTo(-0.085, 3);
    expect(model.aim[1]).toBeCloseTo(-0.034, 3);
    expect(model.aim[3] / DEGREE).toBeCloseTo(65, 1);
  });

  it('is mirrored for a left hand', () => {
    const model = begun();
    model.begin(back);
    for (let k = 0; k < 300 && model.aim[0] < 0.04; k += 1) model.step(forward, seen([...model.aim], { grips: [grip], beside: -1 }), 1 / 60);
    expect(model.aim[1]).toBeCloseTo(0.014, 3);
  });

  it('draws the hand back beside the dispenser, and lets a finger drag on from there', () => {
    const model = begun();
    model.begin([0.06, -0.01, 0.004, ...START.slice(3)]);
    // The finger came down when the hand was elsewhere, at the right end of the range.
    const drag = new Drag(1, 300, 300, { x: 0.7, y: -1 });
    const drawn = (time_s: number): void => {
      for (let k = 0; k < 60 * time_s; k += 1) {
        model.step(ask({ place: drag.place }), seen([...model.aim], { grips: [grip] }), 1 / 60);
        drag.overruled(model.overruled);
      }
    };
    drag.moveTo(300, 900, 600);
    drawn(3);
    expect(model.aim[0]).toBeCloseTo(-0.085, 3);
    expect(Math.abs(model.aim[1] + 0.034)).toBeLessThan(0.003);  // in its lane, not at the place where the finger came down
    const before = model.aim[1];
    drag.moveTo(210, 900, 600);  // 90 of 180 px: half of the half range of 120 mm, to the left
    drawn(2);
    expect(model.aim[1] - before).toBeCloseTo(0.06, 3);
  });

  it('moves a squeezing hand to the dispenser first, reports that, and then closes', () => {
    const model = begun();
    model.begin([0, -0.034, 0.004, 8 * DEGREE, 5 * DEGREE, 0]);
    play(model, ask({ squeeze: true }), 0.2, { grips: [grip] });
    expect(model.squeeze).toBe(0);
    expect(model.onItsWay).toBe(true);
    play(model, ask({ squeeze: true }), 2, { grips: [grip] });
    expect(model.aim[0]).toBeCloseTo(grip.x, 2);
    expect(model.aim[1]).toBeCloseTo(grip.y, 2);
    expect(model.squeeze).toBeGreaterThan(0.2);
    expect(model.onItsWay).toBe(false);
  });

  it('lets a blocked open hand press with more than 1.5 N for at most 3 s', () => {
    for (let short_m = 0; short_m < 0.03; short_m += 0.001) {
      const model = begun();
      const device = [grip.x - short_m, grip.y, grip.z, ...START.slice(3)];
      model.begin(device);
      // For any relative position of the target, the force is 300 N/m times the lead of the aim.
      const look = (): number => {
        const press_n = 300 * (model.aim[0] - device[0]);
        const touches = press_n > 0 ? [{ at: 0, force_n: { x: -press_n, y: 0, z: 0 } }] : [];
        model.step(forward, seen(device, { grips: [grip], touches }), 1 / 60);
        return press_n;
      };
      for (let k = 0; k < 180; k += 1) look();
      expect(look(), `${1e3 * short_m} mm short of it`).toBeLessThanOrEqual(1.5);
    }
  });

  it('does not prevent a requested sideways movement', () => {
    const model = begun();
    model.begin([0, -0.034, 0.004, 8 * DEGREE, 5 * DEGREE, 0]);
    play(model, ask({ velocity: { x: 0, y: 0.1, z: 0 } }), 0.2, { grips: [grip] });
    expect(model.aim[1]).toBeCloseTo(-0.014, 9);
  });

  it('uses the laterally nearest dispenser', () => {
    const aim = { x: 0, y: 0.03, z: 0.1 };
    expect(nearestGrip([{ x: 0, y: 0.1, z: 0 }, { x: 0, y: -0.028, z: 0 }], aim)).toBe(1);
    expect(nearestGrip([{ x: 0, y: 0.3, z: 0 }], aim)).toBeUndefined();
    expect(nearestGrip([{ x: 0, y: 0, z: 0 }, { x: 0, y: 0, z: 0.14 }], aim), 'of two in one lane, the nearer one in height').toBe(1);
  });

  it('can be switched off', () => {
    const model = begun({ help: 'none' });
    model.begin(back);
    play(model, forward, 1, { grips: [grip] });
    expect(model.aim[0]).toBeCloseTo(0.043, 9);
    expect(model.aim[1]).toBe(-0.03);
  });
});

it('maps the cursor to the row: a bottle is pointed at where it is drawn, on every screen', () => {
  const camera = new PerspectiveCamera();
  for (const [width, height] of [[1280, 800], [1920, 1080], [1024, 768], [800, 1280]] as const) {
    placeCamera(camera, 'game', { right: true, counter_y: -0.253, row_z: -0.119 }, [], width, height);
    camera.updateMatrixWorld(true);
    for (const [y, z] of [[-0.023, 0.004], [0.105, 0.1], [0.233, -0.2]] as const) {
      // three.js projects with its own axes: (-y, z, -x) of the program's world.
      const drawn = new Vector3(-y, z, -0.119).project(camera);
      const at = pointInRow(camera, -0.119, 0.5 + drawn.x / 2, 0.5 - drawn.y / 2)!;
      expect(at.y_m).toBeCloseTo(y, 9);
      expect(at.z_m).toBeCloseTo(z, 9);
    }
  }
  expect(pointInRow(camera, -0.119, 1.2, 0.5)).toBeNull();
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

  it('moves thumb and stretched fingers around the target before closing', () => {
    expect(postureOf('thumb_circumduction', 0.15) / DEGREE).toBeCloseTo(20, 9);
    expect(postureOf('finger_flexion', 0, 1) / DEGREE).toBeCloseTo(8, 9);
    expect(postureOf('finger_flexion', 0.15, 1) / DEGREE).toBeCloseTo(65, 9);
    expect(postureOf('thumb_flexion', 0.15)).toBe(0);
    expect(postureOf('thumb_flexion', 1) / DEGREE).toBeCloseTo(61, 9);
  });

  it('is computed back from the fingers: 65 to 165 degrees are 0.15 to 1', () => {
    expect(squeezeOfFingers(115 * DEGREE)).toBeCloseTo(0.575, 9);
    expect(squeezeOfFingers(0)).toBe(0);
  });

  it('slows down after contact', () => {
    const free = begun();
    const touching = begun();
    play(free, ask({ squeeze: true }), 0.5);
    play(touching, ask({ squeeze: true }), 0.5, { squeeze_n: 1 });
    expect(free.squeeze).toBeCloseTo(0.4, 9);        // 0.8 1/s for 0.5 s
    expect(touching.squeeze).toBeCloseTo(0.06, 9);   // 0.12 1/s for 0.5 s
  });

  it('with help, settles in the middle of the zone and eases above it', () => {
    const model = begun();
    play(model, ask({ squeeze: true }), 0.5);
    const before = model.squeeze;
    play(model, ask({ squeeze: true }), 1, { squeeze_n: 6 });
    expect(model.squeeze).toBe(before);
    play(model, ask({ squeeze: true }), 1, { squeeze_n: 9 });
    expect(model.squeeze).toBeCloseTo(before - 0.12, 9);
  });

  it('without help, increases while the button is held', () => {
    const model = begun({ help: 'none' });
    play(model, ask({ squeeze: true }), 20, { squeeze_n: 6 });
    expect(model.squeeze).toBe(1);
  });

  it('follows an analog trigger', () => {
    const model = begun();
    play(model, ask({ squeeze: 0.4 }), 1);
    expect(model.squeeze).toBeCloseTo(0.4, 12);
  });
});

it('maps an asymmetric range: the middle is 0, the ends are -1 and 1', () => {
  const axis = { name: 'x', lower: -0.02, upper: 0.06 };
  expect(placeOnAxis(axis, 0)).toBeCloseTo(0.02, 12);
  expect(placeOnAxis(axis, -1)).toBeCloseTo(-0.02, 12);
  expect(placeOnAxis(axis, 3)).toBeCloseTo(0.06, 12);
});
