import { expect, it } from 'vitest';
import { LabelPlaces } from '../src/shared/label_places';

it('labels stand beside their lines, inside the row, and never over each other', () => {
  const gap = 5, row = 600, places = new LabelPlaces(row, gap), put: [left: number, right: number][] = [[8, 60]];
  places.cover(8, 60);
  for (let i = 0; i < 400; i += 1) {
    const x = (i * 7919) % row, width = 10 + (i * 31) % 90, left = places.place(x, width);
    if (left === undefined) continue;
    expect([x + gap, x - gap - width]).toContain(left);
    expect(left + width).toBeLessThanOrEqual(row);
    for (const [from, to] of put) expect(left >= to + gap || left + width <= from - gap, `${left} over ${from} .. ${to}`).toBe(true);
    put.push([left, left + width]);
  }
  expect(put.length).toBeGreaterThan(4);
});

it('five losses of the controls within the width of one label have one label', () => {
  const places = new LabelPlaces(800, 5);
  expect([100, 108, 116, 124, 132].map((x) => places.place(x, 78) !== undefined)).toEqual([true, false, false, false, false]);
  expect(places.place(700, 120)).toBe(575);   // at the end of the row it stands before its line
});
