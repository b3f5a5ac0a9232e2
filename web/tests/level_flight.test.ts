// The balloon of squeezing to a level: its position, and its cue.
import { describe, expect, it } from 'vitest';
import type { SceneT } from '../src/protocol';
import { ShapeType } from '../src/protocol';
import { risen } from '../src/exercises/squeeze_to_level/fleet';
import { flightOf, heightOf } from '../src/exercises/squeeze_to_level/flight';
import { gripOf, Instruction } from '../src/exercises/squeeze_to_level/grip';
import { ExerciseValues } from '../src/exercises/values';

const NAMES = ['instruction', 'score', 'done', 'bands_done', 'bands', 'squeeze_n', 'goal_low_n', 'goal_high_n', 'held_s', 'flow_ml_s', 'paused'];
const values = new ExerciseValues(NAMES);
const HOLD_S = 2;

function flight(now: Readonly<Record<string, number>>): ReturnType<typeof flightOf> {
  return flightOf(values, { values: NAMES.map((name) => now[name] ?? 0) }, HOLD_S);
}

describe('the cue', () => {
  it.each([
    [Instruction.Reach, 'grip'], [Instruction.More, 'up'], [Instruction.Hold, 'stay'],
    [Instruction.Less, 'down'], [Instruction.LetGo, 'open'], [Instruction.Done, 'none'],
  ] as const)('of instruction %i is %s', (instruction, cue) => {
    expect(flight({ instruction, bands: 3 }).cue).toBe(cue);
  });

  it('has a band only while one must be held', () => {
    const goal = { goal_low_n: 1.2, goal_high_n: 2.2, bands: 3 };
    expect(flight({ ...goal, instruction: Instruction.More }).band).toEqual({ low: heightOf(1.2), high: heightOf(2.2) });
    expect(flight({ ...goal, instruction: Instruction.LetGo }).band).toBeNull();
    expect(flight({ ...goal, instruction: Instruction.Done }).band).toBeNull();
  });
});

describe('the balloon', () => {
  it('is between the ribbons exactly while the squeeze is in the band', () => {
    for (const squeeze_n of [1.1, 1.3, 2.1, 2.3]) {
      const { height, band } = flight({ instruction: Instruction.More, squeeze_n, goal_low_n: 1.2, goal_high_n: 2.2 });
      expect(height >= band!.low && height <= band!.high).toBe(squeeze_n >= 1.2 && squeeze_n <= 2.2);
    }
  });

  it('never leaves its course', () => {
    expect([heightOf(-1), heightOf(0), heightOf(1e3)]).toEqual([0, 0, 1]);
  });

  // The area of the flame is proportional to the flow.
  it('burns with the flow out of the grip, and not while air returns', () => {
    expect([-1, 0, 0.5, 2, 9].map((flow_ml_s) => flight({ flow_ml_s }).flame)).toEqual([0, 0, 0.5, 1, 1]);
  });

  it('fills the band with the held time', () => {
    expect(flight({ held_s: 0.5 }).held).toBe(0.25);
    expect(flight({ held_s: 9 }).held).toBe(1);
  });
});

it('and the other balloons rise one after the other without a jump, and stay', () => {
  expect([risen(0, 0.4), risen(0.4, 0.4), risen(Infinity, 0.4)]).toEqual([0, 0, 1]);
  for (let t = 0; t < 4; t += 1 / 60) expect(risen(t + 1 / 60, 0.4) - risen(t, 0.4)).toBeLessThan(0.02);
});

describe('the grip', () => {
  const body = (name: string, type: ShapeType, fixed = true) => ({ name, fixed, shapes: [{ type, radiusM: 0.025, lengthM: 0.2 }] });
  const scene = (json: string, ...bodies: object[]) => ({ exerciseJson: json, bodies }) as unknown as SceneT;
  const KIND = '{"kind":"squeeze_to_level"}';

  it('is the scene\'s fixed cylinder', () => {
    const found = gripOf(scene(KIND, body('counter', ShapeType.Box), body('grip', ShapeType.Cylinder)));
    expect(found).toEqual({ body: 1, radius_m: 0.025, height_m: 0.2, counter: 0 });
  });

  it('is undefined in another exercise, or without a cylinder', () => {
    for (const json of ['', '{', 'null', '{"kind":"free_grasping"}']) expect(gripOf(scene(json, body('grip', ShapeType.Cylinder)))).toBeUndefined();
    expect(gripOf(scene(KIND, body('grip', ShapeType.Cylinder, false)))).toBeUndefined();
    expect(gripOf(null)).toBeUndefined();
  });
});
