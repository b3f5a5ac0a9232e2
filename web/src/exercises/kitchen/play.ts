// A kitchen task in the game: its steps as a card, instruction, praise. The task's texts are its panel's.
import type { SceneT, WorldStateT } from '../../protocol';
import { fixed } from '../../shared/format';
import type { Bells, Chime, ExerciseWords, FlowSound, Meter, Phase, Play, Praise, Prompt, TaskCard, TaskStep } from '../exercise';
import type { ExercisePanel } from '../panel';
import { PanelPlay } from '../panel_play';
import { ExerciseValues } from '../values';
import { text } from './i18n';
import { stepPicture, verbDisc } from './pictures';
import { armOf, placedOf } from './joint';
import { askedOf, jointOf, metAt, pointMet, type KitchenStep, type KitchenTask, type Verb } from './task';

/** Minimum scores for two and for three stars. */
const TWO_STARS = 70;
const THREE_STARS = 90;
/** Number of rows on a card beside a meter: the last, the present one, the next. */
const MOST_ROWS = 3;
const STEP: Bells = { tones_hz: [523, 784], apart_s: 0.14 };
const ALL: Bells = { tones_hz: [392, 523, 659, 784, 1047], apart_s: 0.17 };

/** Sound of motion: silent below the first speed, loud at the second; it knocks within this distance of its end when it came at this speed [m/s, m]. */
const STILL_M_S = 0.006;
const FAST_M_S = 0.15;
const KNOCKS_M_S = 0.02;
const END_M = 0.004;
const KNOCK: Bells = { tones_hz: [196, 147], apart_s: 0.03 };

const PHASES: Readonly<Record<Verb, Phase>> = { reach: 'reach', take: 'squeeze', move: 'hold', hold: 'hold', press: 'hold', put: 'hold', let_go: 'letgo' };

/** Share of a step that is done, 0 .. 1. @param from the joint's coordinate when the step began */
export function shareOf({ verb, to, for_s }: KitchenStep, q: number, from: number, held_s: number): number {
  const share = verb === 'move' && to !== undefined && Math.abs(to - from) > 1e-6 ? (q - from) / (to - from)
    : for_s ? held_s / for_s : 0;
  return Math.max(0, Math.min(1, share));
}

export class KitchenPlay implements Play {
  readonly panel = null;
  readonly chimes: Readonly<Record<string, Chime>> = { step_done: STEP, level_done: ALL };
  readonly words: ExerciseWords;
  private readonly values: ExerciseValues;
  private readonly plain: PanelPlay;
  private wasDone = true;
  private step = -1;
  private from = 0;   // coordinate of the present step's joint when it began
  private last: { readonly q: number; readonly time_s: number } | undefined;
  private speed_m_s = 0;   // speed of the moved body at the contact point
  private knocks = false;

  constructor(private readonly task: KitchenTask, private readonly shown: ExercisePanel, private readonly scene: SceneT) {
    this.values = new ExerciseValues(scene.valueNames);
    this.plain = new PanelPlay(shown, scene);
    const pushed = task.steps[0]?.met?.means === 'push';
    this.words = {
      ...this.plain.words,
      oneButton: () => ({ press: text('oneButton.press'), point: text('oneButton.point') }),
      steps: (skin) => ([1, 2, 3] as const).map((n) => ({ picture: stepPicture(n, skin, pushed), title: text(pushed ? `welcome.push${n}` : `welcome.step${n}`), more: text(pushed ? `welcome.push${n}More` : `welcome.step${n}More`) })),
    };
  }

  /** The exercise starts again after a restart. */
  follow(state: WorldStateT): boolean {
    const done = this.shown.done(state), begins = this.wasDone && !done, step = this.values.get(state, 'instruction');
    if (step !== this.step) this.from = this.values.get(state, 'joint_q');
    this.step = step;
    this.listen(state);
    this.wasDone = done;
    return begins;
  }

  phase(state: WorldStateT): Phase {
    const step = this.now(state);
    return step && !this.shown.done(state) ? PHASES[step.verb] : 'success';
  }

  atStart(state: WorldStateT): boolean { return !this.shown.done(state) && this.values.get(state, 'instruction') === 0; }
  isPaused(state: WorldStateT): boolean { return this.plain.isPaused(state); }

  prompt(state: WorldStateT): Prompt {
    const step = this.now(state);
    return { title: this.plain.prompt(state).title, more: step ? text(this.leaves(step) ? 'more.leave' : `more.${step.verb}`) : '', steady: step !== undefined && PHASES[step.verb] === 'hold' };
  }

  donePrompt(state: WorldStateT): Prompt { return { title: this.shown.instruction(state), more: '' }; }
  watchedTitle(state: WorldStateT): string { return this.shown.instruction(state); }

  /** No task is named while a handle moves. */
  todo(state: WorldStateT): string {
    const step = this.now(state);
    return step && (step.verb !== 'hold') ? `${this.values.get(state, 'instruction')} ${step.verb === 'move' ? this.values.get(state, 'joint_q').toFixed(2) : ''}` : '';
  }

