// What the exercise told the page of itself, and its figures of one moment.
import type { SceneT, WorldStateT } from '../protocol';

export interface RecipeStep { readonly liquid: string; readonly amount_l: number; readonly tolerance_l: number }
export interface Recipe { readonly name: string; readonly steps: readonly RecipeStep[] }
export interface Dispenser { readonly body: string; readonly liquid: string }

/** exercise_json of the cocktail bar, as far as the page's words need it. */
export interface Script {
  readonly dispensers: readonly Dispenser[];
  readonly drinks: readonly Recipe[];
  readonly level: number;
  readonly levels: readonly { readonly level: number; readonly name: string }[];
  /** Where a figure is in WorldState.values. */
  readonly place: ReadonlyMap<string, number>;
  readonly faultNames: readonly string[];
  readonly counter_z_m?: number;   // top of the counter
}

/** Null where the exercise has no bar; throws nothing on a text that is not JSON. */
export function readScript(scene: SceneT): Script | null {
  let json: Record<string, unknown>;
  try {
    json = JSON.parse(String(scene.exerciseJson ?? '')) as Record<string, unknown>;
  } catch {
    return null;
  }
  if (json?.kind !== 'cocktail_bar' || !Array.isArray(json.dispensers) || !Array.isArray(json.drinks)) return null;
  const levels = Array.isArray(json.levels) ? json.levels as Script['levels'] : [];
  return {
    dispensers: json.dispensers as Dispenser[],
    drinks: json.drinks as Recipe[],
    level: scene.level,
    levels,
    place: new Map(scene.valueNames.map((name, i) => [String(name), i])),
    faultNames: scene.faultNames.map(String),
    counter_z_m: typeof json.counter_z_m === 'number' ? json.counter_z_m : undefined,
  };
}

/** A figure by its name; what `otherwise` says where the exercise has none of that name. */
export function figure(script: Script, state: WorldStateT, name: string, otherwise = 0): number {
  const place = script.place.get(name);
  const value = place === undefined ? undefined : state.values[place];
  return value === undefined || !Number.isFinite(value) ? otherwise : value;
}

/** Names of the set bits. */
export function faultsOf(names: readonly string[], bits: number): string[] {
  return names.filter((_, bit) => ((bits >>> bit) & 1) === 1);
}
