// Kitchen tasks in the page: read from the scene message, without data on a specific task in the page.
import { Vector3 } from 'three';
import { describe, expect, it } from 'vitest';
import type { SceneT } from '../src/protocol';
import { playOf, targetsOf } from '../src/exercises';
import { infoOf, REPORTS } from '../src/exercises/info';
import { wayOf } from '../src/exercises/kitchen/cues';
import { moved, placedOf } from '../src/exercises/kitchen/joint';
import { KitchenPlay, shareOf } from '../src/exercises/kitchen/play';
import { toldExercises } from './told_exercises';
import { handleOf, isOn, jointOf, switchOf, taskOf } from '../src/exercises/kitchen/task';
import { Perceiver } from '../src/input/perceiver';
import { Pilot, type PilotInput } from '../src/input/pilot';
import { restingWish } from '../src/input/wish';
import { DOOR, DRAWER, HINGE, kitchenScene, kitchenState } from './kitchen_scene';

const STEPS = DRAWER.steps.length;

describe('the task', () => {
  it('is read from the scene, and from no other exercise', () => {
    expect(taskOf(kitchenScene())?.steps.map(({ verb }) => verb)).toEqual(['reach', 'take', 'move', 'hold', 'move', 'let_go']);
    const other = (json: string): unknown => taskOf({ ...kitchenScene(), exerciseJson: json } as SceneT);
    for (const json of ['', '{', 'null', '{"kind":"free_grasping"}', '{"kind":"kitchen"}']) expect(other(json)).toBeUndefined();
    expect(other('{"kind":"kitchen","steps":[{"verb":"dance","body":0}]}')).toBeUndefined();
    expect(other('{"kind":"kitchen","steps":[{"verb":"reach","body":99}]}')).toBeUndefined();
    expect(taskOf(null)).toBeUndefined();
  });

  it('has its longest bar as the handle', () => {
    expect(handleOf(kitchenScene().bodies[0]!)).toMatchObject({ at_m: { x: 0, y: 0, z: 0 }, radius_m: 0.0125, length_m: 0.12 });
  });
});

describe('a joint', () => {
  it('translates along its axis', () => {
    const joint = jointOf(taskOf(kitchenScene())!, 0)!, { at } = moved(placedOf(kitchenState({}).bodies[0])!, joint, 0.1);
    expect(at.distanceTo(new Vector3(0, 0.03, 0.004))).toBeLessThan(1e-12);
  });

  // A quarter turn to the left moves a point that is a to the left of the hinge and b in front of it to a in front and b to its right.
  it('rotates position and orientation about its axis', () => {
    const joint = jointOf(taskOf(kitchenScene(DOOR))!, 0)!, now = placedOf(kitchenState({}, DOOR).bodies[0])!, { at, turn } = moved(now, joint, Math.PI / 2);
    expect(at.x).toBeCloseTo(HINGE.x - (0.03 - HINGE.y), 12);
    expect(at.y).toBeCloseTo(HINGE.y + (0.1 - HINGE.x), 12);
    expect(new Vector3(1, 0, 0).applyQuaternion(turn).distanceTo(new Vector3(0, 1, 0))).toBeLessThan(1e-12);
  });

  it('matches the program\'s pose for any coordinate', () => {
    const joint = jointOf(taskOf(kitchenScene(DOOR))!, 0)!, from = placedOf(kitchenState({ joint_q: 0.2 }, DOOR).bodies[0])!, to = placedOf(kitchenState({ joint_q: 0.9 }, DOOR).bodies[0])!;
    expect(moved(from, joint, 0.7).at.distanceTo(to.at)).toBeLessThan(1e-12);
    expect(moved(from, joint, 0.7).turn.angleTo(to.turn)).toBeLessThan(1e-7);
  });

  it('that turns a full circle has an arrow of three quarters on a larger circle, which does not cover itself', () => {
    const joint = { type: 'hinge', axis: [0, 0, 1], point_m: [0.1, 0, 0], least: null, most: null } as const, now = placedOf(kitchenState({}).bodies[0])!;
    for (const way of [1, -1]) {
      const path = wayOf(now, joint, way * 2 * Math.PI, { x: 0, y: 0, z: 0 }), radius = 0.03, middle = path[0]!.clone().add(path[(path.length - 1) * 2 / 3]!).multiplyScalar(0.5);
      // The ends of a diameter are half a turn apart, the last point is a quarter turn before the first one.
      for (const p of path) expect(p.distanceTo(middle)).toBeCloseTo(2 * radius, 12);
      expect(path[0]!.distanceTo(path.at(-1)!)).toBeCloseTo(2 * radius * Math.SQRT2, 12);
    }
  });

  it('has an arrow that ends at the goal, however near that is', () => {
    const joint = jointOf(taskOf(kitchenScene())!, 0)!, now = placedOf(kitchenState({ joint_q: 0.09 }).bodies[0])!, way = wayOf(now, joint, 0.01, { x: 0, y: 0, z: 0.1 });
    // The bar is at 0.1 m when shut, 0 at the goal; three.js's z is towards the person.
    expect(way.at(-1)!.distanceTo(new Vector3(-0.03, 0.104, 0))).toBeLessThan(1e-12);
    expect(way[0]!.distanceTo(way.at(-1)!)).toBeCloseTo(0.1, 12);
    expect(way[0]!.z).toBeLessThan(way.at(-1)!.z);
  });
});

