// What the page shows, from what the program says. Pure.
import type { ConnectionStatus } from '../net/connection';
import type { Hands } from '../net/holding';
import { Asked, MotionState, Role, StepState, type CommissioningT, type FindingT } from '../protocol';

/** What the person can do now. */
export type Task =
  | 'connecting'   // no message came yet
  | 'lost'
  | 'elsewhere'    // the program commissions nothing
  | 'watch'        // another console leads, or this role may not
  | 'lead'         // nobody leads: a press takes it
  | 'yes-no' | 'number' | 'done' | 'next'
  | 'hold'         // a button is to be held, or is
  | 'wait'         // the program works
  | 'finished';

const TASK_OF: Readonly<Record<Asked, Task>> = {
  [Asked.Nothing]: 'wait', [Asked.ThisDevice]: 'yes-no', [Asked.NobodyAttached]: 'yes-no', [Asked.PushAway]: 'done',
  [Asked.Travel]: 'number', [Asked.KnownForce]: 'number', [Asked.EmergencyStop]: 'done', [Asked.NextStep]: 'next',
};

export function taskOf(c: CommissioningT | null, status: ConnectionStatus, hands: Hands, heardElse: boolean): Task {
  if (c && String(c.passport ?? '') !== '') return 'finished';
  if (status === 'lost') return 'lost';
  if (!c) return heardElse ? 'elsewhere' : 'connecting';
  if (!hands.heldByYou) return hands.role === Role.Therapist && !hands.held ? 'lead' : 'watch';
  if (c.asked !== Asked.Nothing) return TASK_OF[c.asked];
  return holds(c) ? 'hold' : 'wait';
}

/** Between two moves of one step the button stays where it is, and held. */
function holds(c: CommissioningT): boolean {
  if (c.motionState !== MotionState.Over) return true;
  return c.steps.some((step) => step.state === StepState.UnderWay && MOVING.includes(String(step.name)));
}
const MOVING = ['home', 'signs', 'gravity', 'mass-friction-delay', 'known-weight', 'watchdog', 'emergency-stop', 'range-stops'];

/** The step that is under way, or that failed last; -1: none. */
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

/** Three significant figures of the larger end, as many decimals at both: "0.98 to 1.02". */
export function numbers(finding: Pick<FindingT, 'lower' | 'upper'>, to: string): string {
  const largest = Math.max(Math.abs(finding.lower), Math.abs(finding.upper));
  const decimals = largest > 0 ? Math.min(6, Math.max(0, 2 - Math.floor(Math.log10(largest)))) : 0;
  const one = (value: number): string => value.toFixed(decimals).replace(/^-(0(\.0*)?)$/, '$1').replace('-', '−');
  return finding.lower === finding.upper ? one(finding.lower) : `${one(finding.lower)} ${to} ${one(finding.upper)}`;
}

/** What a person typed as a number, as the program reads it; empty: it is none above 0. */
export function typedNumber(words: string): string {
  const plain = words.trim().replace(',', '.');
  return /^\d*\.?\d+(e-?\d+)?$/i.test(plain) && Number(plain) > 0 ? plain : '';
}
