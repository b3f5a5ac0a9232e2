import { CylinderGeometry, Group, Matrix3, Matrix4, Quaternion, Vector3, type Mesh } from 'three';
import { describe, expect, it } from 'vitest';
import type { ContactPointT } from '../src/protocol';
import { ContactFilter } from '../src/scene/contacts';
import { Dent, depthIn } from '../src/scene/dent';
import { BubblesView } from '../src/exercises/cocktail_bar/bubbles';
import { barOf } from '../src/exercises/cocktail_bar/bar';
import { arrowsOf } from '../src/scene/force_arrows';
import { FrameClock } from '../src/scene/frame_clock';
import { programFrame, quaternionToThree, toThree } from '../src/scene/frames';
import { layersOf, lineHeight, surfaceHeight } from '../src/exercises/cocktail_bar/layers';
import { StreamView } from '../src/exercises/cocktail_bar/stream';
import { QualityChooser } from '../src/scene/quality';

describe('frames', () => {
  it('map away, left and up to −z, −x and y', () => {
    // By hand: three.js looks along −z, its x is right, its y is up.
    expect(toThree({ x: 1, y: 0, z: 0 }).toArray()).toEqual([-0, 0, -1]);
    expect(toThree({ x: 0, y: 1, z: 0 }).toArray()).toEqual([-1, 0, -0]);
    expect(toThree({ x: 0, y: 0, z: 1 }).toArray()).toEqual([-0, 1, -0]);
  });

  it('rotate a quarter turn about up alike: away becomes left', () => {
    const half = Math.SQRT1_2;   // of a quarter turn about z
    const turned = toThree({ x: 1, y: 0, z: 0 }).applyQuaternion(quaternionToThree({ x: 0, y: 0, z: half, w: half }));
    expect(turned.distanceTo(toThree({ x: 0, y: 1, z: 0 }))).toBeLessThan(1e-12);
  });

  it('agree with the matrix, which is a rotation', () => {
    const frame = programFrame(), p = { x: 0.3, y: -0.2, z: 0.7 };
    expect(new Vector3(p.x, p.y, p.z).applyMatrix4(frame).distanceTo(toThree(p))).toBeLessThan(1e-12);
    expect(new Matrix3().setFromMatrix4(frame).determinant()).toBeCloseTo(1, 12);
    const q = { x: 0.1, y: -0.5, z: 0.3, w: Math.sqrt(1 - 0.35) };
    const inside = new Matrix4().makeRotationFromQuaternion(new Quaternion(q.x, q.y, q.z, q.w));
    const outside = new Matrix4().makeRotationFromQuaternion(quaternionToThree(q));
    const conjugated = frame.clone().multiply(inside).multiply(frame.clone().invert());
    conjugated.elements.forEach((value, i) => expect(value).toBeCloseTo(outside.elements[i], 12));
  });
});

describe('layers', () => {
  const M_PER_L = 0.74, RIM = 0.1;

  it('are stacked, 0.74 mm per millilitre', () => {
    const layers = layersOf([0.04, 0.03, 0], ['blueberry', 'lemon', 'cherry'], M_PER_L, RIM);
    expect(layers.map((l) => l.liquid)).toEqual(['blueberry', 'lemon']);
    expect(layers[0].top_m).toBeCloseTo(0.0296, 12);   // 40 ml
    expect(layers[1].bottom_m).toBeCloseTo(0.0296, 12);
    expect(layers[1].top_m).toBeCloseTo(0.0518, 12);   // 70 ml
  });

  it('of the same liquid in sequence are merged', () => {
    expect(layersOf([0.02, 0.02], ['lemon', 'lemon'], M_PER_L, RIM)).toHaveLength(1);
  });

  it('never rise above the rim', () => {
    expect(surfaceHeight([0.1, 0.1], M_PER_L, RIM)).toBe(RIM);
    expect(layersOf([0.1, 0.1], ['lemon', 'cherry'], M_PER_L, RIM)[1].top_m).toBe(RIM);
  });

  it('have the fill line at the asked amount, whatever was poured of it', () => {
    expect(lineHeight([0.04, 0.012, 0], 1, 0.03, M_PER_L, RIM)).toBeCloseTo(0.07 * M_PER_L, 12);
  });
});

describe('an exercise', () => {
  it('of another kind, without a description, or invalid, is not a bar', () => {
    for (const exerciseJson of [null, '', '{', '{"kind":"free_grasping"}', '{"kind":"cocktail_bar"}'])
      expect(barOf({ exerciseJson })).toBeUndefined();
  });
});

