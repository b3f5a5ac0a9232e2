// The bar in the game: recipe, meter, fill line and praise at one moment, from the program's values.
import { duration } from '../../shared/format';
import type { SceneT, WorldStateT } from '../../protocol';
import type { Chime, GoalWords, Meter, Phase, Play, Praise, Prompt, TaskCard, TaskStep, Zone } from '../exercise';
import { ExerciseValues } from '../values';
import { DRIP_L_S, Stage, type Bar, type BarDrink } from './bar';
import { effortText, EffortMeter, gripWord } from './effort';
import { inSentence, nameOf, text, type BarTextKey } from './i18n';
import { swatch } from './pictures';
import { barWords } from './words';

const PHASES: Readonly<Record<number, Phase>> = {
  [Stage.Reach]: 'reach', [Stage.Squeeze]: 'squeeze', [Stage.Pour]: 'hold', [Stage.LetGo]: 'letgo',
  [Stage.DrinkDone]: 'success', [Stage.LevelDone]: 'success', [Stage.DrawBack]: 'drawback',
  [Stage.Breathe]: 'ease',
};
/** Scales of the sound: a strong flow of liquid and of air [l/s], and the content of a full glass [l]. */
const FULL_FLOW_L_S = 0.012;
const FULL_AIR_L_S = 0.02;
const FULL_GLASS_L = 0.06;
/** Time constant of the shown flow, so that the number is readable [s]. */
const SPEED_S = 0.25;

/** Amounts in whole millilitres, the resolution of the exercise. */
const millilitres = (litres: number): number => Math.round(1000 * litres);

/** Accuracy of the layers over the drink; 100 is exact, 0 is nothing or twice the amount. */
export function filledPercent(drink: BarDrink, layers_l: readonly number[]): number {
  const asked_l = drink.steps.reduce((sum, step) => sum + step.amount_l, 0);
  const off_l = drink.steps.reduce((sum, step, i) => sum + Math.abs((layers_l[i] ?? 0) - step.amount_l), 0);
  return asked_l > 0 ? Math.round(100 * Math.max(0, 1 - off_l / asked_l)) : 0;
}

/** The remembered progress of the current drink. */
interface Progress { drink: number; atStart: boolean; spiltBefore_l: number; wrong: number; speed_l_s: number; pressed_l: number; air_l_s: number; last_s: number; readonly effort: EffortMeter }

export class BarPlay implements Play {
  readonly words = barWords;
  readonly panel = null;
  readonly chimes: Readonly<Record<string, Chime>> = { line_reached: 'line', drink_done: 'done' };
  private readonly values: ExerciseValues;
  private readonly progress: Progress;

  /** @param before the bar of an earlier scene: praise for its drink continues */
  constructor(private readonly bar: Bar, scene: SceneT, before?: BarPlay) {
    this.values = new ExerciseValues(scene.valueNames);
    this.progress = before ? { ...before.progress, drink: -1 } : { drink: -1, atStart: false, spiltBefore_l: 0, wrong: -1, speed_l_s: 0, pressed_l: 0, air_l_s: 0, last_s: NaN, effort: new EffortMeter() };
  }

  follow(state: WorldStateT): boolean {
    const { progress } = this;
    progress.wrong = this.wrongDispenser(state);
    const now_s = Number(state.sentMonotonicNs) / 1e9;
    progress.effort.look(this.values, state, now_s);
    this.lookAtFlow(state, now_s);
    const drink = this.value(state, 'drink'), begins = this.atStart(state), again = begins && !progress.atStart;
    progress.atStart = begins;
    if ((drink === progress.drink && !again) || (!begins && progress.drink >= 0) || this.isDone(state)) return false;
    progress.drink = drink;
    progress.effort.begin();
    progress.spiltBefore_l = begins ? this.value(state, 'spilt_l') : 0;
    return true;
  }

  phase(state: WorldStateT): Phase { return PHASES[this.value(state, 'stage')] ?? 'reach'; }
  atStart(state: WorldStateT): boolean { return this.value(state, 'step') === 0 && this.value(state, 'poured_l') === 0 && !this.isDone(state); }
  isPaused(state: WorldStateT): boolean { return this.value(state, 'paused') > 0.5; }

