// An exercise in the game that is shown only by its panel.
import type { SceneT, WorldStateT } from '../protocol';
import type { ExerciseWords, Meter, Phase, Play, Praise, Prompt } from './exercise';
import { ExercisePanel } from './panel';
import { ExerciseValues } from './values';

/** The words that the exercise's file has. */
export const panelWords = (panel: ExercisePanel): ExerciseWords => ({ title: () => panel.title, lead: () => panel.lead, steps: () => [], levelName: () => '', oneButton: () => undefined });

export class PanelPlay implements Play {
  readonly chimes = {};
  readonly words: ExerciseWords;
  private readonly values: ExerciseValues;

  constructor(readonly panel: ExercisePanel, scene: SceneT) {
    this.values = new ExerciseValues(scene.valueNames);
    this.words = panelWords(panel);
  }

  follow(): boolean { return false; }
  phase(state: WorldStateT): Phase { return this.panel.done(state) ? 'success' : 'free'; }
  atStart(state: WorldStateT): boolean { return !this.panel.done(state) && this.values.get(state, 'instruction') === 0; }
  isPaused(state: WorldStateT): boolean { return this.values.get(state, 'paused') > 0.5; }

  /** The current instruction; without one, the exercise's description. */
  prompt(state: WorldStateT): Prompt {
    const now = this.panel.instruction(state);
    return now ? { title: now, more: '' } : { title: this.panel.title, more: this.panel.lead };
  }

  donePrompt(): Prompt { return { title: '', more: '' }; }
  watchedTitle(): string { return ''; }
  todo(): string { return ''; }
  card(): null { return null; }
  goal(): null { return null; }

  /** A meter of the first value that has a goal band. */
  meter(state: WorldStateT): Meter | null {
    const value = this.panel.values(state).find(({ goal }) => goal !== null);
    if (!value?.goal || value.zone === '') return null;
    return { shown: true, value: value.share, low: value.goal.low, high: value.goal.high, zone: value.zone, label: value.label };
  }

  praise(state: WorldStateT): Praise {
    const { panel } = this;
    return {
      lead: panel.instruction(state) || panel.title, stars: undefined, effort: '', levelDone: true, next: '',
      figures: panel.values(state).filter(({ result }) => result).map(({ name, label, shown }) => ({ key: `result-${name}`, label, shown })),
    };
  }

  flow(): { rate: number; level: number } { return { rate: 0, level: 0 }; }
}
