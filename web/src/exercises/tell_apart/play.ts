// Comparing two bottles in the game: the panel is the card.
import type { SceneT, WorldStateT } from '../../protocol';
import type { ExerciseWords, Prompt } from '../exercise';
import type { ExercisePanel } from '../panel';
import { PanelPlay, panelWords } from '../panel_play';
import { text } from './i18n';

export class PairPlay extends PanelPlay {
  override readonly words: ExerciseWords;

  constructor(panel: ExercisePanel, scene: SceneT) {
    super(panel, scene);
    this.words = { ...panelWords(panel), oneButton: () => ({ press: text('oneButton.press'), point: text('oneButton.point') }) };
  }

  override prompt(state: WorldStateT): Prompt {
    const shown = super.prompt(state);
    return this.panel.answering(state) ? { ...shown, more: text('more.answer'), steady: true } : shown;
  }
}
