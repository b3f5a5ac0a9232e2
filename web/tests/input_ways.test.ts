import { describe, expect, it } from 'vitest';
import { latestOf } from '../src/input/controls';
import { stick, wishOfPad } from '../src/input/gamepad';
import { wishOfMoves } from '../src/input/keys';
import { bend, curl, place, readHand, type Landmark } from '../src/input/landmarks';
import { depthAfterWheel, placeOfPointer } from '../src/input/mouse';
import { lowPassWeight, OneEuroFilter } from '../src/input/one_euro';
import { Drag } from '../src/input/touch';
import { HandFollower, problemOf } from '../src/input/webcam';
import { en } from '../src/input/i18n/en';
import { de } from '../src/input/i18n/de';
import { fr } from '../src/input/i18n/fr';

describe('keys', () => {
  it('move x away from the person, y left, z up', () => {
    const wish = wishOfMoves(new Set(['away', 'left', 'up', 'squeeze'] as const));
    expect(Math.sign(wish.velocity.x)).toBe(1);
    expect(Math.sign(wish.velocity.y)).toBe(1);
    expect(Math.sign(wish.velocity.z)).toBe(1);
    expect(wish.squeeze).toBe(true);
  });

  it('cancel each other in opposite directions', () => {
    expect(wishOfMoves(new Set(['left', 'right'] as const)).velocity.y).toBe(0);
  });
});

describe('mouse', () => {
  const box = { left: 100, top: 50, width: 1000, height: 600 };

  it('maps the middle of the picture to the middle of the workspace', () => {
    const at = placeOfPointer(600, 350, box);
    expect(at.y).toBeCloseTo(0, 12);
    expect(at.z).toBeCloseTo(0, 12);
  });

  it('maps left in the picture to positive y and up to z; 350 px are half the range', () => {
    expect(placeOfPointer(250, 350, box).y).toBeCloseTo(1, 12);
    expect(placeOfPointer(775, 350, box).y).toBeCloseTo(-0.5, 12);
    expect(placeOfPointer(600, 140, box).z).toBeCloseTo(1, 12);
    expect(placeOfPointer(-500, 350, box).y).toBe(1);
  });

  it('moves away when scrolling up; a line counts as 33 px', () => {
    expect(depthAfterWheel(0, -100, 0)).toBeCloseTo(0.12, 12);
    expect(depthAfterWheel(0, 3, 1)).toBeCloseTo(-0.1188, 12);
    expect(depthAfterWheel(0.95, -300, 0)).toBe(1);
  });
});

describe('touch', () => {
  it('moves away when dragged up, and left when dragged left', () => {
    // 180 px of a 600 px side with 60 % of it in use: the whole half range.
    const drag = new Drag(1, 300, 300, { x: 0, y: 0 });
    drag.moveTo(210, 255, 600);
    expect(drag.place.x).toBeCloseTo(0.25, 12);
    expect(drag.place.y).toBeCloseTo(0.5, 12);
  });

  it('keeps no excess beyond the end of the range: moving back has an effect at once', () => {
    const drag = new Drag(1, 300, 300, { x: 0, y: 0 });
    drag.moveTo(300, 900, 600);
    expect(drag.place.x).toBe(-1);
    drag.moveTo(300, 882, 600);  // 18 of 180 px
    expect(drag.place.x).toBeCloseTo(-0.9, 12);
  });

  it('continues from where the help moved the hand', () => {
    const drag = new Drag(1, 300, 300, { x: 0, y: -1 });
    drag.overruled({ y: 0.2 });
    drag.moveTo(255, 300, 600);  // 45 of 180 px to the left
    expect(drag.place).toEqual({ x: 0, y: expect.closeTo(0.45, 12) as number });
  });
});

describe('gamepad', () => {
  const rest = Array.from({ length: 17 }, () => ({ value: 0, pressed: false }));

  it('has a dead zone and a quadratic stick: half of the remaining range gives a quarter', () => {
    expect(stick(0.14)).toBe(0);
    expect(stick(-0.575)).toBeCloseTo(-0.25, 12);  // (0.575 - 0.15) / 0.85 = 0.5, squared
    expect(stick(1)).toBe(1);
  });

  it('gives no wish at rest', () => {
    expect(wishOfPad({ mapping: 'standard', axes: [0, 0, 0, 0], buttons: rest })).toBeUndefined();
  });

  it('moves away and left with the left stick, and lifts with the right stick', () => {
    const wish = wishOfPad({ mapping: 'standard', axes: [-1, -1, 0, -1], buttons: rest });
    expect(wish?.velocity).toEqual({ x: 0.15, y: 0.15, z: 0.15 });
  });

  it('squeezes as far as its trigger is pulled', () => {
    const buttons = rest.map((button, i) => (i === 7 ? { value: 0.6, pressed: true } : button));
    expect(wishOfPad({ mapping: 'standard', axes: [0, 0, 0, 0], buttons })?.squeeze).toBe(0.6);
  });
});

