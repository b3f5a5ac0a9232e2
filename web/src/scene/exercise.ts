// The cocktail bar as the exercise tells it: exercise_json once, and its values by name.

import type { SceneT, WorldStateT } from '../protocol';

export type Numbers3 = readonly [number, number, number];

export interface BarDispenser {
  readonly body: string; readonly liquid: string; readonly free: boolean;
  readonly radius_m: number; readonly height_m: number;
  readonly nozzle_m: Numbers3; readonly grip_m: Numbers3;   // frame of the body
}
export interface BarGlass {
  readonly body: string; readonly radius_m: number; readonly height_m: number;
  readonly m_per_l: number; readonly capacity_l: number;
}
export interface BarStep { readonly liquid: string; readonly amount_l: number; readonly tolerance_l: number }
export interface Bar {
  readonly kind: 'cocktail_bar';
  readonly dispensers: readonly BarDispenser[];
  readonly glass: BarGlass;
  readonly counter_z_m: number;
  readonly rail_z_m: number;
  readonly row_y_m?: readonly [number, number];   // of the first dispenser, while the row slides
  readonly drinks: readonly { readonly name: string; readonly steps: readonly BarStep[] }[];
}

/** Of ExerciseRecord.values, `stage`. */
export const STAGE = { reach: 0, squeeze: 1, pouring: 2, letGo: 3, drinkDone: 4, levelDone: 5, drawBack: 6 } as const;

/** The bar of a scene; undefined when the exercise is another one, or says nothing. */
export function barOf(scene: Pick<SceneT, 'exerciseJson'>): Bar | undefined {
  try {
    const told = JSON.parse(String(scene.exerciseJson ?? '')) as Bar;
    const whole = told?.kind === 'cocktail_bar' && Array.isArray(told.dispensers) && told.glass && Array.isArray(told.drinks);
    return whole ? told : undefined;
  } catch {
    return undefined;
  }
}

/** Reads values by name; 0 for a name that the exercise does not have. */
export class ExerciseValues {
  private readonly index: ReadonlyMap<string, number>;
  private readonly layers: readonly number[];

  constructor(names: readonly string[]) {
    this.index = new Map(names.map((name, i) => [name, i]));
    this.layers = [0, 1, 2, 3, 4, 5, 6, 7].map((step) => this.index.get(`layer_l/${step}`) ?? -1);
  }

  get(state: Pick<WorldStateT, 'values'>, name: string): number {
    const i = this.index.get(name);
    return i === undefined ? 0 : state.values[i] ?? 0;
  }

  /** What each step of the drink put into the glass [l]. */
  poured(state: Pick<WorldStateT, 'values'>): number[] {
    return this.layers.map((i) => i < 0 ? 0 : state.values[i] ?? 0);
  }
}