describe('the handle', () => {
  const scene = kitchenScene(), targets = targetsOf(scene);

  it('is the target until the task is done, and released in the last step', () => {
    const at = (instruction: number) => ({ wanted: targets.wanted(kitchenState({ instruction })), letGo: targets.letGo(kitchenState({ instruction })) });
    expect(at(0)).toEqual({ wanted: 0, letGo: false });
    expect(at(3)).toEqual({ wanted: 0, letGo: false });
    expect(at(5)).toEqual({ wanted: 0, letGo: true });
    expect(at(STEPS)).toEqual({ wanted: -1, letGo: true });
  });

  it('has the path of its joint, and none while it is only grasped', () => {
    expect(targets.awayFromUse!(kitchenState({ instruction: 1 }), 0)).toBeUndefined();
    expect(targets.awayFromUse!(kitchenState({ instruction: 2, joint_q: 0.03 }), 0)!.x).toBeCloseTo(-0.07, 12);
    expect(targets.awayFromUse!(kitchenState({ instruction: 4, joint_q: 0.08 }), 0)!.x).toBeCloseTo(0.08, 12);
  });

  it('of a door is led along its arc, not along the chord', () => {
    const way = targetsOf(kitchenScene(DOOR)).awayFromUse!(kitchenState({ instruction: 2 }, DOOR), 0)!, radius = Math.hypot(0.1 - HINGE.x, 0.03 - HINGE.y);
    // The chord of an arc of 2 cm.
    expect(Math.hypot(way.x, way.y, way.z)).toBeCloseTo(2 * radius * Math.sin(0.01 / radius), 12);
  });

  it('rotates with its body', () => {
    const links = [{ positionM: { x: 0, y: 0, z: 0 } }], shifted = kitchenScene(DOOR);
    for (const { inBody } of shifted.bodies[0]!.shapes) inBody!.positionM!.x -= 0.05;
    const seen = new Perceiver({ ...shifted, axes: [{ name: 'x' }, { name: 'y' }, { name: 'z' }], capsules: [] } as unknown as SceneT, targetsOf(shifted));
    const grip = (q: number) => seen.onState(Object.assign(kitchenState({ joint_q: q }, DOOR), { links, qM: [0, 0, 0], qS: [0, 0, 0] }) as never).grips[0]!;
    const bar = kitchenState({ joint_q: Math.PI / 2 }, DOOR).bodies[0]!.positionM!;
    // A point 0.05 m in front of the body is 0.05 m to its right after a quarter turn.
    expect(grip(Math.PI / 2).y - grip(0).y).toBeCloseTo(bar.y - 0.05 - 0.03, 12);
  });
});