describe('one-euro filter', () => {
  it('has the weight 0.0948 at a cut-off of 1 Hz and 60 Hz', () => {
    // tau = 1/(2 pi) = 0.159155 s, T = 1/60: 1 / (1 + 9.5493) = 0.094793
    expect(lowPassWeight(1, 1 / 60)).toBeCloseTo(0.094793, 6);
  });

  it('with beta 0 is a first-order low-pass', () => {
    const filter = new OneEuroFilter({ minCutoff_hz: 1, beta: 0, speedCutoff_hz: 1 });
    filter.filter(0, 0);
    const weight = lowPassWeight(1, 0.1);
    expect(filter.filter(1, 0.1)).toBeCloseTo(weight, 12);
    expect(filter.filter(1, 0.2)).toBeCloseTo(1 - (1 - weight) ** 2, 12);
  });

  it('follows a fast hand with less delay than a slow one', () => {
    const lagAfter = (step: number): number => {
      const filter = new OneEuroFilter({ minCutoff_hz: 1, beta: 3, speedCutoff_hz: 1 });
      for (let k = 0; k < 60; k += 1) filter.filter(k * step, k / 60);
      return (60 * step - filter.filter(60 * step, 1)) / step;
    };
    expect(lagAfter(0.05)).toBeLessThan(lagAfter(0.001) / 2);
  });

  it('ignores a value that is not a number, and a clock that stands still', () => {
    const filter = new OneEuroFilter({ minCutoff_hz: 1, beta: 0, speedCutoff_hz: 1 });
    filter.filter(2, 1);
    expect(filter.filter(Number.NaN, 1.1)).toBe(2);
    expect(filter.filter(9, 1)).toBe(2);
  });
});

describe('webcam', () => {
  /** A planar hand: palm down from the wrist, every finger joint bent by `angle`. */
  function hand(angle: number, scale = 1, dx = 0): Landmark[] {
    const points: Landmark[] = [{ x: 0.5 + dx, y: 0.8, z: 0 }];
    for (let digit = 0; digit < 5; digit += 1) {
      let at = { x: 0.5 + dx, y: 0.8, z: 0 };
      let heading = 0;
      [0.3, 0.1, 0.06, 0.04].forEach((length, joint) => {
        if (joint > 0) heading += angle;
        at = { x: at.x, y: at.y - scale * length * Math.cos(heading), z: at.z - scale * length * Math.sin(heading) };
        points.push(at);
      });
    }
    return points;
  }

  it('measures a bend of pi/2 at a right angle, and 0 in a straight chain', () => {
    const p = (x: number, y: number): Landmark => ({ x, y, z: 0 });
    expect(bend(p(0, 0), p(1, 0), p(1, 1))).toBeCloseTo(Math.PI / 2, 12);
    expect(bend(p(0, 0), p(1, 0), p(2, 0))).toBe(0);
  });

  it('sums three joints of 40 degrees each to 120 degrees of finger flexion', () => {
    const reading = readHand(hand((40 * Math.PI) / 180), hand((40 * Math.PI) / 180), 4 / 3)!;
    expect(reading.fingers_rad).toBeCloseTo((120 * Math.PI) / 180, 6);
    expect(curl(reading)).toBeCloseTo((2.0944 - 0.9) / 2.5, 4);
  });

  it('reads a flat hand as open, and a fist as closed', () => {
    expect(curl(readHand(hand(0), hand(0), 1)!)).toBe(0);
    expect(curl(readHand(hand(1.3), hand(1.3), 1)!)).toBe(1);
  });

  it('maps the picture\'s right to the person\'s left, with positive y', () => {
    const reading = readHand(hand(0, 1, 0.15), hand(0), 1)!;
    expect(reading.palmX).toBeCloseTo(0.65, 9);
    expect(place(reading, reading.palmSize).y).toBeCloseTo(0.5, 9);
  });

  it('maps a hand that appears 1.6 times as large to the farthest position from the person', () => {
    const rest = readHand(hand(0), hand(0), 1)!;
    expect(place(rest, rest.palmSize).x).toBe(0);
    expect(place({ ...rest, palmSize: 1.6 * rest.palmSize }, rest.palmSize).x).toBeCloseTo(1, 9);
    expect(place({ ...rest, palmSize: rest.palmSize / 1.6 }, rest.palmSize).x).toBeCloseTo(-1, 9);
  });

  it('takes the first picture as the middle of the depth', () => {
    const follower = new HandFollower();
    const reading = readHand(hand(0), hand(0), 1)!;
    expect(follower.follow(reading, 0).place.x).toBe(0);
  });

  it('sees no hand with too few points', () => {
    expect(readHand([], [], 1)).toBeUndefined();
  });

  it('distinguishes refused, absent and busy cameras by the browser\'s error', () => {
    const named = (name: string): Error => Object.assign(new Error(), { name });
    expect(problemOf(named('NotAllowedError'))).toBe('refused');
    expect(problemOf(named('NotFoundError'))).toBe('absent');
    expect(problemOf(named('NotReadableError'))).toBe('busy');
  });
});

describe('the present input method', () => {
  it('is the one used last; none if none was used', () => {
    expect(latestOf([{ claimed_s: -Infinity }])).toBeUndefined();
    const keys = { claimed_s: 3 };
    const mouse = { claimed_s: 5 };
    expect(latestOf([keys, mouse])).toBe(mouse);
  });
});

describe('texts', () => {
  const shape = (value: unknown): unknown =>
    typeof value === 'string' ? value.length > 0
      : Object.fromEntries(Object.entries(value as object).map(([k, v]) => [k, shape(v)]));

  it('in German and French are complete, with nothing empty', () => {
    for (const other of [de, fr]) {
      expect(Object.keys(other.help)).toEqual(Object.keys(en.help));
      for (const way of Object.keys(en.help) as (keyof typeof en.help)[]) {
        expect(other.help[way].length).toBe(en.help[way].length);
      }
      expect(shape(other.webcam)).toEqual(shape(en.webcam));
      expect(shape(other.ways)).toEqual(shape(en.ways));
      expect(shape(other.touch)).toEqual(shape(en.touch));
    }
  });

  it('in German use Swiss spelling', () => {
    expect(JSON.stringify(de)).not.toContain('ß');
  });
});
