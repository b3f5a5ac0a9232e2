// The page's state as a pure function of its inputs. No texts, no elements.
import type { Phase, Play } from '../exercises/exercise';
import type { ConnectionStatus, VersionProblem } from '../net/connection';
import type { Hands, Loss } from '../net/holding';
import { RunState, Steering, type SceneT, type WorldStateT } from '../protocol';
import { hasHardware } from '../shared/hardware';
import { faultWord } from '../shared/i18n';

/** Bits of WorldState.faults; docs/safety.md. */
const OWNER_SILENT = 1 << 20;
const EMERGENCY_STOP = 1 << 11;

/** The phase of the task while the person plays; otherwise the obstacle to playing. */
export type PageState =
  | Phase | 'version' | 'silent' | 'absent' | 'lost' | 'loading' | 'stopped' | 'framing' | 'welcome' | 'left' | 'watching' | 'unseen' | 'rest' | 'ended';

/** 'between': the exercise is paused between two parts. 'off': the device was released at this person's wish. */
export type RestState = 'no' | 'between' | 'off';

/** 'lost': the browser lost the picture. 'back': it is there again, and the person has not continued yet. */
export type PictureLoss = 'no' | 'lost' | 'back';

export interface Situation {
  readonly status: ConnectionStatus;
  readonly problem: VersionProblem | null;
  readonly everOpen: boolean;      // the program has answered since the page was opened
  readonly attempts: number;       // failed attempts since it was last there
  readonly wish: 'undecided' | 'play' | 'watch';
  readonly loading: boolean;       // this page's orders are under way that stop the run for a moment
  readonly resting: RestState;
  readonly framing: boolean;       // the camera is open and waits for a hand in its frame
  readonly unseen: PictureLoss;         // state of the picture that the person plays by
  readonly loss: Loss;             // why this page lost the controls
  readonly held: Pick<Hands, 'heldByYou' | 'held'>;
  readonly visit?: 'none' | 'open' | 'over';   // of the clinic's records
}

/** Whether the exercise's effort is faded out: the page that held the controls was lost, and nobody has taken them since. */
export function isFaded(state: WorldStateT): boolean {
  return (state.faults & OWNER_SILENT) !== 0;
}

/** Whether the person at this page moves the hand. */
export function isPlaying(s: Situation, state: WorldStateT | null): boolean {
  if (s.wish !== 'play' || !s.held.heldByYou || !state || state.runState !== RunState.Rendering) return false;
  return state.steering === Steering.Person || hasHardware(state);
}

/** Whether the rest that this page requested still holds: no other stop has ended the rendering. */
function restHolds({ runState, rested }: Pick<WorldStateT, 'runState' | 'rested'>): boolean {
  return runState === RunState.Rendering || (rested && (runState === RunState.Stopping || runState === RunState.Stopped));
}

/** Whether a visit goes to its next exercise, or is over: neither a fault nor an emergency stop ended the rendering. */
function isOrdinaryEnd({ visit = 'none' }: Situation, { runState, latchedFaults }: WorldStateT): boolean {
  return visit !== 'none' && runState !== RunState.Faulted && (latchedFaults & EMERGENCY_STOP) === 0;
}

/** The state that the page shows: the most serious one that applies. */
export function pageState(s: Situation, play: Play | null, state: WorldStateT | null): PageState {
  if (s.problem) return 'version';
  if (state?.silent) return 'silent';
  if (!s.everOpen && s.attempts > 0) return 'absent';
  if (s.everOpen && s.status !== 'open') return 'lost';
  if (s.loading && state) return 'loading';
  const run = state?.runState;
  if (s.resting === 'off' && state && restHolds(state)) return 'rest';
  if (run === RunState.Stopping || run === RunState.Stopped || run === RunState.Faulted) return isOrdinaryEnd(s, state!) ? 'ended' : 'stopped';
  if (s.visit === 'over' && state && run !== RunState.Rendering) return 'ended';
  if (s.framing && state) return 'framing';
  if (s.wish === 'undecided' || !state) return 'welcome';
  if (s.loss !== '' && s.wish === 'play') return 'left';
  if (s.resting === 'between') return 'rest';
  if (!isPlaying(s, state)) return 'watching';
  if (s.unseen !== 'no') return 'unseen';
  return play?.phase(state) ?? 'free';
}

/** Names of the set bits. */
export function faultsOf(names: readonly unknown[], bits: number): string[] {
  return names.map(String).filter((_, bit) => ((bits >>> bit) & 1) === 1);
}

/** Why the run stopped by itself; empty after a stop by a person. */
export function causeOf(scene: Pick<SceneT, 'faultNames'> | null, state: WorldStateT): string {
  if (state.runState !== RunState.Faulted || !scene) return '';
  return faultsOf(scene.faultNames, state.latchedFaults).filter((name) => name !== 'stop requested').map(faultWord).join(', ');
}