describe('contacts', () => {
  const contact = (capsule: number, force: number) =>
    ({ capsule, body: 1, pointM: { x: 0, y: 0, z: 0 }, forceN: { x: force, y: 0, z: 0 } }) as unknown as ContactPointT;

  it('of one capsule are summed and low-passed with 5 Hz', () => {
    const filter = new ContactFilter();
    filter.take([contact(3, 2), contact(3, 4)]);
    filter.advance(1 / (2 * Math.PI * 5));   // one time constant
    expect(filter.strongest()).toHaveLength(1);
    expect(filter.strongest()[0].force_n).toBeCloseTo(6 * (1 - Math.exp(-1)), 12);
  });

  it('that end fade out and are removed', () => {
    const filter = new ContactFilter();
    filter.take([contact(3, 5)]);
    filter.advance(1);
    filter.take([]);
    filter.advance(1 / (2 * Math.PI * 5));
    expect(filter.strongest()[0].force_n).toBeCloseTo(5 * Math.exp(-1), 6);
    filter.advance(1);
    expect(filter.strongest()).toHaveLength(0);
  });
});

describe('dents', () => {
  // A finger of 8 mm across a bottle of 25 mm, 1 mm deep: the distance of their axes is 32 mm.
  const finger = { a: new Vector3(0.032, 0, -0.02), b: new Vector3(0.032, 0, 0.02), radiusA: 0.008, radiusB: 0.008 };

  it('follow the depth of the finger, and vanish when it leaves', () => {
    const bottle = new CylinderGeometry(0.025, 0.025, 0.1, 96, 20, true), at = bottle.attributes.position, dent = new Dent(bottle, 0.025);
    const nearest = () => Math.min(...Array.from({ length: at.count }, (_, i) => (at.getX(i) > 0 && Math.abs(at.getY(i)) < 1e-6 && Math.abs(at.getZ(i)) < 1e-6 ? at.getX(i) : 1)));
    expect(nearest()).toBeCloseTo(0.025, 6);
    dent.update([finger]);
    expect(nearest()).toBeCloseTo(0.024, 5);
    for (let i = 0; i < at.count; i++) expect(depthIn([finger], at.getX(i), at.getY(i), at.getZ(i))).toBeLessThan(5e-5);
    dent.update([]);
    expect(nearest()).toBeCloseTo(0.025, 6);
    // A wall that lost its content stays dented without the finger, and returns with the air: half of 1 mm, then completely.
    dent.update([finger]);
    dent.update([], 1);
    expect(nearest()).toBeCloseTo(0.024, 5);
    dent.update([], 0.5);
    expect(nearest()).toBeCloseTo(0.0245, 5);
    dent.update([], 0);
    expect(nearest()).toBeCloseTo(0.025, 6);
    // The whole wall is narrower in its middle, not at its ends: a tenth of 25 mm.
    const ends = () => Math.max(...Array.from({ length: at.count }, (_, i) => (at.getY(i) > 0.0499 ? at.getX(i) : 0)));
    dent.update([], 0, 0.1);
    expect([nearest(), ends()].map((x) => Number(x.toFixed(5)))).toEqual([0.0225, 0.025]);
    dent.update([]);
    expect(nearest()).toBeCloseTo(0.025, 6);
  });
});

describe('the stream', () => {
  const from = { x: 0, y: 0.15, z: 0 }, none = { liquid: 'lemon', viscosity_pa_s: 0.157, flow_l_s: 0, from, floor_m: 0, overGlass: true, counter_m: 0, spilt_l: 0 };
  const THICK_PA_S = 0.643, TICK_S = 1 / 60;
  /** Simulates; returns the visible range of the stream from top to bottom [m], and its width. */
  function pour(view: StreamView, flow_l_s: number, long_s: number, viscosity_pa_s = 0.157): { top: number; bottom: number; wide: number; seen: boolean; drops: number } {
    for (let t_s = 0; t_s < long_s - 1e-9; t_s += TICK_S) view.update({ ...none, viscosity_pa_s, flow_l_s }, TICK_S);
    const [jet, , , ...drops] = view.root.children as [Mesh, Mesh, Mesh, ...Mesh[]];
    return { top: jet.position.y, bottom: jet.position.y - jet.scale.y, wide: jet.scale.x, seen: jet.visible, drops: drops.filter(({ visible }) => visible).length };
  }

  it('falls from the nozzle into the glass, and detaches when it ends', () => {
    const view = new StreamView('low');
    const begun = pour(view, 0.006, 0.05);
    expect([begun.seen, begun.top]).toEqual([true, 0.15]);
    expect(begun.bottom).toBeGreaterThan(0.05);
    expect(pour(view, 0.006, 0.5)).toMatchObject({ seen: true, top: 0.15, bottom: 0 });
    const ends = pour(view, 0, 0.05);
    expect(ends.top).toBeLessThan(0.12);
    expect(ends.bottom).toBeCloseTo(0, 12);
    expect(pour(view, 0, 0.2).seen).toBe(false);
  });

  it('ends in drops, which end too', () => {
    const view = new StreamView('low');
    expect(pour(view, 0.006, 0.5).drops).toBe(0);
    expect(pour(view, 0, 0.05).drops).toBe(1);
    expect(pour(view, 0, 2).drops).toBe(0);
    expect(pour(view, 0, 0.05).seen).toBe(false);
  });

  it('is wider with more flow, and of a thick liquid wider and slower than of a thin one', () => {
    const wide = (flow_l_s: number, viscosity_pa_s?: number) => pour(new StreamView('low'), flow_l_s, 1, viscosity_pa_s).wide;
    expect(wide(0.008)).toBeGreaterThan(1.3 * wide(0.003));
    expect(wide(0.004, THICK_PA_S)).toBeGreaterThan(1.15 * wide(0.004));
    expect(pour(new StreamView('low'), 0.004, 0.1, THICK_PA_S).bottom).toBeGreaterThan(pour(new StreamView('low'), 0.004, 0.1).bottom + 0.01);
  });
});

