// The position of the dispensers in the picture: they overlap neither the recipe nor the strip (game.css), on every
// screen, for either hand.
import { PerspectiveCamera, Vector3 } from 'three';
import { describe, expect, it } from 'vitest';
import { placeCamera, turnOf, unitOf } from '../src/scene/camera';
import { freeAcross } from '../src/exercises/cocktail_bar/guest';
import { COUNTER, WALL } from '../src/scene/stage';
import { outlineOf } from '../src/exercises/cocktail_bar/outline';
import type { Bar } from '../src/exercises/cocktail_bar/bar';

/** The bar of config/scenes/cocktail-bar.toml: dispensers 128 mm apart, counted from the right; the row slides by up to three distances. */
const COUNTER_M = -0.253, RAIL_M = 0.128, ROW_M = 0.119, FIRST_M = -0.023, APART_M = 0.128;
const row = (count: number) => Array.from({ length: count }, (_, i) => ({ name: `d${i}`, y: FIRST_M + APART_M * i }));
const bar = (count: number, side: number, slid = 0) => ({ row_y_m: [side * (FIRST_M - slid * APART_M), side * FIRST_M], dispensers: row(count).map(({ name }) => ({ body: name })), glass: { radius_m: 0.03 }, counter_z_m: COUNTER_M, rail_z_m: RAIL_M }) as unknown as Bar;
const bodies = (count: number, side: number) => row(count).map(({ name, y }) => ({ name, positionM: { x: ROW_M, y: side * y, z: 0.004 } }));

/** The area free of cards at 1280 × 800 and at a width of 740, in the unit u of game.css. */
function free(width: number, height: number) {
  if (width / height <= 1.1) { const u = width / 740; return { left: 0, right: width, top: 256 * u, bottom: height - Math.max(190 * u, 112 * u + 78) }; }
  const u = Math.min(width / 1280, height / 800);
  return { left: 336 * u, right: width, top: 0, bottom: height - Math.max(104 * u, 80) };
}

function drawn(count: number, right: boolean, width: number, height: number, slid = 0, view: 'game' | 'console' = 'game') {
  const camera = new PerspectiveCamera(), side = right ? 1 : -1, all = bodies(count, side);
  const outline = outlineOf(bar(count, side, slid), { bodies: all } as never, { bodies: all } as never);
  placeCamera(camera, view, { right, counter_y: COUNTER_M, row_z: -ROW_M }, outline, width, height);
  camera.updateMatrixWorld(true);
  const pixel = (p: Vector3) => { const v = p.clone().project(camera); return { x: (v.x * 0.5 + 0.5) * width, y: (0.5 - v.y * 0.5) * height }; };
  return { outline: outline.map(pixel), pixel, camera };
}

describe('the row of dispensers', () => {
  for (const [width, height] of [[1280, 800], [1920, 1080], [1024, 768], [800, 1280], [390, 844], [2560, 1080]]) {
    for (const count of [1, 2, 3, 4]) {
      for (const right of [true, false]) {
        it(`of ${count} is clear of the cards, ${width} × ${height}, ${right ? 'right' : 'left'} hand`, () => {
          const at = free(width, height);
          for (const p of drawn(count, right, width, height, count - 1).outline) {
            expect(p.x).toBeGreaterThanOrEqual(at.left);
            expect(p.x).toBeLessThanOrEqual(at.right);
            expect(p.y).toBeGreaterThanOrEqual(at.top);
            expect(p.y).toBeLessThanOrEqual(at.bottom);
          }
        });
      }
    }
  }

  it.each([[574, 267], [315, 176], [900, 320], [700, 600]])('is whole in the console, %i × %i, and fills its height or width', (width, height) => {
    for (const [count, right] of [[1, true], [4, true], [1, false], [4, false]] as const) {
      const { outline } = drawn(count, right, width, height, count - 1, 'console');
      const xs = outline.map((p) => p.x), ys = outline.map((p) => p.y);
      expect([Math.min(...xs) >= 0, Math.max(...xs) <= width, Math.min(...ys) >= 0, Math.max(...ys) <= height]).toEqual([true, true, true, true]);
      if (count === 4) expect(Math.max((Math.max(...xs) - Math.min(...xs)) / width, (Math.max(...ys) - Math.min(...ys)) / height)).toBeGreaterThan(0.9);
    }
  });

  it('of one dispenser is in its designed place: beside the card, as large as possible', () => {
    const { outline } = drawn(1, true, 1280, 800);
    const middle = outline.reduce((sum, p) => sum + p.x, 0) / outline.length;
    expect(middle).toBeGreaterThan(640);
    expect(middle).toBeLessThan(860);
  });
});

