// A task of the kitchen as data: what its TOML file says, as the scene message tells it. Pure.
import type { BodyT, PoseT, SceneT } from '../../protocol';
import { ShapeType } from '../../protocol';
import type { Position } from '../exercise';

export const VERBS = ['reach', 'take', 'move', 'hold', 'press', 'put', 'let_go'] as const;
export type Verb = (typeof VERBS)[number];

export interface KitchenStep {
  readonly verb: Verb;
  /** Index of the body in the scene. */
  readonly body: number;
  /** Where its joint is to be [m or rad]. */
  readonly to?: number;
  readonly for_s?: number;
}

type Triple = readonly [number, number, number];

/** A body slides along an axis, or turns about it. Axis and point: world, at the start. */
export interface Joint {
  readonly type: 'hinge' | 'slide';
  readonly axis: Triple;
  readonly point_m: Triple;
  readonly least: number | null;   // m or rad; null: it has no end
  readonly most: number | null;
}

export interface Thing { readonly body: number; readonly joint?: Joint }

export interface KitchenTask { readonly steps: readonly KitchenStep[]; readonly things: readonly Thing[] }

/** Undefined where the exercise is another one, or its task has nothing that the scene shows. */
export function taskOf(scene: Pick<SceneT, 'exerciseJson' | 'bodies'> | null | undefined): KitchenTask | undefined {
  const told = scene && parsed(String(scene.exerciseJson ?? ''));
  if (told?.kind !== 'kitchen' || !told.steps?.length) return undefined;
  const isThere = told.steps.every(({ verb, body }) => VERBS.includes(verb) && scene!.bodies[body] !== undefined);
  return isThere ? { steps: told.steps, things: told.things ?? [] } : undefined;
}

function parsed(json: string): ({ kind?: unknown } & Partial<KitchenTask>) | null {
  try {
    return JSON.parse(json) as { kind?: unknown } | null;
  } catch {
    return null;
  }
}

/** The joint of a body; undefined: it moves freely, or not at all. */
export const jointOf = (task: KitchenTask, body: number): Joint | undefined => task.things.find((thing) => thing.body === body)?.joint;

/** The bodies that are used, in the order in which the task asks for them. */
export const usedBodies = (task: KitchenTask): readonly number[] => [...new Set(task.steps.map(({ body }) => body))];

export interface Handle {
  readonly at_m: Position;     // its middle, the body's frame
  readonly turn: PoseT['orientationXyzw'];
  readonly radius_m: number;
  readonly length_m: number;
}

/** What of a body is taken: its longest bar; of one without a bar its middle. */
export function handleOf({ shapes }: Pick<BodyT, 'shapes'>): Handle {
  const bars = shapes.filter(({ type }) => type === ShapeType.Cylinder || type === ShapeType.Capsule);
  const bar = bars.reduce<(typeof bars)[number] | undefined>((best, one) => (best && best.lengthM >= one.lengthM ? best : one), undefined);
  const at = bar?.inBody?.positionM ?? { x: 0, y: 0, z: 0 };
  return { at_m: { x: at.x, y: at.y, z: at.z }, turn: bar?.inBody?.orientationXyzw ?? null, radius_m: bar?.radiusM ?? 0.02, length_m: bar?.lengthM ?? 0.04 };
}
