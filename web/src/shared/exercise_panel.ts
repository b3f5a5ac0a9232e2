// What the exercise's own panel says of any exercise: Scene.panel and the values of one moment. No elements.
import type { SceneT, WordsT, WorldStateT } from '../protocol';
import { language } from './i18n';

export interface Goal { readonly low: number; readonly high: number }   // 0 .. 1 of the range

export interface PanelValueView {
  readonly name: string;
  readonly label: string;
  readonly shown: string;        // "3.2 N"
  readonly number: string;       // "3.2"
  readonly unit: string;
  readonly share: number;        // 0 .. 1 of its range
  readonly goal: Goal | null;
  readonly zone: '' | 'low' | 'right' | 'high';   // of the goal band; '' without one
  readonly result: boolean;      // it counts at the end
}

/** Of the names that pages know: docs/exercises.md. */
const INSTRUCTION = 'instruction', DONE = 'done';

/** A text in the page's language. */
export function inLanguage(words: WordsT | null | undefined): string {
  return String(words?.[language()] ?? words?.en ?? '');
}

/** The panel of a scene's exercise. */
export class ExercisePanel {
  private readonly place: ReadonlyMap<string, number>;

  private constructor(private readonly scene: SceneT) {
    this.place = new Map(scene.valueNames.map((name, i) => [String(name), i]));
  }

  /** Null where the exercise tells of none. */
  static of(scene: SceneT | null): ExercisePanel | null {
    return scene?.panel ? new ExercisePanel(scene) : null;
  }

  get title(): string { return inLanguage(this.scene.panel?.title); }
  get lead(): string { return inLanguage(this.scene.panel?.lead); }

  /** What the person is to do now; empty where the exercise does not say. */
  instruction(state: WorldStateT): string {
    return inLanguage(this.scene.panel?.instructions[this.figure(state, INSTRUCTION, -1)]);
  }

  /** Nothing is left to do. */
  done(state: WorldStateT): boolean { return this.figure(state, DONE, 0) > 0.5; }

  values(state: WorldStateT): PanelValueView[] {
    const done = this.done(state);
    return (this.scene.panel?.values ?? []).map((told) => {
      const value = this.figure(state, String(told.name), 0);
      const share = (of: number): number => Math.min(1, Math.max(0, (of - told.lower) / (told.upper - told.lower)));
      const low = this.figure(state, String(told.goalLower ?? ''), NaN);
      const high = this.figure(state, String(told.goalUpper ?? ''), NaN);
      const banded = !done && Number.isFinite(low) && Number.isFinite(high);
      const number = (value * told.factor).toFixed(told.decimals);
      const unit = String(told.unit ?? '');
      return {
        name: String(told.name), label: inLanguage(told.label), number, unit, shown: unit ? `${number} ${unit}` : number,
        share: share(value), goal: banded ? { low: share(low), high: share(high) } : null,
        zone: !banded ? '' : value < low ? 'low' : value > high ? 'high' : 'right',
        result: told.result,
      };
    });
  }

  /** An event in words; empty where nothing is said of it. */
  event(type: number): string {
    return inLanguage(this.scene.panel?.events.find((event) => event.type === type)?.words);
  }

  private figure(state: WorldStateT, name: string, otherwise: number): number {
    const place = this.place.get(name);
    const value = place === undefined ? undefined : state.values[place];
    return value === undefined || !Number.isFinite(value) ? otherwise : value;
  }
}
