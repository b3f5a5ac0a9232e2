// The cocktail bar as the program describes it: exercise_json, parsed only here (docs/exercises.md).
import type { SceneT } from '../../protocol';

export type Numbers3 = readonly [number, number, number];

export interface BarDispenser {
  readonly body: string; readonly liquid: string; readonly free: boolean;
  readonly radius_m: number; readonly height_m: number;
  readonly nozzle_m: Numbers3; readonly grip_m: Numbers3;   // in the body's frame
  readonly home_m?: Numbers3;                               // its place before anything moved; undefined in old recordings
}
export interface BarGlass {
  readonly body: string; readonly radius_m: number; readonly height_m: number;
  readonly m_per_l: number; readonly capacity_l: number;
}
export interface BarStep { readonly liquid: string; readonly amount_l: number; readonly tolerance_l: number }
export interface BarDrink { readonly name: string; readonly steps: readonly BarStep[] }
export interface Bar {
  readonly dispensers: readonly BarDispenser[];
  readonly viscosities_pa_s: Readonly<Record<string, number>>;   // of the liquids, by name
  readonly glass: BarGlass;
  readonly counter_z_m: number;
  readonly rail_z_m: number;
  readonly row_y_m?: readonly [number, number];   // of the first dispenser, while the row slides
  readonly drinks: readonly BarDrink[];
  readonly levels: readonly { readonly level: number; readonly name: string }[];
}

/** The shipped file of config/exercises with this bar. */
export const BAR_FILE = 'cocktail-bar';

/** The values of `stage`. */
export const Stage = { Reach: 0, Squeeze: 1, Pour: 2, LetGo: 3, DrinkDone: 4, LevelDone: 5, DrawBack: 6, Breathe: 7 } as const;

/** A flow below this counts as dripping, not as pouring [l/s]. */
export const DRIP_L_S = 0.0005;

type Json = Readonly<Record<string, unknown>>;

const isObject = (value: unknown): value is Json => typeof value === 'object' && value !== null && !Array.isArray(value);
const objects = (value: unknown): Json[] => (Array.isArray(value) ? value.filter(isObject) : []);
const number = (value: unknown): number => (typeof value === 'number' ? value : 0);
const words = (value: unknown): string => (typeof value === 'string' ? value : '');
const point = (value: unknown): Numbers3 => {
  const [x, y, z] = Array.isArray(value) ? value.map(number) : [];
  return [x ?? 0, y ?? 0, z ?? 0];
};

function readDispenser(d: Json): BarDispenser {
  return {
    body: words(d.body), liquid: words(d.liquid), free: d.free === true, radius_m: number(d.radius_m), height_m: number(d.height_m),
    nozzle_m: point(d.nozzle_m), grip_m: point(d.grip_m), home_m: Array.isArray(d.home_m) ? point(d.home_m) : undefined,
  };
}

function readDrink(drink: Json): BarDrink {
  const steps = objects(drink.steps).map((s) => ({ liquid: words(s.liquid), amount_l: number(s.amount_l), tolerance_l: number(s.tolerance_l) }));
  return { name: words(drink.name), steps };
}

/** The bar of a scene; undefined for another exercise, or without a description. */
export function barOf(scene: Pick<SceneT, 'exerciseJson'> | null | undefined): Bar | undefined {
  let parsed: unknown;
  try {
    parsed = JSON.parse(String(scene?.exerciseJson ?? ''));
  } catch {
    return undefined;
  }
  if (!isObject(parsed) || parsed.kind !== 'cocktail_bar' || !Array.isArray(parsed.dispensers) || !Array.isArray(parsed.drinks)) return undefined;
  const glass = isObject(parsed.glass) ? parsed.glass : {};
  const row = Array.isArray(parsed.row_y_m) ? parsed.row_y_m.map(number) : [];
  return {
    dispensers: objects(parsed.dispensers).map(readDispenser),
    viscosities_pa_s: Object.fromEntries(objects(parsed.liquids).map(({ name, viscosity_pa_s }) => [words(name), number(viscosity_pa_s)])),
    glass: { body: words(glass.body), radius_m: number(glass.radius_m), height_m: number(glass.height_m), m_per_l: number(glass.m_per_l), capacity_l: number(glass.capacity_l) },
    counter_z_m: number(parsed.counter_z_m), rail_z_m: number(parsed.rail_z_m),
    row_y_m: row.length === 2 ? [row[0], row[1]] : undefined,
    drinks: objects(parsed.drinks).map(readDrink),
    levels: objects(parsed.levels).map(({ level, name }) => ({ level: number(level), name: words(name) })),
  };
}
