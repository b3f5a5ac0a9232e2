// The panel of an exercise at one moment: Scene.panel and the values of a state (docs/exercises.md). No elements.
import type { SceneT, WordsT, WorldStateT } from '../protocol';
import { fixed } from '../shared/format';
import { language } from '../shared/i18n';
import { ExerciseValues } from './values';

export interface Goal { readonly low: number; readonly high: number }   // 0 .. 1 of the range

export interface PanelValueView {
  readonly name: string;
  readonly label: string;
  readonly shown: string;        // "3.2 N"
  readonly number: string;       // "3.2"
  readonly unit: string;
  readonly share: number;        // 0 .. 1 of its range
  readonly goal: Goal | null;
  readonly zone: '' | 'low' | 'right' | 'high';   // relative to the goal band; '' without one
  readonly result: boolean;      // it is a result at the end
}

/** A text in the page's language. */
export function inLanguage(words: WordsT | null | undefined): string {
  return String(words?.[language()] ?? words?.en ?? '');
}

/** The label of a panel's value in the page's language; empty where the panel does not show it. */
export function labelOf(scene: SceneT | null | undefined, value: string): string {
  return inLanguage(scene?.panel?.values.find(({ name }) => String(name) === value)?.label);
}

/** The panel of a scene's exercise. */
export class ExercisePanel {
  private readonly figures: ExerciseValues;

  private constructor(private readonly scene: SceneT) {
    this.figures = new ExerciseValues(scene.valueNames);
  }

  /** The panel of a scene; null where the exercise has none. */
  static of(scene: SceneT | null): ExercisePanel | null {
    return scene?.panel ? new ExercisePanel(scene) : null;
  }

  get title(): string { return inLanguage(this.scene.panel?.title); }
  get lead(): string { return inLanguage(this.scene.panel?.lead); }

  /** The current instruction; empty where the exercise gives none. */
  instruction(state: WorldStateT): string {
    return inLanguage(this.scene.panel?.instructions[this.figures.get(state, 'instruction', -1)]);
  }

  /** Whether the exercise is finished. */
  done(state: WorldStateT): boolean { return this.figures.get(state, 'done') > 0.5; }

  /** Whether the exercise waits for the answer which of two was more. */
  answering(state: WorldStateT): boolean { return this.figures.get(state, 'answering') > 0.5; }

  values(state: WorldStateT): PanelValueView[] {
    const done = this.done(state);
    // A value that is not measured yet is NaN.
    const known = (this.scene.panel?.values ?? []).filter(({ name }) => !Number.isNaN(this.figures.get(state, String(name))));
    return known.map((reported) => {
      const value = this.figures.get(state, String(reported.name));
      const share = (of: number): number => Math.min(1, Math.max(0, (of - reported.lower) / (reported.upper - reported.lower)));
      const low = this.figures.get(state, String(reported.goalLower ?? ''), NaN);
      const high = this.figures.get(state, String(reported.goalUpper ?? ''), NaN);
      const banded = !done && Number.isFinite(low) && Number.isFinite(high);
      const number = fixed(value * reported.factor, reported.decimals);
      const unit = reported.unit === '1' ? '' : String(reported.unit ?? ''); // "1": a count or a ratio
      return {
        name: String(reported.name), label: inLanguage(reported.label), number, unit, shown: unit ? `${number} ${unit}` : number,
        share: share(value), goal: banded ? { low: share(low), high: share(high) } : null,
        zone: !banded ? '' : value < low ? 'low' : value > high ? 'high' : 'right',
        result: reported.result,
      };
    });
  }

  /** The text of an event; empty where it has none. */
  event(type: number): string {
    return inLanguage(this.scene.panel?.events.find((event) => event.type === type)?.words);
  }
}
