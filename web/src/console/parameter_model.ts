import type { ParameterT } from '../protocol';
import { asWords } from './format';
import { niceStep } from './scale';

/** How a parameter is shown: people read mm, ° and %, the program reads SI. */
export interface ParameterView {
  name: string;
  group: number;
  label: string;
  unit: string;
  /** Shown value = program's value × factor. */
  factor: number;
  decimals: number;
  lower: number;
  upper: number;
  step: number;
}

export function viewOf(parameter: ParameterT, labels: Readonly<Record<string, string>>): ParameterView {
  const name = String(parameter.name);
  const [unit, factor] = shownUnit(String(parameter.unit ?? ''), parameter.upper);
  const lower = roundAway(parameter.lower * factor);
  const upper = roundAway(parameter.upper * factor);
  const step = niceStep(upper - lower, 100);
  return {
    name, group: parameter.group, label: labels[name] ?? asWords(name), unit, factor, lower, upper, step,
    decimals: Math.max(0, Math.min(4, -Math.floor(Math.log10(step) + 1e-9))),
  };
}

function shownUnit(unit: string, upper: number): [string, number] {
  if (unit === 'm' && Math.abs(upper) < 1) return ['mm', 1000];
  if (unit === 'rad') return ['°', 180 / Math.PI];
  if (unit === '' || unit === '1') return ['×', 1];
  return [unit, 1];
}

// The wire carries floats: 0.3 arrives as 0.30000001192.
function roundAway(value: number): number {
  return Number(value.toPrecision(6));
}

/** The program's value of what a person typed, comma or point; undefined: no number of the range. */
export function parsed(text: string, view: ParameterView): number | undefined {
  const value = Number(text.trim().replace(',', '.').replace('−', '-'));
  if (text.trim() === '' || !Number.isFinite(value)) return undefined;
  if (value < view.lower || value > view.upper) return undefined;
  return value / view.factor;
}

/**
 * A parameter between what is asked for and what is: while its ramp runs, `target` says where it
 * goes; a refusal puts it back to what is.
 */
export class ParameterTarget {
  private asked: number | undefined;
  private present: number;

  constructor(initial: number) {
    this.present = initial;
  }

  get now(): number {
    return this.present;
  }

  /** Where the ramp goes; undefined when there is none under way. */
  get target(): number | undefined {
    return this.asked;
  }

  /** What the controls show: what was asked for while it is under way, else what is. */
  get shown(): number {
    return this.asked ?? this.present;
  }

  ask(value: number): void {
    this.asked = value;
  }

  refuse(): void {
    this.asked = undefined;
  }

  /** Takes the program's present value; the ramp ends when it is as near as floats come. */
  see(value: number): void {
    this.present = value;
    if (this.asked === undefined) return;
    const close = 1e-5 * Math.max(Math.abs(this.asked), 1e-3);
    if (Math.abs(value - this.asked) <= close) this.asked = undefined;
  }
}
