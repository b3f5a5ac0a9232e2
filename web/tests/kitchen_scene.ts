// A synthetic kitchen scene for tests and pictures: a drawer with a vertical bar, or a door with one.
import { BodyT, PanelT, PanelValueT, PoseT, QuatXyzwT, SceneT, ShapeT, ShapeType, Vec3T, WordsT, WorldStateT } from '../src/protocol';

type Triple = readonly [number, number, number];
const vec = (v: Triple): Vec3T => new Vec3T(...v);
const pose = (at: Triple, q: readonly [number, number, number, number] = [0, 0, 0, 1]): PoseT => new PoseT(vec(at), new QuatXyzwT(...q));
const box = (size: Triple, at: Triple = [0, 0, 0]): ShapeT => new ShapeT(ShapeType.Box, vec([size[0] / 2, size[1] / 2, size[2] / 2]), 0, 0, [], [], pose(at));
const rod = (radius_m: number, length_m: number, at: Triple, alongX = false): ShapeT =>
  new ShapeT(ShapeType.Cylinder, vec([0, 0, 0]), radius_m, length_m, [], [], pose(at, alongX ? [0, Math.SQRT1_2, 0, Math.SQRT1_2] : [0, 0, 0, 1]));

const FIXED: readonly { name: string; size: Triple; at: Triple; color: string }[] = [
  { name: 'worktop', size: [0.4, 0.9, 0.03], at: [0.355, 0.03, 0.102], color: '#D9B98C' },
  { name: 'left_side', size: [0.38, 0.02, 0.4], at: [0.365, 0.2, -0.113], color: '#E6D3B3' },
  { name: 'right_side', size: [0.38, 0.02, 0.4], at: [0.365, -0.14, -0.113], color: '#E6D3B3' },
  { name: 'lower_front', size: [0.018, 0.32, 0.23], at: [0.164, 0.03, -0.198], color: '#8FB0A0' },
];

export const VALUES = ['instruction', 'step', 'steps', 'score', 'done', 'paused', 'joint_q', 'goal_low', 'goal_high', 'handle_n', 'squeeze_n', 'held_s', 'time_s'];

/** Position of the bar's middle while the front is shut. */
const SHUT: Triple = [0.1, 0.03, 0.004];
/** Fronts and boards like those of config/scenes/drawer.toml: the first body is the movable one. */
export const DRAWER = {
  kind: 'kitchen', task: 'drawer',
  steps: [
    { verb: 'reach', body: 0 }, { verb: 'take', body: 0 }, { verb: 'move', body: 0, to: 0.1, tolerance: 0.01 },
    { verb: 'hold', body: 0, to: 0.1, tolerance: 0.02, for_s: 2 }, { verb: 'move', body: 0, to: 0, tolerance: 0.01 }, { verb: 'let_go', body: 0 },
  ],
  things: [{ body: 0, joint: { type: 'slide', axis: [-1, 0, 0], point_m: [0, 0, 0], least: 0, most: 0.12 } }],
};
/** The hinge is 0.12 m to the right of the bar, and 0.06 m behind it. The door turns towards the person and to the right. */
export const HINGE = { x: 0.16, y: -0.09 } as const;
export const DOOR = {
  ...DRAWER, task: 'door', steps: DRAWER.steps.map((step) => ('to' in step && step.to ? { ...step, to: 0.9 } : step)),
  things: [{ body: 0, joint: { type: 'hinge', axis: [0, 0, 1], point_m: [HINGE.x, HINGE.y, 0], least: 0, most: 1.05 } }],
};

/** The same front without a joint: it is put to the left, and pressed. */
export const PUT = {
  ...DRAWER, task: 'put', steps: [{ verb: 'put', body: 0, center_m: [0.06, 0.28, 0.02], half_size_m: [0.08, 0.18, 0.09] }, { verb: 'press', body: 0, force_n: 4, for_s: 1 }, { verb: 'let_go', body: 0 }], things: [{ body: 0 }],
};

export function kitchenScene(task: object = DRAWER, right = true): SceneT {
  const scene = new SceneT();
  scene.exerciseJson = JSON.stringify(task);
  scene.rightHand = right;
  const posts = [0.053, -0.053].map((z) => rod(0.006, 0.044, [0.033, 0, z], true));
  scene.bodies = [
    new BodyT('front', false, '#8FB0A0', [rod(0.0125, 0.12, [0, 0, 0]), ...posts, box([0.018, 0.32, 0.15], [0.064, 0, 0]),
      ...(task === DOOR ? [] : [box([0.22, 0.29, 0.008], [0.183, 0, -0.06]), box([0.22, 0.01, 0.08], [0.183, 0.14, -0.016]), box([0.22, 0.01, 0.08], [0.183, -0.14, -0.016])])]),
    ...FIXED.map(({ name, size, color }) => new BodyT(name, true, color, [box(size)])),
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

/** The state in a step, with the joint at q. */
export function kitchenState(now: Readonly<Record<string, number>>, task: object = DRAWER): WorldStateT {
  const state = new WorldStateT(), q = now.joint_q ?? 0, [x, y, z] = SHUT, dx = x - HINGE.x, dy = y - HINGE.y;
  state.values = VALUES.map((name) => now[name] ?? 0);
  const front = task === DOOR
    ? pose([HINGE.x + dx * Math.cos(q) - dy * Math.sin(q), HINGE.y + dx * Math.sin(q) + dy * Math.cos(q), z], [0, 0, Math.sin(q / 2), Math.cos(q / 2)])
    : pose([x - q, y, z]);
  state.bodies = [front, ...FIXED.map(({ at }) => pose(at))];
  state.links = [];
  return state;
}
