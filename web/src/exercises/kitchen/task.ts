// A kitchen task as data: the content of its TOML file, from the scene message. Pure.
import type { BodyT, PoseT, SceneT, ShapeT, WorldStateT } from '../../protocol';
import { ShapeType } from '../../protocol';
import type { Position } from '../exercise';

export const VERBS = ['reach', 'take', 'move', 'hold', 'press', 'put', 'let_go'] as const;
export type Verb = (typeof VERBS)[number];

export interface KitchenStep {
  readonly verb: Verb;
  /** Index of the body in the scene. */
  readonly body: number;
  /** Goal of its joint [m or rad]. */
  readonly to?: number;
  readonly for_s?: number;
  /** The asked force [N], before the live parameter force_ratio. */
  readonly force_n?: number;
  /** Centre of the goal region, an axis-aligned box of the world. */
  readonly center_m?: Triple;
  readonly half_size_m?: Triple;
  readonly met?: ContactManner;
}

type Triple = readonly [number, number, number];

/** How the hand meets the body of a step: it closes around it, pushes it with straight fingers, or closes so that it moves towards the palm. */
export interface ContactManner {
  readonly means: 'grasp' | 'push' | 'squeeze';
  /** Direction of a push, in the world. */
  readonly toward: Triple;
  /** From the grip to the contact point, in the body's frame. */
  readonly side_m: Triple;
  /** Device coordinates of the hand minus the contact point. */
  readonly base_m: Triple;
}

/** A joint: a body slides along an axis, or turns about it. Axis and point: world, at the start. */
export interface Joint {
  readonly type: 'hinge' | 'slide';
  readonly axis: Triple;
  readonly point_m: Triple;
  readonly least: number | null;   // m or rad; null: no end
  readonly most: number | null;
}

export interface Thing { readonly body: number; readonly joint?: Joint; readonly grip_m?: Triple }

export interface KitchenTask { readonly name: string; readonly steps: readonly KitchenStep[]; readonly things: readonly Thing[] }

/** The task of a scene; undefined for another exercise, or a task whose bodies the scene does not contain. */
export function taskOf(scene: Pick<SceneT, 'exerciseJson' | 'bodies'> | null | undefined): KitchenTask | undefined {
  const parsedTask = scene && parsed(String(scene.exerciseJson ?? ''));
  if (parsedTask?.kind !== 'kitchen' || !parsedTask.steps?.length) return undefined;
  const isThere = parsedTask.steps.every(({ verb, body }) => VERBS.includes(verb) && scene!.bodies[body] !== undefined);
  return isThere ? { name: parsedTask.task ?? '', steps: parsedTask.steps, things: parsedTask.things ?? [] } : undefined;
}

type Parsed = { readonly kind?: unknown; readonly task?: string } & Partial<Pick<KitchenTask, 'steps' | 'things'>>;

function parsed(json: string): Parsed | null {
  try {
    return JSON.parse(json) as Parsed | null;
  } catch {
    return null;
  }
}

/** The joint of a body; undefined: it moves freely, or not at all. */
export const jointOf = (task: KitchenTask, body: number): Joint | undefined => task.things.find((thing) => thing.body === body)?.joint;

/** The present force that a step asks for [N]. */
export function askedOf({ force_n = 0 }: KitchenStep, { parameters }: Pick<SceneT, 'parameters'>, { parameters: now }: Pick<WorldStateT, 'parameters'>): number {
  const ratio = now?.[parameters?.findIndex(({ name }) => String(name) === 'force_ratio') ?? -1] ?? 1;
  return force_n * ratio;
}

/** Share of the task's work that is done: ways of joints and presses count, each step alike. */
export function doneShare({ steps }: KitchenTask, now: number, q: number, held_s: number): number {
  let done = 0, all = 0, from = 0;
  steps.forEach(({ verb, to = 0, for_s = 1 }, i) => {
    if (verb !== 'move' && verb !== 'press') return;
    all += 1;
    if (i < now) done += 1;
    else if (i === now) done += Math.max(0, Math.min(1, verb === 'press' ? held_s / for_s : (q - from) / (to - from || 1)));
    if (verb === 'move') from = to;
  });
  return all > 0 ? done / all : 0;
}

/** How the body of a step is met; for a release, as it was met before. */
export function metAt({ steps }: KitchenTask, now: number): ContactManner | undefined {
  let i = Math.min(now, steps.length - 1);
  while (i > 0 && steps[i]!.verb === 'let_go') i -= 1;
  return steps[i]?.met;
}

/** Point where a body is taken or pushed, in its own frame. */
export function pointMet(task: KitchenTask, body: BodyT, index: number, met: ContactManner | undefined): Position {
  const grip_m = task.things.find((thing) => thing.body === index)?.grip_m, [dx, dy, dz] = met?.side_m ?? [0, 0, 0];
  if (!grip_m) return handleOf(body).at_m;
  const [x, y, z] = grip_m;
  return { x: x + dx, y: y + dy, z: z + dz };
}

/** A body that is pushed to one side and back, as a switch: its positions on and off. */
export interface Switch { readonly body: number; readonly on: number; readonly off: number }

/** The body of a task that is pushed to two positions, the first one on; undefined: none. */
export function switchOf(task: KitchenTask): Switch | undefined {
  const pushed = task.steps.filter(({ to, met }) => to !== undefined && met?.means === 'push'), [first] = pushed;
  const back = pushed.find(({ body, to }) => body === first?.body && to !== first.to);
  return first && back ? { body: first.body, on: first.to!, off: back.to! } : undefined;
}

/** Whether a switch is nearer to its position on. */
export const isOn = ({ on, off }: Switch, q: number): boolean => Math.abs(q - on) < Math.abs(q - off);

/** The used bodies, in the order of the task. */
export const usedBodies = (task: KitchenTask): readonly number[] => [...new Set(task.steps.map(({ body }) => body))];

export interface Handle {
  readonly at_m: Position;     // its middle, in the body's frame
  readonly turn: PoseT['orientationXyzw'];
  readonly radius_m: number;
  readonly length_m: number;
}

const barsOf = ({ shapes }: Pick<BodyT, 'shapes'>): ShapeT[] => shapes.filter(({ type }) => type === ShapeType.Cylinder || type === ShapeType.Capsule);

/** Whether the body has a bar that a hand can close around. */
export const hasBar = (body: Pick<BodyT, 'shapes'>): boolean => barsOf(body).length > 0;

/** The grasped part of a body: its longest bar, or its middle if it has no bar. */
export function handleOf(body: Pick<BodyT, 'shapes'>): Handle {
  const bars = barsOf(body);
  const bar = bars.reduce<(typeof bars)[number] | undefined>((best, one) => (best && best.lengthM >= one.lengthM ? best : one), undefined);
  const at = bar?.inBody?.positionM ?? { x: 0, y: 0, z: 0 };
  return { at_m: { x: at.x, y: at.y, z: at.z }, turn: bar?.inBody?.orientationXyzw ?? null, radius_m: bar?.radiusM ?? 0.02, length_m: bar?.lengthM ?? 0.04 };
}
