// What is measured of a person's effort while a drink is mixed: the amounts, and how steadily the bottle is squeezed.
import type { WorldStateT } from '../../protocol';
import type { ExerciseValues } from '../values';
import { DRIP_L_S, type BarDrink } from './bar';
import { nameOf, text } from './i18n';

/** A grip is called steady up to this standard deviation of the squeeze, as a part of its mean. */
const STEADY_SHARE = 0.25;
/** Less pouring says nothing about the grip [s]. */
const LEAST_S = 1;
/** States farther apart than this are no stretch of time that was watched [s]. */
const GAP_S = 0.25;
/** Of the pouring in the green band, from which on that is worth saying. */
const MOSTLY = 0.7;

export interface Grip { readonly steady: boolean; readonly rightShare: number }

/** Watches the squeeze while it flows from the bottle that is asked for. */
export class EffortMeter {
  private time_s = 0;
  private sum = 0;
  private squares = 0;
  private right_s = 0;
  private last_s = NaN;

  begin(): void { this.time_s = this.sum = this.squares = this.right_s = 0; }

  look(values: ExerciseValues, state: WorldStateT, now_s: number): void {
    const dt_s = now_s - this.last_s;
    this.last_s = now_s;
    const engaged = values.get(state, 'engaged_dispenser', -1);
    const pours = values.get(state, 'flow_l_s') > DRIP_L_S && engaged >= 0 && engaged === values.get(state, 'target_dispenser', -1);
    if (!pours || !(dt_s > 0) || dt_s > GAP_S) return;
    const squeeze_n = values.get(state, 'squeeze_n');
    this.time_s += dt_s;
    this.sum += squeeze_n * dt_s;
    this.squares += squeeze_n * squeeze_n * dt_s;
    if (squeeze_n >= values.get(state, 'squeeze_low_n', 1) && squeeze_n <= values.get(state, 'squeeze_high_n', 2)) this.right_s += dt_s;
  }

  /** null: too little was poured to say. */
  grip(): Grip | null {
    if (this.time_s < LEAST_S || this.sum <= 0) return null;
    const mean = this.sum / this.time_s, variance = Math.max(0, this.squares / this.time_s - mean * mean);
    return { steady: Math.sqrt(variance) <= STEADY_SHARE * mean, rightShare: this.right_s / this.time_s };
  }
}

/** The step that is farthest from what was asked, in whole millilitres: more than asked is positive. */
export function farthestStep(drink: BarDrink, layers_l: readonly number[]): { liquid: string; off_ml: number } {
  const steps = drink.steps.map(({ liquid, amount_l }, i) => ({ liquid, off_ml: Math.round(1000 * ((layers_l[i] ?? 0) - amount_l)) }));
  return steps.reduce((worst, step) => (Math.abs(step.off_ml) > Math.abs(worst.off_ml) ? step : worst), { liquid: '', off_ml: 0 });
}

/** What can be said of the grip: only where the person's own hand squeezed, and only what is good. */
export function gripWord(grip: Grip | null, own: boolean): '' | 'steady' | 'right' {
  if (!grip || !own) return '';
  if (grip.steady) return 'steady';
  return grip.rightShare >= MOSTLY ? 'right' : '';
}

/** What is true of the person's effort: how near the amounts are, and how the bottle was held. */
export function effortText(drink: BarDrink, layers_l: readonly number[], grip: '' | 'steady' | 'right'): string {
  const { liquid, off_ml } = farthestStep(drink, layers_l);
  const amount = Math.abs(off_ml) <= 1 ? text('effort.exact') : text(off_ml > 0 ? 'effort.over' : 'effort.under', { a: Math.abs(off_ml) });
  const named = drink.steps.length > 1 && Math.abs(off_ml) > 1 ? text('effort.of', { x: nameOf('liquid', liquid), y: amount }) : amount;
  return `${[named, grip && text(`effort.${grip}`)].filter(Boolean).join(', ')}.`;
}
