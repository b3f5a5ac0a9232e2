// What a device shows follows from the state alone: powder and juice grow with the done share, in the states that the program told a page.
// @vitest-environment happy-dom
import { Box3, Vector3, type Object3D } from 'three';
import { expect, it } from 'vitest';
import { applianceOf } from '../src/exercises/kitchen/appliances';
import { Workshop, makePiece } from '../src/exercises/kitchen/furniture';
import { KitchenView } from '../src/exercises/kitchen/kitchen_view';
import { doneShare, taskOf } from '../src/exercises/kitchen/task';
import { toldExercises } from './told_exercises';

const TOLD = toldExercises().filter(({ scene }) => taskOf(scene));
const DEVICES = TOLD.filter(({ name }) => ['coffee-mill', 'press-lever', 'flip-top-lid'].includes(name));

/** Extent of the visible objects. */
function visibleSize(root: Object3D): Vector3 {
  root.updateWorldMatrix(true, true);
  const box = new Box3();
  root.traverseVisible((one) => { if ('isMesh' in one) box.expandByObject(one, true); });
  return box.getSize(new Vector3());
}

it.each(DEVICES)('$name, right hand $right: a model of its own, about as large as the bodies that are touched', ({ scene }) => {
  const task = taskOf(scene)!, shop = new Workshop('low'), device = applianceOf(task.name, scene.rightHand, shop)!;
  const modelled = scene.bodies.filter((body) => device.model(body));
  expect(modelled.map(({ name }) => String(name)).sort()).toEqual(scene.bodies.map(({ name }) => String(name)).filter((name) => name !== 'worktop').sort());
  for (const body of modelled.filter(({ fixed }) => !fixed)) {
    const model = visibleSize(device.model(body)!), shapes = visibleSize(makePiece(body, shop));
    for (const axis of ['x', 'y', 'z'] as const) expect(Math.abs(model[axis] - shapes[axis]), `${body.name} along ${axis}`).toBeLessThan(0.025);
  }
});

it.each(TOLD)('$name, right hand $right: the done share grows from 0 to 1 along the steps', ({ scene }) => {
  const task = taskOf(scene)!, { steps } = task, shares: number[] = [];
  let q = 0;
  steps.forEach(({ verb, to, for_s = 1 }, i) => {
    for (const part of [0, 0.5, 1]) shares.push(doneShare(task, i, verb === 'move' ? q + part * (to! - q) : q, verb === 'press' ? part * for_s : 0));
    if (verb === 'move') q = to!;
  });
  shares.push(doneShare(task, steps.length, q, 0));
  expect(shares[0]).toBe(0);
  expect(shares.at(-1)).toBe(1);
  shares.slice(1).forEach((share, i) => expect(share).toBeGreaterThanOrEqual(shares[i]! - 1e-12));
});

it.each(DEVICES.filter(({ name }) => name !== 'flip-top-lid'))('$name, right hand $right: shows more when more is done, and the same in any order', ({ scene, states }) => {
  const task = taskOf(scene)!, now = scene.valueNames.map(String).indexOf('instruction'), playing = states.filter(({ links }) => links.length > 0);
  const shown = (view: KitchenView, step: number): string => {
    const state = { ...playing[0]!, values: playing[0]!.values.map((value, i) => (i === now ? step : value)) };
    view.placement(state as never);
    view.update(state as never, new Vector3());
    const seen: string[] = [];
    view.root.traverseVisible((one) => { if ('isMesh' in one) seen.push(one.matrixWorld.toArray().map((x) => x.toFixed(6)).join()); });
    view.root.updateMatrixWorld(true);
    return seen.join(';');
  };
  const there = new KitchenView(task, scene, 'low'), back = new KitchenView(task, scene, 'low');
  const all = task.steps.map((_, step) => { shown(there, step); return shown(there, step); });
  expect(task.steps.map((_, i) => { const step = task.steps.length - 1 - i; shown(back, step); return shown(back, step); }).reverse()).toEqual(all);
  expect(new Set(all).size).toBeGreaterThan(task.steps.filter(({ verb }) => verb === 'move' || verb === 'press').length - 1);
});
