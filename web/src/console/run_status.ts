import type { ConnectionStatus } from '../net/connection';
import { RunState, type WorldStateT } from '../protocol';
import { fill } from '../shared/i18n';
import type { ConsoleTexts } from './i18n/en';

export type StatusName = keyof ConsoleTexts['states'];

export interface Status {
  name: StatusName;
  /** 0 Disarmed, 1 Rendering, 2 Stopping, 3 Stopped or Faulted; undefined without a program. */
  step: number | undefined;
  bad: boolean;
  /** One line: the state's cause. */
  cause: string;
  /** What the system did or will do. */
  did: string;
}

const NAMES: Readonly<Record<RunState, StatusName>> = {
  [RunState.Disarmed]: 'disarmed',
  [RunState.Rendering]: 'rendering',
  [RunState.Stopping]: 'stopping',
  [RunState.Stopped]: 'stopped',
  [RunState.Faulted]: 'faulted',
};
const STEPS: Readonly<Record<string, number>> = { disarmed: 0, rendering: 1, paused: 1, stopping: 2, stopped: 3, faulted: 3 };

/** Names of the bits that are set, in the page's language where it knows them. */
export function faultWords(bits: number, names: readonly string[], texts: ConsoleTexts): string[] {
  return names.filter((_, bit) => ((bits >>> bit) & 1) === 1).map((name) => texts.faults[name] ?? name);
}

/** What the state of the program means to a therapist. */
export function statusOf(
  connection: ConnectionStatus, state: Pick<WorldStateT, 'runState' | 'latchedFaults'> | null,
  paused: boolean, faultNames: readonly string[], texts: ConsoleTexts,
): Status {
  const t = texts.safety;
  if (connection === 'lost') return { name: 'lost', step: undefined, bad: true, cause: t.lost, did: t.lostWhat };
  if (connection === 'connecting' || !state) {
    return { name: 'connecting', step: undefined, bad: false, cause: texts.states.connecting, did: texts.pill.connecting };
  }
  const running = NAMES[state.runState] ?? 'faulted';
  const name = running === 'rendering' && paused ? 'paused' : running;
  const status = { name, step: STEPS[name], bad: name === 'faulted' };
  switch (name) {
    case 'disarmed': return { ...status, cause: t.disarmed, did: t.disarmedWhat };
    case 'stopping': return { ...status, cause: t.stopping, did: t.stoppingWhat };
    case 'stopped': return { ...status, cause: t.stopped, did: t.stoppedWhat };
    case 'faulted': {
      // The stop that follows a fault is not its cause.
      const cause = faultWords(state.latchedFaults, faultNames, texts)
        .filter((word) => word !== texts.faults['stop requested']).join(', ');
      return { ...status, cause: fill(t.cause, { what: cause || '?' }), did: t.faultedWhat };
    }
    default: return { ...status, cause: t.noFault, did: '' };
  }
}
