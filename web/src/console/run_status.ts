import type { ConnectionStatus } from '../net/connection';
import { RunState, SafetyState, type WorldStateT } from '../protocol';
import { alarmWords } from '../shared/alarm';
import { significant } from '../shared/format';
import { faultWord, fill } from '../shared/i18n';
import type { ConsoleTexts } from './i18n/en';

export type StatusName = Exclude<keyof ConsoleTexts['states'], 'armed'>;

export interface Status {
  name: StatusName;
  /** 0 Disarmed, 1 Rendering, 2 Stopping, 3 Stopped or Faulted; undefined without a program. */
  step: number | undefined;
  bad: boolean;
  /** The cause of the state, in one line. */
  cause: string;
  /** The axis that exceeded a limit, which limit, and by how much. */
  excess?: string;
  /** The system's reaction. */
  did: string;
  /** The action that is expected of a person. */
  todo?: string;
  /** The cause in a few words for the header, where it is not the usual one of the name. */
  short?: string;
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
export function faultWords(bits: number, names: readonly string[]): string[] {
  return names.filter((_, bit) => ((bits >>> bit) & 1) === 1).map(faultWord);
}

/** Name of the emergency-stop bit in Scene.fault_names. */
const EMERGENCY_STOP = 'emergency stop';
const OF_SPEED: readonly string[] = ['speed limit exceeded', 'encoder jumped'];
const OF_TIME = 'gap too long';

/** The part of the state that contains the cause of a stop. */
export type ReportedStatus = Pick<WorldStateT, 'runState' | 'latchedFaults'>
  & Partial<Pick<WorldStateT, 'faults' | 'safetyState' | 'faultAxis' | 'faultValue' | 'faultLimit' | 'rehearsedTicks' | 'silent' | 'stopPending' | 'stopUnconfirmed' | 'device' | 'qM' | 'intention'>>;

/** An axis of the device, with the fields that its limit is reported in. */
export interface NamedAxis {
  name: string | Uint8Array | null;
  unit: string | Uint8Array | null;
}

/** Names of the faults that stop; a stop that only follows from a fault is not listed. */
function stoppingNames(bits: number, names: readonly string[]): string[] {
  return names.filter((name, bit) => ((bits >>> bit) & 1) === 1 && name !== 'stop requested' && name !== EMERGENCY_STOP);
}

/** The axis, its value and its limit: "x, away: 1.62 m/s, limit 1.5". Empty where nothing is known. */
function excessWords(state: ReportedStatus, faults: readonly string[], axes: readonly NamedAxis[], texts: ConsoleTexts): string {
  const axis = axes[state.faultAxis ?? -1];
  const limit = state.faultLimit ?? 0;
  const name = axis ? texts.axesLong[String(axis.name)] ?? String(axis.name) : '';
  if (limit === 0 || (!axis && !faults.includes(OF_TIME))) return name;
  const turns = axis && String(axis.unit) === 'rad';
  const scale = turns ? 180 / Math.PI : 1;
  const per = faults.some((fault) => OF_SPEED.includes(fault)) ? '/s' : '';
  const unit = axis ? `${turns ? '°' : String(axis.unit)}${per}` : 's';
  const shown = (value: number): string => significant(value * scale, 3);
  const much = fill(texts.safety.beyond, { value: `${shown(state.faultValue ?? 0)} ${unit}`, limit: shown(limit) });
  return name === '' ? much : `${name}: ${much}`;
}

function faultedStatus(state: ReportedStatus, faultNames: readonly string[], axes: readonly NamedAxis[], texts: ConsoleTexts): Pick<Status, 'cause' | 'excess' | 'did' | 'todo'> {
  const t = texts.safety;
  const faults = stoppingNames(state.latchedFaults, faultNames);
  const words = faults.map(faultWord).join(', ') || '?';
  const todo = faults.map((name) => texts.advice[name]).find((text) => text !== undefined) ?? texts.advice.other;
  return { cause: fill(t.cause, { what: words }), excess: excessWords(state, faults, axes, texts), did: t.faultedWhat, todo };
}

/** Nothing is said of an effort that nobody knows. */
function silentStatus(state: ReportedStatus, texts: ConsoleTexts): Status {
  const { stopUnconfirmed = false, device = null, qM = [], intention = [] } = state;
  const cause = alarmWords({ silent: true, stopUnconfirmed, device, qM, intention });
  return { name: 'silent', step: undefined, bad: true, cause, did: texts.safety.silentWhat };
}

/** What the loop itself has reported of a stop. */
function stoppingStatus({ stopPending, safetyState }: ReportedStatus, texts: ConsoleTexts): Pick<Status, 'cause' | 'did' | 'short'> {
  const t = texts.safety;
  if (stopPending) return { cause: t.heard, did: t.heardWhat, short: texts.pill.heard };
  if (safetyState === SafetyState.Disarmed) return { cause: t.atNeutral, did: t.atNeutralWhat, short: texts.pill.stopped };
  return { cause: t.stopping, did: t.stoppingWhat };
}

/** The meaning of the program's state for a therapist. */
export function statusOf(
  connection: ConnectionStatus, state: ReportedStatus | null,
  paused: boolean, faultNames: readonly string[], texts: ConsoleTexts, axes: readonly NamedAxis[] = [],
): Status {
  const t = texts.safety;
  if (state?.silent) return silentStatus(state, texts);
  if (connection === 'lost') return { name: 'lost', step: undefined, bad: true, cause: t.lost, did: t.lostWhat };
  if (connection === 'connecting' || !state) {
    return { name: 'connecting', step: undefined, bad: false, cause: texts.states.connecting, did: texts.pill.connecting };
  }
  const running = NAMES[state.runState] ?? 'faulted';
  const name = running === 'rendering' && paused ? 'paused' : running;
  const status = { name, step: STEPS[name], bad: name === 'faulted' };
  if (state.rehearsedTicks && running !== 'rendering') return { ...status, cause: t.rehearsing, did: fill(t.rehearsingWhat, { ticks: String(state.rehearsedTicks) }) };
  switch (name) {
    case 'disarmed': return { ...status, cause: t.disarmed, did: t.disarmedWhat };
    case 'stopping': return { ...status, ...stoppingStatus(state, texts) };
    case 'stopped': {
      const emergency = ((state.faults ?? 0) >>> faultNames.indexOf(EMERGENCY_STOP)) & 1;
      const known = faultNames.includes(EMERGENCY_STOP) && emergency === 1;
      return { ...status, cause: known ? t.emergency : t.stopped, did: t.stoppedWhat };
    }
    case 'faulted': return { ...status, ...faultedStatus(state, faultNames, axes, texts) };
    default:
      if (state.safetyState === SafetyState.Armed) return { ...status, cause: t.armed, did: t.armedWhat, short: texts.pill.armed };
      if (state.safetyState === SafetyState.Disarmed) return { ...status, cause: t.enabling, did: t.enablingWhat, short: texts.pill.enabling };
      return { ...status, cause: t.noFault, did: '' };
  }
}