  prompt(state: WorldStateT, outOfReach: boolean): Prompt {
    const { bar: { dispensers }, progress: { wrong } } = this;
    const promptOf = (title: BarTextKey, more: BarTextKey, dispenser = this.value(state, 'target_dispenser', -1), urgent = false): Prompt => {
      const x = inSentence(dispensers[dispenser]?.liquid ?? '');
      return { title: text(title, { x }), more: text(more, { x }), urgent };
    };
    if (outOfReach) return promptOf('tooFar', 'reachMore');
    switch (this.value(state, 'stage')) {
      case Stage.Squeeze: return promptOf('squeeze', this.value(state, 'poured_l') > 0 ? 'squeezeMore' : 'graspMore');
      case Stage.Pour: {
        const spilling = this.value(state, 'flow_l_s') > 0 && this.value(state, 'over_glass', 1) === 0;
        return spilling ? promptOf('offGlass', 'offGlassMore', undefined, true) : promptOf('squeeze', 'squeezeMore');
      }
      case Stage.Breathe: return dispensers[this.value(state, 'target_dispenser', -1)]?.free ? promptOf('putDown', 'putDownMore') : promptOf('breathe', 'breatheMore');
      case Stage.LetGo: return promptOf('letGo', 'letGoMore');
      case Stage.DrawBack: return promptOf('drawBack', 'drawBackMore');
      default: return wrong >= 0 ? promptOf('wrong', 'wrongMore', wrong, true) : promptOf('reach', 'reachMore');
    }
  }

  donePrompt(state: WorldStateT): Prompt { return { title: text('success.guest'), more: this.count(state) }; }

  watchedTitle(state: WorldStateT): string {
    return this.isDone(state) ? text('success.guest') : this.prompt(state, false).title;
  }

  todo(state: WorldStateT): string {
    const phase = this.phase(state);
    const waits = phase === 'reach' || phase === 'drawback' || phase === 'letgo' || phase === 'ease' || (phase === 'squeeze' && this.value(state, 'flow_l_s') < DRIP_L_S);
    return waits ? `${phase} ${this.value(state, 'drink')} ${this.value(state, 'step')}` : '';
  }

  /** The recipe card. */
  card(state: WorldStateT): TaskCard | null {
    const drink = this.drink(state);
    if (!drink) return null;
    const now = this.isDone(state) ? drink.steps.length : this.value(state, 'step');
    const steps = drink.steps.map(({ liquid, amount_l }, i): TaskStep => {
      const done = millilitres(this.value(state, i === now ? 'poured_l' : `layer_l/${i}`)), asked = millilitres(amount_l);
      return {
        key: liquid, name: nameOf('liquid', liquid), is: i < now ? 'done' : i === now ? 'now' : 'later', done, asked,
        askedWords: text('ml', { a: asked }), doneWords: text('amountOf', { a: done, b: asked }), picture: () => swatch(liquid),
      };
    });
    return { label: text('recipe'), count: this.count(state), title: nameOf('drink', drink.name), steps };
  }

  meter(state: WorldStateT): Meter {
    const squeeze_n = this.value(state, 'squeeze_n'), low_n = this.value(state, 'squeeze_low_n', 1), high_n = this.value(state, 'squeeze_high_n', 2);
    const full_n = Math.max(this.value(state, 'squeeze_full_n', 3), 1e-6);
    const part = (force_n: number): number => Math.min(1, Math.max(0, force_n / full_n));
    const stage = this.value(state, 'stage'), engaged = this.value(state, 'engaged_dispenser', -1);
    const wrong = engaged >= 0 && engaged !== this.value(state, 'target_dispenser', -1) && stage !== Stage.LetGo;
    const past = stage === Stage.LetGo || stage === Stage.Breathe || this.value(state, 'poured_l') > this.value(state, 'asked_l', Infinity);
    const felt: Zone = squeeze_n < 0.1 * low_n ? 'none' : squeeze_n < low_n ? 'soft' : squeeze_n <= high_n ? 'right' : 'strong';
    const zone = felt === 'none' ? 'none' : wrong ? 'wrong' : past ? 'stop' : felt;
    return {
      shown: isFilling(stage) || (stage === Stage.Reach && zone !== 'none'),
      value: part(squeeze_n), low: part(low_n), high: part(high_n), zone,
    };
  }