  goal(): null { return null; }

  /** A meter of the joint's coordinate in its range, or of the asked force. */
  meter(state: WorldStateT): Meter | null {
    const { values } = this, low = values.get(state, 'goal_low'), high = values.get(state, 'goal_high'), step = this.now(state);
    const joint = step && jointOf(this.task, step.body);
    if (step?.verb === 'press') {
      const share = values.get(state, 'handle_n') / Math.max(askedOf(step, this.scene, state), 1e-6);
      return { shown: true, value: Math.min(1, share / 2), low: 0.5, high: 1, zone: share >= 1 ? 'right' : 'low', label: text('verb.press') };
    }
    if (!joint || step.to === undefined || high <= low) return null;
    const least = joint.least ?? Math.min(0, low), most = joint.most ?? 1.25 * Math.max(high, ...this.task.steps.map(({ to }) => to ?? 0));
    const share = (q: number): number => Math.max(0, Math.min(1, (q - least) / (most - least)));
    const q = values.get(state, 'joint_q'), isWell = q >= low && q <= high;
    return { shown: true, value: share(q), low: share(low), high: share(high), zone: isWell ? 'right' : 'low', label: text(`verb.${step.verb}`) };
  }

  /** A row for each step; of many steps those around the present one. */
  card(state: WorldStateT): TaskCard {
    const { steps } = this.task, all = this.shown.done(state) ? steps.length : this.values.get(state, 'instruction');
    const rows = steps.map((step, i): TaskStep => {
      const now = i === all, share = now ? shareOf(step, this.values.get(state, 'joint_q'), this.from, this.values.get(state, 'held_s')) : 0;
      return {
        key: `${i}-${step.verb}`, name: text(`verb.${step.verb}`), is: i < all ? 'done' : now ? 'now' : 'later', done: Math.round(100 * share), asked: 100,
        ...this.amounts(step, state), picture: () => verbDisc(step.verb),
      };
    });
    const first = Math.max(0, Math.min(all - 1, rows.length - MOST_ROWS));
    return { label: this.shown.title, count: text('count', { n: Math.min(all, steps.length), m: steps.length }), title: this.shown.title, steps: rows.slice(first, first + MOST_ROWS) };
  }

  praise(state: WorldStateT, ownGrip: boolean): Praise {
    const score = this.values.get(state, 'score');
    return { ...this.plain.praise(state), effort: text(ownGrip ? 'done.effort' : 'done.helped'), stars: score >= THREE_STARS ? 3 : score >= TWO_STARS ? 2 : 1 };
  }

  /** The sound of motion: wood on wood, higher with speed. */
  flow(): { rate: number; level: number; sound: FlowSound } {
    const rate = this.speed_m_s < STILL_M_S ? 0 : Math.min(1, this.speed_m_s / FAST_M_S);
    return { rate, level: rate, sound: 'slide' };
  }

  /** A knock when the body meets its end. */
  takeChime(): Chime | undefined {
    const knocks = this.knocks;
    this.knocks = false;
    return knocks ? KNOCK : undefined;
  }

  private listen(state: WorldStateT): void {
    const { task, values, last } = this, step = this.now(state), joint = step && jointOf(task, step.body), now = step && placedOf(state.bodies[step.body]);
    const q = values.get(state, 'joint_q'), dt_s = state.timeS - (last?.time_s ?? Infinity), was_m_s = this.speed_m_s;
    this.last = { q, time_s: state.timeS };
    if (!joint || !now || !last || !(dt_s > 0)) {
      if (dt_s !== 0) this.speed_m_s = 0;
      return;
    }
    const arm = armOf(now, joint, pointMet(task, this.scene.bodies[step.body]!, step.body, metAt(task, this.step)));
    this.speed_m_s = Math.abs(q - last.q) * arm / dt_s;
    const left = Math.min(q - (joint.least ?? -Infinity), (joint.most ?? Infinity) - q) * arm;
    this.knocks ||= left < END_M && was_m_s > KNOCKS_M_S && this.speed_m_s < was_m_s / 2;
  }

  /** Whether the step releases a body that was not closed around, so that there is nothing to hold. */
  private leaves({ verb }: KitchenStep): boolean { return verb === 'let_go' && metAt(this.task, this.step)?.means === 'push'; }

  private now(state: WorldStateT): KitchenStep | undefined { return this.task.steps[this.values.get(state, 'instruction')]; }

  /** The asked amount of a step, and the amount so far. */
  private amounts(step: KitchenStep, state: WorldStateT): { askedWords: string; doneWords: string } {
    const a = fixed(this.values.get(state, 'held_s'), 1);
    if (step.for_s) return { askedWords: text('hold', { a: step.for_s }), doneWords: text('holdOf', { a, b: step.for_s }) };
    return { askedWords: '', doneWords: step.verb === 'move' ? text('partOf', { a: Math.round(100 * shareOf(step, this.values.get(state, 'joint_q'), this.from, 0)) }) : '' };
  }
}