describe('a left hand', () => {
  it('gives the mirror image of a right hand\'s picture about the middle of the free part', () => {
    const left = drawn(2, false, 800, 1280), right = drawn(2, true, 800, 1280);
    const width = (all: { x: number }[]) => Math.max(...all.map((p) => p.x)) - Math.min(...all.map((p) => p.x));
    expect(width(left.outline)).toBeCloseTo(width(right.outline), 9);
    const ahead = (way: ReturnType<typeof drawn>) => way.pixel(new Vector3(0, 0, -0.4)).x - way.pixel(new Vector3(0, 0, 0)).x;
    expect(ahead(left)).toBeCloseTo(-ahead(right), 9);   // the direction away from the person is mirrored in the picture
  });
});

/** A point of the room, which is placed at the row and faces the camera (stage.ts). */
const ofRoom = (right: boolean, x: number, y: number, z: number) =>
  new Vector3(x, y, z).applyAxisAngle(new Vector3(0, 1, 0), turnOf(right)).add(new Vector3(0, COUNTER_M, -ROW_M));

const SCREENS = [[1280, 800], [1920, 1080], [1024, 768], [768, 1024], [390, 844], [320, 900], [2560, 1080], [3840, 1080], [844, 390]] as const;

describe.each([true, false])('the room, right hand %s', (right) => {
  it.each(SCREENS)('has a level horizon at %i × %i', (width, height) => {
    const { pixel, camera } = drawn(4, right, width, height, 3);
    const edge = [-1, 0, 1].map((x) => pixel(ofRoom(right, x, 0, WALL.front_z)).y);   // the edge between wall and counter
    expect(Math.max(...edge) - Math.min(...edge)).toBeLessThan(0.5);
    const far = [-1, 0, 1].map((x) => pixel(camera.position.clone().add(new Vector3(x * 1e4, 0, -2e4))).y);   // the true horizon, at eye height
    expect(Math.max(...far) - Math.min(...far)).toBeLessThan(0.5);
  });

  it.each(SCREENS)('fills the picture at %i × %i', (width, height) => {
    for (const [count, slid] of [[1, 0], [4, 3]]) {
      const { pixel } = drawn(count, right, width, height, slid);
      const corner = (x: number, y: number) => pixel(ofRoom(right, x * WALL.width_m / 2, y, WALL.front_z));
      const [left, rightmost] = [corner(-1, WALL.height_m), corner(1, WALL.height_m)];
      expect(left.x).toBeLessThanOrEqual(0);
      expect(rightmost.x).toBeGreaterThanOrEqual(width);
      expect(left.y).toBeLessThanOrEqual(0);
      // The strip covers the lower part; the counter's near edge and its dark front may extend there.
      const front = [-1, 1].map((x) => pixel(ofRoom(right, x * WALL.width_m / 2, -COUNTER.front_m, COUNTER.edge_z)));
      const near = [-1, 1].map((x) => pixel(ofRoom(right, x * WALL.width_m / 2, 0, COUNTER.edge_z)));
      const bottom = free(width, height).bottom;
      expect(Math.min(...front.map((p) => p.y))).toBeGreaterThanOrEqual(bottom);
      expect(Math.min(near[0].x, near[1].x)).toBeLessThanOrEqual(0);
      expect(Math.max(near[0].x, near[1].x)).toBeGreaterThanOrEqual(width);
    }
  });
});

describe('the guest', () => {
  it.each(SCREENS)('stands clear of the praise card and of the bottles at %i × %i', (width, height) => {
    for (const right of [true, false]) {
      for (const count of [1, 2, 4]) {
        const { camera } = drawn(count, right, width, height, count - 1);
        const bottles = bodies(count, right ? 1 : -1).map(({ positionM: p }) => new Vector3(-p.y, p.z, -p.x));
        const across = freeAcross(camera, right, bottles, true), card_px = 524 * unitOf(width, height);
        // The card is on the left of a right hand's picture, and on the right of a left hand's.
        if (width / height > 1.1) expect(right ? across * width : (1 - across) * width).toBeGreaterThanOrEqual(card_px);
        const px = bottles.map((p) => p.clone().project(camera).x * 0.5 + 0.5);
        expect(Math.min(...px.map((x) => Math.abs(x - across)))).toBeGreaterThan(0.03);
      }
    }
  });

  // The resting hand is a finger's length in front of the first bottle, on the arm's side (the start of every reach).
  it.each([[390, 844], [768, 1024], [320, 900]])('waits beside the only bottle, away from the arm, at %i × %i', (width, height) => {
    for (const right of [true, false]) {
      const { camera } = drawn(1, right, width, height);
      const bottle = bodies(1, right ? 1 : -1).map(({ positionM: p }) => new Vector3(-p.y, p.z, -p.x));
      const [across, at] = [freeAcross(camera, right, bottle), bottle[0]!.clone().project(camera).x * 0.5 + 0.5];
      expect(right ? across < at : across > at).toBe(true);
    }
  });
});
