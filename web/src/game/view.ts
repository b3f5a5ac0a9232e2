// What the page says at one moment, as a pure function of what it knows. No words of a language, no elements.
import type { ConnectionStatus, VersionProblem } from '../net/connection';
import type { Hands, Loss } from '../net/holding';
import { RunState, Steering, type WorldStateT } from '../protocol';
import type { ExercisePanel } from '../shared/exercise_panel';
import { faultWord, type TextKey } from '../shared/i18n';
import { faultsOf, figure, type Recipe, type Script } from './script';

/** Of values.stage; docs/exercises.md. */
export const Stage = { Reach: 0, Squeeze: 1, Pour: 2, LetGo: 3, DrinkDone: 4, LevelDone: 5, DrawBack: 6 } as const;

/** Bit of WorldState.faults; docs/safety.md. */
const OWNER_SILENT = 1 << 20;

export type PageState =
  | 'version' | 'absent' | 'lost' | 'loading' | 'stopped' | 'framing' | 'welcome' | 'left' | 'watching' | 'free' | 'unseen' | 'rest' | 'success'
  | 'reach' | 'squeeze' | 'pour' | 'letgo' | 'drawback';

/** Between two drinks, with the exercise paused; or the device let go at this person's wish, until they go on. */
export type Resting = 'no' | 'between' | 'off';

/** The browser lost the picture; it is back, and the person has not gone on yet. */
export type Unseen = 'no' | 'lost' | 'back';

export interface Situation {
  readonly status: ConnectionStatus;
  readonly problem: VersionProblem | null;
  readonly everOpen: boolean;      // the program has answered since the page was opened
  readonly attempts: number;       // failed ones since it was last there
  readonly wish: 'undecided' | 'play' | 'watch';
  readonly loading: boolean;       // orders of ours are on their way that stop the run for a moment
  readonly resting: Resting;
  readonly framing: boolean;       // the camera is opened, and a hand to be kept in its frame
  readonly unseen: Unseen;         // the picture that the person plays by
  readonly loss: Loss;             // of the controls that this page had
  readonly held: Pick<Hands, 'heldByYou' | 'held'>;
}

const STAGES: Readonly<Record<number, PageState>> = {
  [Stage.Reach]: 'reach', [Stage.Squeeze]: 'squeeze', [Stage.Pour]: 'pour', [Stage.LetGo]: 'letgo',
  [Stage.DrinkDone]: 'success', [Stage.LevelDone]: 'success', [Stage.DrawBack]: 'drawback',
};

/** Whether the device is a real one: only a simulated one tells what its virtual patient intends. */
export function hasHardware(state: WorldStateT | null): boolean {
  return state !== null && state.qM.length > 0 && !state.intention.some(Number.isFinite);
}

/** Whether the exercise's effort is out: who showed it was lost, and nobody has taken the controls since. */
export function isFaded(state: WorldStateT): boolean {
  return (state.faults & OWNER_SILENT) !== 0;
}

/** Whether the exercise stands still: nobody plays, and nobody is to. */
export function isPaused(script: Script | null, state: WorldStateT): boolean {
  return script !== null && figure(script, state, 'paused') > 0.5;
}

/** Whether this page's person is who moves the hand. */
export function isPlaying(s: Situation, state: WorldStateT | null): boolean {
  if (s.wish !== 'play' || !s.held.heldByYou || !state || state.runState !== RunState.Rendering) return false;
  return state.steering === Steering.Person || hasHardware(state);
}

/** Whether nothing but the rest that this page asked for has ended: its device lets go, or has let go. */
export function restHolds({ runState, rested }: Pick<WorldStateT, 'runState' | 'rested'>): boolean {
  return runState === RunState.Rendering || (rested && (runState === RunState.Stopping || runState === RunState.Stopped));
}

/** The first that applies, the most serious first. */
export function pageState(s: Situation, script: Script | null, state: WorldStateT | null, panel: ExercisePanel | null = null): PageState {
  if (s.problem) return 'version';
  if (!s.everOpen && s.attempts > 0) return 'absent';
  if (s.everOpen && s.status !== 'open') return 'lost';
  if (s.loading && state) return 'loading';
  const run = state?.runState;
  if (s.resting === 'off' && state && restHolds(state)) return 'rest';
  if (run === RunState.Stopping || run === RunState.Stopped || run === RunState.Faulted) return 'stopped';
  if (s.framing && state) return 'framing';
  if (s.wish === 'undecided' || !state) return 'welcome';
  if (s.loss !== '' && s.wish === 'play') return 'left';
  if (s.resting === 'between') return 'rest';
  if (!isPlaying(s, state)) return 'watching';
  if (s.unseen !== 'no') return 'unseen';
  if (!script) return panel?.done(state) ? 'success' : 'free';
  return STAGES[figure(script, state, 'stage')] ?? 'reach';
}

