// A made-up scene of the kitchen for tests and pictures: a drawer with a vertical bar, or a door with one.
import { BodyT, PanelT, PanelValueT, PoseT, QuatXyzwT, SceneT, ShapeT, ShapeType, Vec3T, WordsT, WorldStateT } from '../src/protocol';

type Triple = readonly [number, number, number];
const vec = (v: Triple): Vec3T => new Vec3T(...v);
const pose = (at: Triple, q: readonly [number, number, number, number] = [0, 0, 0, 1]): PoseT => new PoseT(vec(at), new QuatXyzwT(...q));
const box = (size: Triple, at: Triple = [0, 0, 0]): ShapeT => new ShapeT(ShapeType.Box, vec([size[0] / 2, size[1] / 2, size[2] / 2]), 0, 0, [], [], pose(at));
const rod = (radius_m: number, length_m: number, at: Triple, alongX = false): ShapeT =>
  new ShapeT(ShapeType.Cylinder, vec([0, 0, 0]), radius_m, length_m, [], [], pose(at, alongX ? [0, Math.SQRT1_2, 0, Math.SQRT1_2] : [0, 0, 0, 1]));

export const VALUES = ['instruction', 'step', 'steps', 'score', 'done', 'paused', 'joint_q', 'goal_low', 'goal_high', 'handle_n', 'squeeze_n', 'held_s', 'time_s'];

const both = { joint: { body: 1, least: 0 }, shut: [0.155, 0.04, 0] as Triple };
export const DRAWER = {
  kind: 'kitchen', task: 'drawer',
  steps: [
    { verb: 'reach', body: 1 }, { verb: 'take', body: 1 }, { verb: 'move', body: 1, to: 0.1, tolerance: 0.01 },
    { verb: 'hold', body: 1, to: 0.1, tolerance: 0.01, for_s: 2 }, { verb: 'move', body: 1, to: 0, tolerance: 0.01 }, { verb: 'let_go', body: 1 },
  ],
  joints: [{ ...both.joint, type: 'slide', axis: [-1, 0, 0], point_m: [0, 0, 0], most: 0.12 }],
};
/** Its hinge is 0.12 m beside the handle. */
export const DOOR = {
  ...DRAWER, task: 'door', steps: DRAWER.steps.map((step) => ('to' in step && step.to ? { ...step, to: 0.9 } : step)),
  joints: [{ ...both.joint, type: 'hinge', axis: [0, 0, 1], point_m: [0.165, -0.08, 0], most: 1.05 }],
};

export function kitchenScene(task: object = DRAWER, right = true): SceneT {
  const scene = new SceneT();
  scene.exerciseJson = JSON.stringify(task);
  scene.rightHand = right;
  scene.bodies = [
    new BodyT('cabinet', true, '#E9DFCC', [box([0.3, 0.34, 0.18])]),
    new BodyT('front', false, '#8FB0A0', [box([0.02, 0.3, 0.14]), rod(0.0125, 0.12, [-0.055, 0, 0]), rod(0.006, 0.033, [-0.0265, 0, 0.045], true), rod(0.006, 0.033, [-0.0265, 0, -0.045], true)]),
  ];
  scene.valueNames = VALUES;
  scene.eventNames = ['step_done', 'level_done', 'restarted'];
  const words = (en: string): WordsT => new WordsT(en, `${en} fr`, `${en} de`);
  scene.panel = new PanelT(words('A drawer'), words('Open it and shut it again.'), DRAWER.steps.map((_, i) => words(`Do step ${i}`)).concat(words('All done')), [
    new PanelValueT('joint_q', words('Opened'), 'cm', 100, 1, 0, 0.12, 'goal_low', 'goal_high', false),
    new PanelValueT('score', words('Score'), '1', 1, 0, 0, 100, '', '', true),
  ], []);
  return scene;
}

/** The state at a step, with the joint at q. */
export function kitchenState(now: Readonly<Record<string, number>>, task: object = DRAWER): WorldStateT {
  const state = new WorldStateT(), q = now.joint_q ?? 0, [x, y, z] = both.shut;
  state.values = VALUES.map((name) => now[name] ?? 0);
  const front = task === DOOR
    // Turned about (0.165, -0.08) by q, to the left.
    ? pose([0.165 + (x - 0.165) * Math.cos(q) - (y + 0.08) * Math.sin(q), -0.08 + (x - 0.165) * Math.sin(q) + (y + 0.08) * Math.cos(q), z], [0, 0, Math.sin(q / 2), Math.cos(q / 2)])
    : pose([x - q, y, z]);
  state.bodies = [pose([0.315, y, z]), front];
  state.links = [];
  return state;
}