  /** The amount beside the line on the glass, and the flow. */
  goal(state: WorldStateT): GoalWords | null {
    if (!isFilling(this.value(state, 'stage'))) return null;
    const [a, b] = [millilitres(this.value(state, 'poured_l')), millilitres(this.value(state, 'asked_l'))];
    const speed = millilitres(this.progress.speed_l_s);
    return { amount: text('amountOf', { a, b }), more: speed > 0 ? text('mlPerS', { a: speed }) : text('fillToHere') };
  }

  praise(state: WorldStateT, ownGrip: boolean): Praise | null {
    const drink = this.drink(state);
    if (!drink) return null;
    const { effort, spiltBefore_l } = this.progress;
    const layers_l = drink.steps.map((_, i) => this.value(state, `layer_l/${i}`));
    // The level ends by itself after its last drink.
    const levelDone = this.value(state, 'stage') === Stage.LevelDone || this.value(state, 'drink') + 1 >= this.value(state, 'drinks', 1);
    return {
      lead: levelDone ? text('success.level') : text('success.ready', { x: nameOf('drink', drink.name) }),
      stars: Math.max(0, Math.min(3, Math.round(this.value(state, 'stars')))),
      effort: effortText(drink, layers_l, gripWord(effort.grip(), ownGrip)),
      figures: [
        { key: 'filled', label: text('success.filled'), shown: `${filledPercent(drink, layers_l)} %` },
        { key: 'spilt', label: text('success.spilt'), shown: text('ml', { a: Math.max(0, millilitres(this.value(state, 'spilt_l') - spiltBefore_l)) }) },
        { key: 'time', label: text('success.time'), shown: duration(Math.round(this.value(state, 'drink_time_s'))) },
      ],
      levelDone, next: text('success.next'),
    };
  }

  flow(state: WorldStateT): { rate: number; level: number; air: number } {
    return { rate: this.value(state, 'flow_l_s') / FULL_FLOW_L_S, level: this.value(state, 'glass_l') / FULL_GLASS_L, air: Math.min(1, this.progress.air_l_s / FULL_AIR_L_S) };
  }

  private value(state: WorldStateT, name: string, otherwise = 0): number { return this.values.get(state, name, otherwise); }

  private isDone(state: WorldStateT): boolean { return this.phase(state) === 'success'; }

  private drink(state: WorldStateT): BarDrink | undefined {
    const { drinks } = this.bar;
    return drinks[Math.min(drinks.length - 1, Math.max(0, this.value(state, 'drink')))];
  }

  private count(state: WorldStateT): string {
    return text('drinkOf', { n: this.value(state, 'drink') + 1, m: Math.max(this.value(state, 'drinks', this.bar.drinks.length), 1) });
  }

  /** Updates the smoothed flow, and the flow of returning air. */
  private lookAtFlow(state: WorldStateT, now_s: number): void {
    const { progress } = this, dt_s = now_s - progress.last_s, pressed_l = this.value(state, 'pressed_l');
    if (dt_s > 0) {
      progress.speed_l_s += (this.value(state, 'flow_l_s') - progress.speed_l_s) * (1 - Math.exp(-dt_s / SPEED_S));
      progress.air_l_s = Math.max(0, progress.pressed_l - pressed_l) / dt_s;
    }
    progress.pressed_l = pressed_l;
    progress.last_s = now_s;
  }

  /** A wrong dispenser that was squeezed, until it is released; -1: none. Passing by another one is not an error. */
  private wrongDispenser(state: WorldStateT): number {
    const engaged = this.value(state, 'engaged_dispenser', -1);
    if (engaged < 0 || engaged === this.value(state, 'target_dispenser', -1)) return -1;
    const squeezed = this.value(state, 'squeeze_n') > 0.3 * this.value(state, 'squeeze_low_n', 1);
    return squeezed || engaged === this.progress.wrong ? engaged : -1;
  }
}

const isFilling = (stage: number): boolean => stage === Stage.Squeeze || stage === Stage.Pour || stage === Stage.LetGo || stage === Stage.Breathe;
