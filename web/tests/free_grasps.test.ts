// Free grasping: detection of held objects, and the object that is proposed next.
import { describe, expect, it } from 'vitest';
import { ShapeType, type SceneT } from '../src/protocol';
import { Grasps, HOLD_S, isHeld, type News } from '../src/exercises/free_grasping/grasps';
import { thingsOf } from '../src/exercises/free_grasping/things';

type Touches = Parameters<typeof isHeld>[0];
const touch = (capsule: number, body: number, y: number) => ({ capsule, body, forceN: { x: 0, y, z: 0 } }) as unknown as Touches[number];
const pinch = (body: number): Touches => [touch(3, body, 1), touch(9, body, -1)];
const TICK_S = 1 / 60;

/** Sends the contacts for this long; returns the reported news. */
function look(grasps: Grasps, contacts: Touches, from_s: number, for_s: number): News[] {
  const news: News[] = [];
  for (let t = from_s; t <= from_s + for_s; t += TICK_S) news.push(grasps.look(contacts, t));
  return news.filter((one) => one !== undefined);
}

describe('an object', () => {
  it('is held between two sides, and not by a push, by one part of the hand, or by a weak touch', () => {
    expect(isHeld(pinch(0), 0)).toBe(true);
    expect(isHeld(pinch(0), 1)).toBe(false);
    expect(isHeld([touch(3, 0, 1), touch(9, 0, 2)], 0)).toBe(false);
    expect(isHeld([touch(3, 0, 1), touch(3, 0, -1)], 0)).toBe(false);
    expect(isHeld([touch(3, 0, 0.01), touch(9, 0, -0.01)], 0)).toBe(false);
  });

  it('counts after it was held for long enough without interruption', () => {
    const grasps = new Grasps([0, 1]);
    expect(look(grasps, pinch(1), 0, 0.7 * HOLD_S)).toEqual([]);
    expect(look(grasps, [], 0.75, 0.2)).toEqual([]);
    expect(look(grasps, pinch(1), 1, 0.7 * HOLD_S)).toEqual([]);
    expect(look(grasps, pinch(1), 1.72, 0.4 * HOLD_S)).toEqual(['held']);
    expect(grasps.held).toEqual([false, true]);
  });

  it('does not count for a time without states', () => {
    const grasps = new Grasps([0]);
    for (const now_s of [0, 5, 10]) expect(grasps.look(pinch(0), now_s)).toBeUndefined();
  });
});

describe('the proposed object', () => {
  it('is the one in the hand, then the first that was not held, then none', () => {
    const grasps = new Grasps([4, 5]);
    expect(grasps.proposed).toBe(0);
    look(grasps, pinch(5), 0, 0.2);
    expect(grasps.proposed).toBe(1);
    expect(look(grasps, pinch(5), 0.2, 1.2 * HOLD_S)).toEqual(['held']);
    expect(grasps.proposed).toBe(0);
    expect(look(grasps, pinch(4), 2, 1.2 * HOLD_S)).toEqual(['all']);
    expect([grasps.proposed, grasps.all, grasps.count]).toEqual([-1, true, 2]);
    grasps.begin();
    expect([grasps.proposed, grasps.all, grasps.count]).toEqual([0, false, 0]);
  });
});

describe('the objects', () => {
  const body = (type: ShapeType, lengthM: number, fixed = false) => ({ name: `${type} ${lengthM}`, fixed, color: '#3B6FD1', shapes: [{ type, radiusM: 0.03, lengthM }] });
  const scene = (json: string, ...bodies: object[]) => ({ exerciseJson: json, bodies }) as unknown as SceneT;
  const KIND = '{"kind":"free_grasping"}';

  it('are identified by their shapes', () => {
    const found = thingsOf(scene(KIND, body(ShapeType.Box, 0), body(ShapeType.Cylinder, 0.12), body(ShapeType.Sphere, 0), body(ShapeType.Cylinder, 0.02)));
    expect(found?.map(({ kind }) => kind)).toEqual(['cube', 'cylinder', 'sphere', 'disk']);
  });

  it('are none on a table, in another exercise, or if two have the same shape', () => {
    expect(thingsOf(scene(KIND, body(ShapeType.Box, 0), body(ShapeType.Box, 1, true)))).toBeUndefined();
    expect(thingsOf(scene(KIND, body(ShapeType.Sphere, 0), body(ShapeType.Sphere, 1)))).toBeUndefined();
    expect(thingsOf(scene('{"kind":"squeeze_to_level"}', body(ShapeType.Box, 0)))).toBeUndefined();
    expect(thingsOf(null)).toBeUndefined();
  });
});