describe('a pushed object', () => {
  // A rocker about a vertical axis through the body's frame: pushed 2 cm to its left, away from the person.
  const met = { means: 'push', toward: [1, 0, 0], side_m: [0, 0.02, 0], base_m: [-0.17, 0.01, -0.02] } as const;
  const task = {
    ...DRAWER, steps: [{ verb: 'reach', body: 0, met }, { verb: 'press', body: 0, force_n: 3, for_s: 0.5, met }, { verb: 'let_go', body: 0, met: { ...met, means: 'grasp' } }],
    things: [{ body: 0, grip_m: [-0.006, 0, 0], joint: { type: 'hinge', axis: [0, 0, -1], point_m: [0.1, 0.03, 0], least: 0, most: 0.4 } }],
  };
  const scene = Object.assign(kitchenScene(task), { parameters: [{ name: 'force_ratio' }] }) as unknown as SceneT, targets = targetsOf(scene);
  const at = (now: Readonly<Record<string, number>>) => Object.assign(kitchenState(now), { parameters: [0.5] });

  it('is touched at the point that the task states, also while it is released', () => {
    for (const instruction of [0, 1, 2]) expect(targets.met!(at({ instruction }), 0)).toEqual({ at_m: { x: -0.006, y: 0.02, z: 0 }, base_m: { x: -0.17, y: 0.01, z: -0.02 }, pushes: { x: 1, y: 0, z: 0 } });
    const seen = new Perceiver({ ...scene, axes: [{ name: 'x' }, { name: 'y' }, { name: 'z' }], capsules: [] } as unknown as SceneT, targets);
    const grip = seen.onState(Object.assign(at({ instruction: 1 }), { links: [{ positionM: { x: 0, y: 0, z: 0 } }], qM: [0, 0, 0], qS: [0, 0, 0], contacts: [] }) as never).grips[0]!;
    expect([grip.x, grip.y, grip.z].map((v) => v.toFixed(9))).toEqual([0.1 - 0.006 - 0.17, 0.03 + 0.02 + 0.01, 0.004 - 0.02].map((v) => v.toFixed(9)));
  });

  it('needs the force of the live parameter, which its meter shows too', () => {
    expect(targets.zone!(at({ instruction: 1 })).low).toBeCloseTo(1.1 * 1.5, 12);
    const play = playOf(scene, null)!, meter = (handle_n: number) => play.meter(at({ instruction: 1, handle_n }))!;
    expect([meter(0.75).value, meter(0.75).zone, meter(1.5).value, meter(1.5).zone]).toEqual([0.25, 'low', 0.5, 'right']);
  });
});

describe('the light', () => {
  const told = toldExercises(), taskIn = (name: string) => taskOf(told.find((one) => one.name === name)!.scene)!;

  it('is on while the switch is nearer to on, for the switch as it ships', () => {
    const light = switchOf(taskIn('light-switch'))!;
    expect(light.on).toBeGreaterThan(light.off);
    expect([light.off, light.on, 0.4 * light.on, 0.6 * light.on].map((q) => isOn(light, q))).toEqual([false, true, false, true]);
  });

  it('belongs to no other task', () => {
    for (const name of ['drawer', 'cupboard-door', 'coffee-mill', 'press-lever']) expect(switchOf(taskIn(name)), name).toBeUndefined();
  });
});

describe('console, replay and report', () => {
  it('show the step, the force at the handle and the time', () => {
    const info = infoOf(kitchenScene()), value = (name: string) => ({ instruction: 2, handle_n: 3.46, time_s: 12.34 })[name];
    expect([info.progress(value), info.caption(value)]).toEqual(['2 of 6 done', 'Move · Force 3.5 N · 12.3 s']);
    expect(info.caption((name) => (name === 'instruction' ? STEPS : 0))).toBe('Force 0.0 N · 0.0 s');
  });

  it('list the finished tasks, the person\'s first', () => {
    const part = (persons: boolean, value: number) => ({ event: 'level_done', index: -1, value, to_s: 20, persons, steps: [[0, 100], [1, 100]] as const });
    const of = (scene: SceneT | undefined) => REPORTS.map((report) => report.table({ parts: [part(false, 90), part(true, 80)], sums: {}, scene }, (t) => `${t} s`, ({ persons }) => (persons ? 'own' : 'shown'))).filter(Boolean);
    expect(of(kitchenScene())).toEqual([expect.objectContaining({ title: 'Tasks done', rows: [['A drawer', '2 / 6', '80', '20 s', 'own'], ['A drawer', '2 / 6', '90', '20 s', 'shown']] })]);
    expect(of(undefined)).toEqual([]);
  });
});

describe('the sound', () => {
  it('slides with the handle\'s speed, and knocks once at the end of its joint', () => {
    const play = playOf(kitchenScene(), null)!, rates: number[] = [], knocks: number[] = [];
    // 0.1 m/s to the end at 0.12 m, then at rest.
    for (let i = 0; i < 20; i++) {
      const state = Object.assign(kitchenState({ instruction: 2, joint_q: Math.min(0.12, 0.01 * i) }), { timeS: 0.1 * i });
      play.follow(state);
      rates.push(play.flow(state).rate);
      if (play.takeChime!()) knocks.push(i);
    }
    expect(rates[5]).toBeCloseTo(0.1 / 0.15, 9);
    expect(rates.at(-1)).toBe(0);
    expect(knocks).toEqual([13]);
  });
});

