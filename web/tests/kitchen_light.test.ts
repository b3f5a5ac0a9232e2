// The lamp above the light switch follows the switch, in the states that the program told a page.
// @vitest-environment happy-dom
import { Vector3 } from 'three';
import { expect, it } from 'vitest';
import { KitchenView } from '../src/exercises/kitchen/kitchen_view';
import { isOn, switchOf, taskOf } from '../src/exercises/kitchen/task';
import { toldExercises } from './told_exercises';

const TOLD = toldExercises();

it.each(TOLD.filter(({ name }) => name === 'light-switch'))('is lit while the switch is on, right hand: $right', ({ scene, states }) => {
  const task = taskOf(scene)!, view = new KitchenView(task, scene, 'low'), q = scene.valueNames.map(String).indexOf('joint_q');
  const playing = states.filter(({ values }) => values.length > q), shown = playing.map((state) => {
    view.placement(state);
    view.update(state, new Vector3());
    return view.root.getObjectByName('light')!.visible;
  });
  expect(shown).toEqual(playing.map(({ values }) => isOn(switchOf(task)!, values[q]!)));
  expect(new Set(shown)).toEqual(new Set([false, true]));
});

it('hangs in no other kitchen', () => {
  for (const { name, scene, states } of TOLD) {
    const task = taskOf(scene);
    if (!task || name === 'light-switch') continue;
    const view = new KitchenView(task, scene, 'low');
    view.placement(states.at(-1));
    expect(view.root.getObjectByName('light'), name).toBeUndefined();
  }
});
