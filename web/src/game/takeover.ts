// The change from watching to playing: the orders in their sequence, and the reason of a refusal.
import { FIRST } from '../exercises';
import type { Play } from '../exercises/exercise';
import type { Controls } from '../input/controls';
import { isHandAxis, postureOf } from '../input/posture';
import type { Connection } from '../net/connection';
import type { Answer } from '../net/pending_answers';
import { Act, RunState, Steering } from '../protocol';
import { text } from '../shared/i18n';
import { hasHardware } from '../shared/hardware';
import { isFaded } from './page_state';

export interface Wishes {
  readonly way: string;      // the input method
  readonly level: number;
  readonly hand?: string;    // its name; undefined: the loaded one
  readonly fresh: boolean;   // a new person begins from the start
}

/** Facts that are read again after every order, because orders change them. */
export interface PlayContext { readonly play: Play | null; readonly hardware: boolean }

export type Outcome = { readonly is: 'playing' | 'another plays' | 'stopped' } | { readonly is: 'refused'; readonly reason: string; readonly unheard?: boolean };

const EVERY_MS = 25;
const TRIES = 80;
const TRIES_AFTER_REFUSAL = 20;
/** A press takes the controls at most this often if they are lost before the person plays. */
const TAKES = 3;

const wait = (): Promise<void> => new Promise((go) => { setTimeout(go, EVERY_MS); });

/** Waits until `so` is true, for two seconds at most. */
async function until(so: () => boolean, most = TRIES): Promise<void> {
  for (let tries = 0; tries < most && !so(); tries++) await wait();
}

/**
 * A press of a person. It holds until they press Stop, or anything stops. Its orders that are not sent by then
 * are dropped, and the program refuses those that are under way.
 */
export class Press {
  private cancelled = false;

  /** @param seen the newest ending of the program that was shown to the person @param basis the number of the shown person, hand, level and limits */
  constructor(private readonly connection: Connection, readonly seen: number, readonly basis: number) {}

  cancel(): void { this.cancelled = true; }
  get isCancelled(): boolean { return this.cancelled; }
  get holds(): boolean { return !this.cancelled && this.connection.endings === this.seen; }
}

/** Loads a level and a hand; or the first exercise if the present one cannot be shown. It does nothing if they are loaded. */
async function matchLoaded(connection: Connection, known: () => PlayContext, { level, hand }: Pick<Wishes, 'level' | 'hand'>): Promise<Answer> {
  const { scene } = connection;
  const shown = known().play !== null, fits = (): boolean => known().play !== null && connection.scene?.level === level && (hand === undefined || String(connection.scene.handName) === hand);
  if (!scene || fits()) return { accepted: true, reason: '' };
  const answer = await connection.loadExercise(shown ? '' : FIRST.file, level, hand ?? '');
  if (answer.accepted) await until(fits);
  return answer;
}

const refusedBy = ({ reason, unheard }: Answer): Outcome => ({ is: 'refused', reason, unheard });

/** Lets the person at this screen move the hand. On a real device that is the person's own hand. */
async function steer(connection: Connection, known: () => PlayContext): Promise<Answer> {
  if (known().hardware) return { accepted: true, reason: '' };
  const answer = await connection.steer(Steering.Person);
  if (answer.accepted) await until(() => {
    const state = connection.latestState;
    return state?.runState === RunState.Rendering && state.steering === Steering.Person;
  });
  return answer;
}

/** Changes level and hand of a person who plays: loading gives the hand back to the virtual patient, so it is taken again. */
export async function changeLoaded(connection: Connection, known: () => PlayContext, press: Press, wishes: Pick<Wishes, 'level' | 'hand'>): Promise<Answer> {
  const loaded = await matchLoaded(connection, known, wishes);
  return loaded.accepted && press.holds ? steer(connection, known) : loaded;
}

/** The present posture with open fingers: it releases what the virtual patient held. The program moves there gently. */
export function openedHand(axes: readonly { readonly name: string }[], q: readonly number[]): number[] {
  return axes.map(({ name }, i) => (isHandAxis(name) ? postureOf(name, 0) : q[i] ?? 0));
}

export async function openCamera(controls: Controls, way: string): Promise<Answer> {
  if (way !== 'webcam') {
    controls.stopWebcam();
    return { accepted: true, reason: '' };
  }
  const { ok, reason } = await controls.startWebcam();
  return { accepted: ok, reason };
}