describe('help', () => {
  const sight: PilotInput = {
    hand: { x: 0, y: 0, z: 0 }, aim: { x: 0, y: 0, z: 0 }, back_m: -0.08, grips: [{ x: 0, y: 0, z: 0 }], awayFromUse: [{ x: -0.1, y: 0, z: 0 }], onJoint: true,
    squeeze_n: 4, squeezeLow_n: 2, beside: 1, target: 0, reachable: () => true, closed: true, letGo: false,
  };

  it('moves a held handle along its joint, does not lift it, and lets go at the end', () => {
    const pilot = new Pilot();
    pilot.steer({ ...restingWish(), squeeze: true }, { ...sight, awayFromUse: [undefined] }, 'full', 0.01);
    const pulls = pilot.steer({ ...restingWish(), squeeze: true }, sight, 'full', 0.01).wish;
    expect(pulls.velocity.x).toBeLessThan(-0.03);
    expect([pulls.velocity.y, pulls.velocity.z, pulls.squeeze]).toEqual([0, 0, true]);
    expect(pilot.steer({ ...restingWish(), squeeze: true }, { ...sight, letGo: true, awayFromUse: [undefined] }, 'full', 0.01).wish.squeeze).toBe(false);
  });

  it('does not pull without help', () => {
    expect(new Pilot().steer({ ...restingWish(), squeeze: true }, sight, 'none', 0.01).wish.velocity.x).toBe(0);
  });
});

describe('the game', () => {
  const play = playOf(kitchenScene(), null)!;
  const at = (now: Readonly<Record<string, number>>) => {
    const state = kitchenState(now);
    play.follow(state);
    return state;
  };

  it('shows the task\'s own texts, and rows for the steps around the present one', () => {
    expect(play).toBeInstanceOf(KitchenPlay);
    const state = at({ instruction: 2, joint_q: 0.05 }), card = play.card(state)!;
    expect([play.prompt(state, false).title, card.title]).toEqual(['Do step 2', 'A drawer']);
    expect(card.steps.map(({ name, is }) => `${name} ${is}`)).toEqual(['Take hold done', 'Move now', 'Hold later']);
    expect(play.card(at({ instruction: 0 }))!.steps.map(({ name }) => name)).toEqual(['Reach', 'Take hold', 'Move']);
    expect(play.card(at({ instruction: 5 }))!.steps.map(({ name }) => name)).toEqual(['Hold', 'Move', 'Let go']);
    expect(card.count).toBe('2 of 6 done');
    expect(play.words.title()).toBe('A drawer');
  });

  it('shows the progress of a step in both directions', () => {
    const open = { verb: 'move', body: 0, to: 0.1 } as const;
    expect([shareOf(open, 0.05, 0, 0), shareOf(open, 0.2, 0, 0), shareOf({ ...open, to: 0 }, 0.02, 0.1, 0)].map((share) => share.toFixed(6))).toEqual(['0.500000', '1.000000', '0.800000']);
    expect(shareOf({ ...open, verb: 'hold', for_s: 2 }, 0.1, 0.1, 0.5)).toBe(0.25);
  });

  it('meters the joint\'s position while it has a goal, and never reports the way there as too much', () => {
    expect(play.meter(at({ instruction: 1 }))).toBeNull();
    const open = play.meter(at({ instruction: 2, joint_q: 0.06, goal_low: 0.09, goal_high: 0.11 }))!;
    expect(open).toMatchObject({ zone: 'low', label: 'Move' });
    expect([open.value, open.low, open.high].map((share) => share.toFixed(6))).toEqual(['0.500000', '0.750000', '0.916667']);
    expect(play.meter(at({ instruction: 3, joint_q: 0.1, goal_low: 0.09, goal_high: 0.11 }))!.zone).toBe('right');
    expect(play.meter(at({ instruction: 4, joint_q: 0.08, goal_low: -0.01, goal_high: 0.01 }))!.zone).toBe('low');
  });

  it('praises a finished task, and starts again after a restart', () => {
    const done = at({ instruction: STEPS, done: 1, score: 95 });
    expect([play.phase(done), play.donePrompt(done).title, play.praise(done, true)!.stars]).toEqual(['success', 'All done', 3]);
    expect(play.card(done)!.steps.every(({ is }) => is === 'done')).toBe(true);
    expect(play.follow(kitchenState({ instruction: 0 }))).toBe(true);
    expect(play.follow(kitchenState({ instruction: 1 }))).toBe(false);
  });
});
