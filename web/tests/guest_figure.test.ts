// The models of guests: finite, on the counter, and with the same parts in every pose.
import { Color, type BufferGeometry } from 'three';
import { describe, expect, it } from 'vitest';
import { makeFigure, POSES, STUFFS, type Figure } from '../src/exercises/cocktail_bar/guest_figure';
import { GUESTS } from '../src/exercises/cocktail_bar/guest_looks';

const DRINK = ['#F6C636', '#A31D38'].map((color) => new Color(color));
/** Bounds of a guest [m]: in front of the wall and under the rail, including the arms. */
const ROOM = { side_m: 0.17, top_m: 0.31, back_m: 0.11, front_m: 0.15 } as const;

function made(guest: number, fineness: number): Figure {
  const steps = makeFigure(guest, DRINK, fineness);
  for (;;) {
    const step = steps.next();
    if (step.done) return step.value;
  }
}

const triangles = (figure: Figure): number => STUFFS.reduce((sum, stuff) => sum + figure.geometry[stuff].index!.count / 3, 0);

describe.each(GUESTS.map((look, guest) => [look.hair, guest] as const))('the guest with the hair %s', (_, guest) => {
  const figure = made(guest, 0.5);

  it('has finite positions, and normals of length one', () => {
    for (const pose of POSES) {
      for (const stuff of STUFFS) {
        const { position, normal } = figure.poses[pose][stuff];
        expect(position.every(Number.isFinite)).toBe(true);
        for (let i = 0; i < normal.length; i += 3) expect(Math.hypot(normal[i], normal[i + 1], normal[i + 2])).toBeCloseTo(1, 4);
      }
    }
  });

  it('has the same triangles in every pose, so that poses can be interpolated', () => {
    for (const pose of POSES) for (const stuff of STUFFS) expect(figure.poses[pose][stuff].position.length).toBe(3 * figure.geometry[stuff].attributes.position.count);
    expect(figure.poses.drinks.skin.position).not.toEqual(figure.poses.waits.skin.position);
    expect(figure.poses.thanks.skin.position).not.toEqual(figure.poses.waits.skin.position);
  });

  // In low quality the counter is part of the background, which hides nothing below it.
  it('stays above the counter and inside its space', () => {
    for (const pose of POSES) {
      for (const stuff of STUFFS) {
        const at = figure.poses[pose][stuff].position;
        for (let i = 0; i < at.length; i += 3) {
          expect(Math.abs(at[i])).toBeLessThan(ROOM.side_m);
          expect(at[i + 1]).toBeGreaterThan(0);
          expect(at[i + 1]).toBeLessThan(ROOM.top_m);
          expect(at[i + 2]).toBeGreaterThan(-ROOM.back_m);
          expect(at[i + 2]).toBeLessThan(ROOM.front_m);
        }
      }
    }
  });

  it('has few triangles in low quality', () => {
    expect(triangles(figure)).toBeLessThan(7_500);
    expect(triangles(made(guest, 1))).toBeLessThan(26_000);
  });

  it('has triangles that face like their normals', () => {
    for (const stuff of STUFFS) expect(facing(figure.geometry[stuff])).toBeGreaterThan(0.97);
  });
});

/** The share of the triangles that face like the normal of their first corner. */
function facing({ attributes: { position: p, normal: n }, index }: BufferGeometry): number {
  let all = 0, right = 0;
  for (let i = 0; i < index!.count; i += 3) {
    const [a, b, c] = [0, 1, 2].map((k) => index!.getX(i + k));
    const [ux, uy, uz] = [p.getX(b) - p.getX(a), p.getY(b) - p.getY(a), p.getZ(b) - p.getZ(a)], [vx, vy, vz] = [p.getX(c) - p.getX(a), p.getY(c) - p.getY(a), p.getZ(c) - p.getZ(a)];
    const [x, y, z] = [uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx], area = Math.hypot(x, y, z);
    if (area < 1e-9) continue;   // a degenerate triangle at a pole
    all += 1;
    if (x * n.getX(a) + y * n.getY(a) + z * n.getZ(a) > 0) right += 1;
  }
  return right / all;
}