export type Zone = 'none' | 'soft' | 'right' | 'strong' | 'stop' | 'wrong' | 'low' | 'high';

export interface Meter {
  readonly shown: boolean;
  readonly value: number;   // 0 .. 1 of the meter's length
  readonly low: number;     // where "just right" begins and ends
  readonly high: number;
  readonly zone: Zone;
  readonly label?: string;  // of another exercise than the bar
}

/** The first value of the panel that has a goal band. */
export function panelMeter(panel: ExercisePanel, state: WorldStateT): Meter | null {
  const value = panel.values(state).find(({ goal }) => goal !== null);
  if (!value?.goal || value.zone === '') return null;
  return { shown: true, value: value.share, low: value.goal.low, high: value.goal.high, zone: value.zone, label: value.label };
}

export function meterOf(script: Script, state: WorldStateT): Meter {
  const squeeze_n = figure(script, state, 'squeeze_n');
  const low_n = figure(script, state, 'squeeze_low_n', 1);
  const high_n = figure(script, state, 'squeeze_high_n', 2);
  const full_n = Math.max(figure(script, state, 'squeeze_full_n', 3), 1e-6);
  const part = (force_n: number) => Math.min(1, Math.max(0, force_n / full_n));
  const stage = figure(script, state, 'stage');
  const engaged = figure(script, state, 'engaged_dispenser', -1);
  const wrong = engaged >= 0 && engaged !== figure(script, state, 'target_dispenser', -1) && stage !== Stage.LetGo;
  const past = stage === Stage.LetGo || figure(script, state, 'poured_l') > figure(script, state, 'asked_l', Infinity);
  const felt: Zone = squeeze_n < 0.1 * low_n ? 'none' : squeeze_n < low_n ? 'soft' : squeeze_n <= high_n ? 'right' : 'strong';
  const zone = felt === 'none' ? 'none' : wrong ? 'wrong' : past ? 'stop' : felt;
  return {
    shown: stage === Stage.Squeeze || stage === Stage.Pour || stage === Stage.LetGo || (stage === Stage.Reach && zone !== 'none'),
    value: part(squeeze_n), low: part(low_n), high: part(high_n), zone,
  };
}

/** Whether a drink or the level is done, and the guest has it. */
export function praiseStage(script: Script, state: WorldStateT): boolean {
  const stage = figure(script, state, 'stage');
  return stage === Stage.DrinkDone || stage === Stage.LevelDone;
}

export interface RecipeRow {
  readonly liquid: string;
  readonly asked_ml: number;
  readonly got_ml: number;
  readonly is: 'done' | 'now' | 'later';
}

export interface RecipeView {
  readonly name: string;
  readonly drink: number;     // from 1
  readonly drinks: number;
  readonly rows: readonly RecipeRow[];
}

/** Amounts in whole millilitres: nothing finer can be seen or asked for. */
export const millilitres = (litres: number): number => Math.round(1000 * litres);

export function currentDrink(script: Script, state: WorldStateT): Recipe | undefined {
  return script.drinks[Math.min(script.drinks.length - 1, Math.max(0, figure(script, state, 'drink')))];
}

export function recipeOf(script: Script, state: WorldStateT): RecipeView | null {
  const drink = currentDrink(script, state);
  if (!drink) return null;
  const done = praiseStage(script, state) ? drink.steps.length : figure(script, state, 'step');
  return {
    name: drink.name,
    drink: figure(script, state, 'drink') + 1,
    drinks: Math.max(figure(script, state, 'drinks', script.drinks.length), 1),
    rows: drink.steps.map((step, i) => ({
      liquid: step.liquid,
      asked_ml: millilitres(step.amount_l),
      got_ml: millilitres(i === done ? figure(script, state, 'poured_l') : figure(script, state, `layer_l/${i}`)),
      is: i < done ? 'done' : i === done ? 'now' : 'later',
    })),
  };
}

export interface Instruction {
  readonly title: TextKey;
  readonly more: TextKey;
  readonly liquid: string;   // for {x}
}

/** The bottle that is not asked for and was squeezed, until it is left; -1: none. Passing by another one is no fault. */
export function wrongBottle(script: Script, state: WorldStateT, before: number): number {
  const engaged = figure(script, state, 'engaged_dispenser', -1);
  if (engaged < 0 || engaged === figure(script, state, 'target_dispenser', -1)) return -1;
  const squeezed = figure(script, state, 'squeeze_n') > 0.3 * figure(script, state, 'squeeze_low_n', 1);
  return squeezed || engaged === before ? engaged : -1;
}

