// Squeezing to a level in the game: the bands as a card, instruction, praise.
import type { SceneT, WorldStateT } from '../../protocol';
import { fixed } from '../../shared/format';
import type { Bells, Chime, ExerciseWords, FlowSound, Meter, Phase, Play, Praise, Prompt, TaskCard, TaskStep } from '../exercise';
import type { ExercisePanel } from '../panel';
import { PanelPlay } from '../panel_play';
import { ExerciseValues } from '../values';
import { flightOf, type Cue, type Flight } from './flight';
import { text } from './i18n';
import { heightDisc, stepPicture } from './pictures';

/** Minimum scores for two and for three stars. */
const TWO_STARS = 70;
const THREE_STARS = 90;
/** Each held band sounds one tone higher than the last. */
const ENTERED: Bells = { tones_hz: [587], apart_s: 0.12 };
const HELD: Bells = { tones_hz: [587, 880], apart_s: 0.2 };
const ALL: Bells = { tones_hz: [440, 587, 740, 880], apart_s: 0.22 };

const MORE: Readonly<Record<Cue, () => string>> = {
  grip: () => text('more.grip'), up: () => text('more.up'), down: () => text('more.down'), stay: () => text('more.stay'),
  open: () => text('more.open'), none: () => text('more.none'),
};

const PHASES: Readonly<Record<Cue, Phase>> = { grip: 'reach', up: 'squeeze', stay: 'hold', down: 'hold', open: 'letgo', none: 'success' };

/** Holding time of a band: the range of the value that counts it [s]. */
export function holdOf(scene: Pick<SceneT, 'panel'>): number {
  return scene.panel?.values.find(({ name }) => String(name) === 'held_s')?.upper ?? 2;
}

export class LevelPlay implements Play {
  readonly panel = null;
  readonly chimes: Readonly<Record<string, Chime>> = { band_entered: ENTERED, band_held: HELD, level_done: ALL };
  readonly words: ExerciseWords;
  private readonly values: ExerciseValues;
  private readonly plain: PanelPlay;
  private readonly hold_s: number;
  private wasDone = true;

  constructor(private readonly shown: ExercisePanel, scene: SceneT) {
    this.values = new ExerciseValues(scene.valueNames);
    this.plain = new PanelPlay(shown, scene);
    this.hold_s = holdOf(scene);
    this.words = {
      ...this.plain.words,
      lead: () => text('welcome.lead'),
      oneButton: () => ({ press: text('oneButton.press'), point: text('oneButton.point') }),
      steps: (skin) => ([1, 2, 3] as const).map((n) => ({ picture: stepPicture(n, skin), title: text(`welcome.step${n}`), more: text(`welcome.step${n}More`) })),
    };
  }

  /** The exercise starts again after a restart. */
  follow(state: WorldStateT): boolean {
    const done = this.shown.done(state), begins = this.wasDone && !done;
    this.wasDone = done;
    return begins;
  }

  phase(state: WorldStateT): Phase { return this.shown.done(state) ? 'success' : PHASES[this.flight(state).cue]; }
  atStart(state: WorldStateT): boolean { const { lit, held } = this.flight(state); return !this.shown.done(state) && lit === 0 && held === 0; }
  isPaused(state: WorldStateT): boolean { return this.plain.isPaused(state); }
  prompt(state: WorldStateT): Prompt {
    const { cue } = this.flight(state);
    return { title: this.plain.prompt(state).title, more: MORE[cue](), steady: cue === 'down' };
  }

  donePrompt(): Prompt { return { title: text('done.title'), more: text('more.none') }; }
  watchedTitle(state: WorldStateT): string { return this.shown.instruction(state); }

  /** No task is named while the balloon rises, or is held. */
  todo(state: WorldStateT): string {
    const { cue, height, lit } = this.flight(state);
    return cue === 'grip' || cue === 'open' || (cue === 'up' && height === 0) ? `${cue} ${lit}` : '';
  }

  goal(): null { return null; }
  meter(state: WorldStateT): Meter | null { return this.plain.meter(state); }

  /** One row for each band. */
  card(state: WorldStateT): TaskCard {
    const { lit, bands, held } = this.flight(state), all = this.shown.done(state) ? bands : lit;
    const s = (share: number): string => fixed(share * this.hold_s, 1).replace(/[.,]0$/, '');
    const steps = Array.from({ length: bands }, (_, i): TaskStep => {
      const now = i === all, done = now ? Math.round(100 * held) : 0;
      return {
        key: `band-${i}`, name: text('height', { n: i + 1 }), is: i < all ? 'done' : now ? 'now' : 'later', done, asked: 100,
        askedWords: text('hold', { a: s(1) }), doneWords: text('heldOf', { a: s(held), b: s(1) }), picture: () => heightDisc(i, bands),
      };
    });
    return { label: this.shown.title, count: text('count', { n: all, m: bands }), title: this.shown.title, steps };
  }

  praise(state: WorldStateT, ownGrip: boolean): Praise {
    const score = this.values.get(state, 'score');
    return {
      ...this.plain.praise(state), lead: text('done.title'), effort: text(ownGrip ? 'done.effort' : 'done.helped'),
      stars: score >= THREE_STARS ? 3 : score >= TWO_STARS ? 2 : 1,
    };
  }

  /** The burner: its volume follows the flow out of the grip. */
  flow(state: WorldStateT): { rate: number; level: number; sound: FlowSound } {
    const { flame, height } = this.flight(state);
    return { rate: 2 * flame, level: height, sound: 'air' };
  }

  private flight(state: WorldStateT): Flight { return flightOf(this.values, state, this.hold_s); }
}
