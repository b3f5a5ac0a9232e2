// Measures of a person's performance while mixing a drink: the amounts, and the steadiness of the squeeze.
import type { WorldStateT } from '../../protocol';
import type { ExerciseValues } from '../values';
import { DRIP_L_S, type BarDrink } from './bar';
import { nameOf, text } from './i18n';

/** A grip counts as steady up to this standard deviation of the squeeze, relative to its mean. */
const STEADY_SHARE = 0.25;
/** Minimum pouring time for a statement about the grip [s]. */
const LEAST_S = 1;
/** A longer gap between two states is not counted [s]. */
const GAP_S = 0.25;
/** Minimum share of the pouring time in the green band for praise. */
const MOSTLY = 0.7;

export interface Grip { readonly steady: boolean; readonly rightShare: number }

/** Measures the squeeze while liquid flows from the current bottle. */
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

  /** null: too little was poured. */
  grip(): Grip | null {
    if (this.time_s < LEAST_S || this.sum <= 0) return null;
    const mean = this.sum / this.time_s, variance = Math.max(0, this.squares / this.time_s - mean * mean);
    return { steady: Math.sqrt(variance) <= STEADY_SHARE * mean, rightShare: this.right_s / this.time_s };
  }
}

/** The step that is farthest from the asked amount, in whole millilitres; positive: too much. */
export function farthestStep(drink: BarDrink, layers_l: readonly number[]): { liquid: string; off_ml: number } {
  const steps = drink.steps.map(({ liquid, amount_l }, i) => ({ liquid, off_ml: Math.round(1000 * ((layers_l[i] ?? 0) - amount_l)) }));
  return steps.reduce((worst, step) => (Math.abs(step.off_ml) > Math.abs(worst.off_ml) ? step : worst), { liquid: '', off_ml: 0 });
}

/** Praise for the grip: only for the person's own hand, and only if positive. */
export function gripWord(grip: Grip | null, own: boolean): '' | 'steady' | 'right' {
  if (!grip || !own) return '';
  if (grip.steady) return 'steady';
  return grip.rightShare >= MOSTLY ? 'right' : '';
}

/** A text on the person's performance: the accuracy of the amounts, and the grip. */
export function effortText(drink: BarDrink, layers_l: readonly number[], grip: '' | 'steady' | 'right'): string {
  const { liquid, off_ml } = farthestStep(drink, layers_l);
  const amount = Math.abs(off_ml) <= 1 ? text('effort.exact') : text(off_ml > 0 ? 'effort.over' : 'effort.under', { a: Math.abs(off_ml) });
  const named = drink.steps.length > 1 && Math.abs(off_ml) > 1 ? text('effort.of', { x: nameOf('liquid', liquid), y: amount }) : amount;
  return `${[named, grip && text(`effort.${grip}`)].filter(Boolean).join(', ')}.`;
}