/** What to do now, one thing at a time. `wrong`: of wrongBottle(). */
export function instructionOf(script: Script, state: WorldStateT, wrong = wrongBottle(script, state, -1)): Instruction {
  const target = figure(script, state, 'target_dispenser', -1);
  const liquid = script.dispensers[target]?.liquid ?? '';
  switch (figure(script, state, 'stage')) {
    case Stage.Squeeze: return { title: 'game.squeeze', more: 'game.graspMore', liquid };
    case Stage.Pour: {
      const spilling = figure(script, state, 'flow_l_s') > 0 && figure(script, state, 'over_glass', 1) === 0;
      return spilling ? { title: 'game.offGlass', more: 'game.offGlassMore', liquid } : { title: 'game.squeeze', more: 'game.squeezeMore', liquid };
    }
    case Stage.LetGo: return { title: 'game.letGo', more: 'game.letGoMore', liquid };
    case Stage.DrawBack: return { title: 'game.drawBack', more: 'game.drawBackMore', liquid };
    default: {
      if (wrong >= 0) return { title: 'game.wrong', more: 'game.wrongMore', liquid: script.dispensers[wrong]?.liquid ?? '' };
      return { title: 'game.reach', more: 'game.reachMore', liquid };
    }
  }
}

export interface CallOut { readonly shown: boolean; readonly got_ml: number; readonly asked_ml: number }

/** The amount beside the line on the glass. */
export function callOutOf(script: Script, state: WorldStateT): CallOut {
  const stage = figure(script, state, 'stage');
  return {
    shown: stage === Stage.Squeeze || stage === Stage.Pour || stage === Stage.LetGo,
    got_ml: millilitres(figure(script, state, 'poured_l')),
    asked_ml: millilitres(figure(script, state, 'asked_l')),
  };
}

export interface Praise {
  readonly drink: string;
  readonly stars: number;
  readonly filled_percent: number;
  readonly spilt_ml: number;
  readonly time_s: number;
  readonly levelDone: boolean;   // or this was its last drink: the level ends by itself
}

/** How near the layers are to what was asked, over the drink; 100 is exact, 0 nothing or twice as much. */
export function filledPercent(recipe: Recipe, layers_l: readonly number[]): number {
  const asked_l = recipe.steps.reduce((sum, step) => sum + step.amount_l, 0);
  const off_l = recipe.steps.reduce((sum, step, i) => sum + Math.abs((layers_l[i] ?? 0) - step.amount_l), 0);
  return asked_l > 0 ? Math.round(100 * Math.max(0, 1 - off_l / asked_l)) : 0;
}

/** `spiltBefore_l`: of the level, when this drink began. */
export function praiseOf(script: Script, state: WorldStateT, spiltBefore_l: number): Praise | null {
  const drink = currentDrink(script, state);
  if (!drink) return null;
  return {
    drink: drink.name,
    stars: Math.max(0, Math.min(3, Math.round(figure(script, state, 'stars')))),
    filled_percent: filledPercent(drink, drink.steps.map((_, i) => figure(script, state, `layer_l/${i}`))),
    spilt_ml: Math.max(0, millilitres(figure(script, state, 'spilt_l') - spiltBefore_l)),
    time_s: figure(script, state, 'drink_time_s'),
    levelDone: figure(script, state, 'stage') === Stage.LevelDone || figure(script, state, 'drink') + 1 >= figure(script, state, 'drinks', 1),
  };
}

/** 72 s as "1:12". */
export function clock(time_s: number): string {
  const whole = Math.max(0, Math.round(time_s));
  return `${Math.floor(whole / 60)}:${String(whole % 60).padStart(2, '0')}`;
}

/** Why the run stopped by itself; empty after a stop that somebody asked for. */
export function causeOf(script: Script | null, state: WorldStateT): string {
  if (state.runState !== RunState.Faulted || !script) return '';
  return faultsOf(script.faultNames, state.latchedFaults).filter((name) => name !== 'stop requested').map(faultWord).join(', ');
}

/** What there is to do, by which hints wait; '' where there is nothing, or it is being done. */
export function taskOf(now: PageState, script: Script, state: WorldStateT): string {
  const waits = now === 'reach' || now === 'drawback' || now === 'letgo' || (now === 'squeeze' && figure(script, state, 'flow_l_s') === 0);
  return waits ? `${now} ${figure(script, state, 'drink')} ${figure(script, state, 'step')}` : '';
}

/** What a hint says beside the instruction. */
export function hintOf(now: PageState, help: 'full' | 'some' | 'none'): TextKey {
  if (now === 'reach') return help === 'full' ? 'hint.press' : 'hint.forward';
  if (now === 'squeeze') return help === 'full' ? 'hint.again' : 'hint.hold';
  return now === 'letgo' ? 'hint.open' : 'hint.back';
}
