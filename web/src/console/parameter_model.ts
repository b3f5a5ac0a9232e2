import type { ParameterT } from '../protocol';
import { asWords } from '../shared/format';
import { niceStep } from './scale';

/**
 * The value that a slider's position stands for. Its steps begin at the lower end; the step nearest to the program's
 * initial value stands for exactly that value.
 */
export function meantBySlider(shown: number, initial: number, step: number): number {
  return Math.abs(shown - initial) <= 0.501 * step ? initial : shown;
}

/** The display form of a parameter: people read mm, ° and %, the program reads SI units. */
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
  if (unit === 'l' && Math.abs(upper) < 1) return ['ml', 1000];
  if (unit === 'rad') return ['°', 180 / Math.PI];
  if (unit === '' || unit === '1') return ['×', 1];
  return [unit, 1];
}

// The wire carries floats: 0.3 arrives as 0.30000001192.
export function roundAway(value: number): number {
  return Number(value.toPrecision(6));
}

/** The program's value of a typed number, with comma or point; undefined if it is not a number in the range. */
export function parsed(text: string, view: ParameterView): number | undefined {
  const value = Number(text.trim().replace(',', '.').replace('−', '-'));
  if (text.trim() === '' || !Number.isFinite(value)) return undefined;
  if (value < view.lower || value > view.upper) return undefined;
  return value / view.factor;
}

/** A value that stands still, or a request without an answer, for longer than this is given up. Time as the program's states give it (ConsoleModel.stated_ms) [ms]. */
const STANDS_MS = 1500;
/** An earlier ramp may continue for this long until the program has the newer value [ms]. */
const ANSWER_MS = 300;

/**
 * The requested and the present value of a parameter: while its ramp runs, `target` is the value that it goes to. The
 * request ends with a refusal, with a value that moves away from it (another console requested another one), or with
 * a value that stands still short of it.
 */
export class ParameterTarget {
  private asked: number | undefined;
  private present: number;
  private moved_ms = 0;

  constructor(initial: number) {
    this.present = initial;
  }

  get now(): number {
    return this.present;
  }

  /** The end of the ramp; undefined when none is under way. */
  get target(): number | undefined {
    return this.asked;
  }

  /** The value that the controls show: the requested one while it is under way, else the present one. */
  get shown(): number {
    return this.asked ?? this.present;
  }

  /** @param now_ms time of the program's states: a page that stood still keeps its request */
  ask(value: number, now_ms: number): void {
    this.asked = value;
    this.moved_ms = now_ms;
  }

  refuse(): void {
    this.asked = undefined;
  }

  /** Updates the present value; the ramp ends when it equals the request up to the precision of floats. */
  onState(value: number, now_ms: number): void {
    const before = this.present;
    this.present = value;
    if (this.asked === undefined) return;
    const close = 1e-5 * Math.max(Math.abs(this.asked), 1e-3);
    const nearer = Math.abs(before - this.asked) - Math.abs(value - this.asked);
    if (nearer > 0) this.moved_ms = now_ms;
    const elsewhere = nearer < -close && now_ms - this.moved_ms > ANSWER_MS;
    if (Math.abs(value - this.asked) <= close || elsewhere || now_ms - this.moved_ms > STANDS_MS) this.asked = undefined;
  }
}
