import type { WorldStateT } from '../protocol';

/** Values of an exercise, found by their names (docs/exercises.md). */
export class ExerciseValues {
  private readonly index: ReadonlyMap<string, number>;

  constructor(names: readonly unknown[]) {
    this.index = new Map(names.map((name, i) => [String(name), i]));
  }

  has(name: string): boolean { return this.index.has(name); }

  /** A value by name; `otherwise` where the exercise has none of that name, or it is not finite. */
  get(state: Pick<WorldStateT, 'values'>, name: string, otherwise = 0): number {
    const i = this.index.get(name);
    const value = i === undefined ? undefined : state.values[i];
    return value === undefined || !Number.isFinite(value) ? otherwise : value;
  }
}
