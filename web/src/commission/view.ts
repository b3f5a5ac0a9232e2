// The content of the page, derived from the program's messages by pure functions.
import type { ConnectionStatus } from '../net/connection';
import type { Hands } from '../net/holding';
import { QuestionKind, MotionState, Role, StepState, type CommissioningT, type FindingT } from '../protocol';

/** The current task of the person. */
export type Task =
  | 'connecting'   // no message came yet
  | 'lost'
  | 'elsewhere'    // the program commissions nothing
  | 'watch'        // another console leads, or this role may not lead
  | 'lead'         // nobody leads: a press takes the lead
  | 'yes-no' | 'number' | 'done' | 'next'
  | 'hold'         // a button must be held, or is held
  | 'wait'         // the program works
  | 'finished';

const TASK_OF: Readonly<Record<QuestionKind, Task>> = {
  [QuestionKind.Nothing]: 'wait', [QuestionKind.ThisDevice]: 'yes-no', [QuestionKind.NobodyAttached]: 'yes-no', [QuestionKind.PushAway]: 'done',
  [QuestionKind.Travel]: 'number', [QuestionKind.KnownForce]: 'number', [QuestionKind.EmergencyStop]: 'done', [QuestionKind.NextStep]: 'next',
};

export function taskOf(c: CommissioningT | null, status: ConnectionStatus, hands: Hands, heardElse: boolean): Task {
  if (c && String(c.passport ?? '') !== '') return 'finished';
  if (status === 'lost') return 'lost';
  if (!c) return heardElse ? 'elsewhere' : 'connecting';
  if (!hands.heldByYou) return hands.role === Role.Therapist && !hands.held ? 'lead' : 'watch';
  if (c.asked !== QuestionKind.Nothing) return TASK_OF[c.asked];
  return holds(c) ? 'hold' : 'wait';
}

/** The button stays in place, and held, between two moves of one step. */
function holds(c: CommissioningT): boolean {
  if (c.motionState !== MotionState.Over) return true;
  return c.steps.some((step) => step.state === StepState.UnderWay && MOVING.includes(String(step.name)));
}
const MOVING = ['home', 'signs', 'gravity', 'mass-friction-delay', 'known-weight', 'watchdog', 'emergency-stop', 'range-stops', 'effort-limit'];

/** Index of the step that is under way or failed last; -1: none. */
export function stepNow(c: CommissioningT): number {
  const under_way = c.steps.findIndex((step) => step.state === StepState.UnderWay);
  return under_way >= 0 ? under_way : c.steps.findIndex((step) => step.state === StepState.Failed);
}

/** Steps that may be repeated: all before them are done. */
export function repeatable(c: CommissioningT): string[] {
  if (c.daily) return [];
  const first = c.steps.findIndex((step) => step.state !== StepState.Done);
  return c.steps.slice(0, first < 0 ? c.steps.length : first).map((step) => String(step.name));
}

/** Formats a range with three significant figures of the larger end and equal decimals: "0.98 to 1.02". */
export function numbers(finding: Pick<FindingT, 'lower' | 'upper'>, to: string): string {
  const largest = Math.max(Math.abs(finding.lower), Math.abs(finding.upper));
  const decimals = largest > 0 ? Math.min(6, Math.max(0, 2 - Math.floor(Math.log10(largest)))) : 0;
  const one = (value: number): string => value.toFixed(decimals).replace(/^-(0(\.0*)?)$/, '$1').replace('-', '−');
  return finding.lower === finding.upper ? one(finding.lower) : `${one(finding.lower)} ${to} ${one(finding.upper)}`;
}

/** A typed number in the program's format; empty if it is not a number above 0. */
export function typedNumber(words: string): string {
  const plain = words.trim().replace(',', '.');
  return /^\d*\.?\d+(e-?\d+)?$/i.test(plain) && Number(plain) > 0 ? plain : '';
}