/** Whether the program is in a rest, which the client that requested it may end. */
const restsNow = ({ latestState: state }: Connection): boolean => state?.runState === RunState.Stopped && state.rested;

/** Whether a therapist is present, who then starts the run and chooses the exercise. */
function waitsForTherapist(connection: Connection): boolean {
  return connection.controls.led && connection.latestState?.runState !== RunState.Rendering && !restsNow(connection);
}

/** Changes from watching to playing. After a stop the controls are given back: the next person to start may command. */
export async function takeOver(connection: Connection, known: () => PlayContext, press: Press, wishes: Wishes): Promise<Outcome> {
  if (waitsForTherapist(connection)) return { is: 'refused', reason: text('welcome.led') };
  let outcome: Outcome, unheard: boolean, takes = 0;
  do {
    const taken = await connection.takeControls();
    if (!taken.accepted) return connection.controls.held ? { is: 'another plays' } : { is: 'refused', reason: taken.reason };
    const had = connection.controls.heldByYou;
    outcome = await takeHand(connection, known, press, wishes);
    if (press.holds && outcome.is === 'playing') return outcome;
    // On a busy machine the program may not hear the page while it draws its first pictures. Then it asks again.
    unheard = (outcome.is === 'refused' && outcome.unheard === true) || (had && !connection.controls.heldByYou && !connection.controls.held);
  } while (unheard && outcome.is === 'refused' && press.holds && ++takes < TAKES);
  // A page that does not play must not block another one.
  await connection.releaseControls();
  return press.holds ? outcome : { is: 'stopped' };
}

/** Loads, starts and steers while holding the controls, each only while the press holds. */
async function takeHand(connection: Connection, known: () => PlayContext, press: Press, wishes: Wishes): Promise<Outcome> {
  const loaded = connection.controls.led ? { accepted: true, reason: '' } : await matchLoaded(connection, known, wishes);
  if (!loaded.accepted) return refusedBy(loaded);
  if (!press.holds) return { is: 'stopped' };
  if (connection.latestState?.runState === RunState.Disarmed || restsNow(connection)) {
    const armed = await connection.arm(press.seen, press.basis);
    // A page that has just been left may have armed it: the next states show it, and that is sufficient.
    const rendering = (): boolean => connection.latestState?.runState === RunState.Rendering;
    await until(() => rendering() || !press.holds, armed.accepted ? TRIES : TRIES_AFTER_REFUSAL);
    if (!press.holds) return { is: 'stopped' };
    if (!armed.accepted && !rendering()) return refusedBy(armed);
  }
  const steered = await steer(connection, known);
  if (!steered.accepted) return refusedBy(steered);
  if (!press.holds) return { is: 'stopped' };
  await begin(connection, known, wishes);
  return { is: 'playing' };
}

async function begin(connection: Connection, known: () => PlayContext, wishes: Wishes): Promise<void> {
  const { scene, latestState } = connection;
  if (scene && latestState && !known().hardware) await connection.aim(openedHand(scene.axes.map(({ name }) => ({ name: String(name) })), latestState.qM));
  const { play } = known();
  const isOver = (): boolean => play !== null && connection.latestState !== null && play.phase(connection.latestState) === 'success';
  const over = isOver();
  await connection.act(wishes.fresh || over ? Act.Restart : Act.Resume);
  if (over) await until(() => !isOver());
}

/**
 * Lets the program play if nothing renders and nobody commands; opening the page is sufficient for that. The controls
 * are held until it has begun: after they are given back, their holder's orders have no effect. If it runs already, the
 * orders are sent at once: a page that draws for a second between two of them would lose the controls.
 */
export async function letProgramPlay(connection: Connection, known: () => PlayContext, press: Press): Promise<void> {
  const { latestState: state, controls } = connection;
  const disarmed = (state?.runState === RunState.Disarmed && !controls.led) || restsNow(connection);
  const renders = state?.runState === RunState.Rendering && !hasHardware(state);
  const faded = renders && isFaded(state);
  // The pause was set by a player who has left. The program refuses to end a therapist's pause.
  const paused = renders && (known().play?.isPaused(state) ?? false);
  if ((!disarmed && !faded && !paused) || controls.held) return;
  const answers = [connection.takeControls()];
  if (disarmed && press.holds) answers.push(connection.arm(press.seen, press.basis));
  if (paused && press.holds) answers.push(connection.act(Act.Resume));
  if (!disarmed) answers.push(connection.releaseControls());
  await Promise.all(answers);
  if (disarmed) await connection.releaseControls();
}