describe('air that returns into a bottle', () => {
  it('rises in it as bubbles on the visible side, and only while it returns', () => {
    const view = new BubblesView(), bottle = new Group(), eye = new Vector3(0, 0, 0.6);
    const d = { body: '', liquid: 'lemon', free: false, radius_m: 0.025, height_m: 0.2, nozzle_m: [0, 0, -0.109], grip_m: [0, 0, 0] } as const;
    bottle.position.set(0.1, 0.2, -0.3);
    const seen = () => view.root.children.filter(({ visible }) => visible);
    view.take(d, bottle, eye, -0.005);   // it is squeezed
    view.advance(0.1);
    expect(seen()).toHaveLength(0);
    view.take(d, bottle, eye, 0.003);    // 5 bubbles of 0.6 ml
    view.advance(0.1);
    expect(seen()).toHaveLength(5);
    const heights = seen().map(({ position }) => position.y);
    for (const { position } of seen()) expect(position.z).toBeGreaterThan(bottle.position.z);
    view.advance(0.2);
    seen().forEach(({ position }, i) => expect(position.y).toBeGreaterThan(heights[i]! + 0.02));
    view.advance(2);
    expect(seen()).toHaveLength(0);
  });
});

describe('quality', () => {
  it('falls when frames are slow for a second and a half, and stays low', () => {
    const chooser = new QualityChooser('high');
    expect(chooser.choose({ frame_ms: 80 }, 0)).toBe('high');
    expect(chooser.choose({ frame_ms: 80 }, 1400)).toBe('high');
    expect(chooser.choose({ frame_ms: 80 }, 1600)).toBe('low');
    expect(chooser.choose({ frame_ms: 5 }, 9000)).toBe('low');
  });

  it('is kept during a short stutter', () => {
    const chooser = new QualityChooser('high');
    chooser.choose({ frame_ms: 80 }, 0);
    chooser.choose({ frame_ms: 16 }, 1000);
    expect(chooser.choose({ frame_ms: 80 }, 2000)).toBe('high');
  });

  it('is measured by the median frame period and the 95th percentile of the script time', () => {
    const clock = new FrameClock();
    for (let i = 0; i < 60; i++) clock.add(i * 20, i % 10 === 0 ? 9 : 2);
    expect(clock.frame_ms).toBe(20);
    expect(clock.script_ms).toBe(9);
    clock.add(60 * 20 + 5000, 2);   // the page was hidden: not a frame of five seconds
    expect(clock.frame_ms).toBe(20);
  });
});

describe('arrows of forces', () => {
  const contact = (force: [number, number, number]): ContactPointT =>
    ({ capsule: 0, body: 0, pointM: { x: 1, y: 2, z: 3 }, forceN: { x: force[0], y: force[1], z: force[2] } }) as unknown as ContactPointT;

  it('start at the contact point, point along the force, and have a proportional length', () => {
    const [strong, weak] = arrowsOf([contact([0, 2, 0]), contact([0, 0, -4])]);
    expect(strong.from.toArray()).toEqual([1, 2, 3]);
    expect(strong.along.toArray()).toEqual([0, 0, -1]);
    expect(strong.length_m / weak.length_m, 'twice the force').toBeCloseTo(2, 9);
  });

  it('are absent for a weak contact, and limited in length', () => {
    expect(arrowsOf([contact([0, 0, 0]), contact([0.01, 0, 0])])).toEqual([]);
    expect(arrowsOf([contact([1000, 0, 0])])[0].length_m).toBeLessThan(0.2);
    expect(arrowsOf(Array.from({ length: 99 }, () => contact([1, 0, 0])))).toHaveLength(32);
  });
});
