// From watching to playing: every order that it takes, in turn, and why it did not work where it did not.
import type { Controls } from '../input/controls';
import { isHandAxis, postureOf } from '../input/posture';
import type { Answer, Connection } from '../net/connection';
import { Act, RunState, Steering } from '../protocol';
import { text } from '../shared/i18n';
import type { ExercisePanel } from '../shared/exercise_panel';
import { figure, type Script } from './script';
import { hasHardware, isFaded, Stage } from './view';

export interface Wishes {
  readonly way: string;      // of playing
  readonly level: number;
  readonly fresh: boolean;   // a person who comes new begins a new glass
}

/** What the page knows; asked again after every order, as orders change it. */
export interface Known { readonly script: Script | null; readonly panel?: ExercisePanel | null; readonly hardware: boolean }

export type Outcome = { readonly is: 'playing' | 'another plays' | 'stopped' } | { readonly is: 'refused'; readonly reason: string };

const EVERY_MS = 25;
const TRIES = 80;
const TRIES_AFTER_REFUSAL = 20;

const wait = (): Promise<void> => new Promise((go) => { setTimeout(go, EVERY_MS); });

/** Until the program's states say so too, or for two seconds. */
async function until(so: () => boolean, most = TRIES): Promise<void> {
  for (let tries = 0; tries < most && !so(); tries++) await wait();
}

/**
 * What a person has pressed. It holds for what they were shown: until they press Stop, or anything stops. What
 * is left of it then is not sent, and where it is on its way already the program refuses it.
 */
export class Press {
  private cancelled = false;

  /** `seen`: of the endings that the program counts, the last one that they were shown. */
  constructor(private readonly connection: Connection, readonly seen: number) {}

  cancel(): void { this.cancelled = true; }
  get holds(): boolean { return !this.cancelled && this.connection.endings === this.seen; }
}

/** Loads that level, or the bar where an exercise is on that shows nothing; nothing when it is there already. */
export async function matchLevel(connection: Connection, known: () => Known, level: number): Promise<Answer> {
  const { scene } = connection;
  const { script, panel } = known();
  const shown = script ?? panel ?? null;
  if (!scene || (shown && scene.level === level)) return { accepted: true, reason: '' };
  const answer = await connection.loadExercise(shown ? '' : 'cocktail-bar', level, '');
  if (answer.accepted) await until(() => (known().script ?? known().panel ?? null) !== null && connection.scene?.level === level);
  return answer;
}

/** The person at this screen moves the hand. On a real device that is the person's own hand. */
async function steer(connection: Connection, known: () => Known): Promise<Answer> {
  if (known().hardware) return { accepted: true, reason: '' };
  const answer = await connection.steer(Steering.Person);
  if (answer.accepted) await until(() => {
    const state = connection.latestState;
    return state?.runState === RunState.Rendering && state.steering === Steering.Person;
  });
  return answer;
}

/** Another level for a person who plays: loading gives the hand back to the virtual patient. */
export async function changeLevel(connection: Connection, known: () => Known, press: Press, level: number): Promise<Answer> {
  const loaded = await matchLevel(connection, known, level);
  return loaded.accepted && press.holds ? steer(connection, known) : loaded;
}

/** Where the hand is, but open: what the virtual patient held is let go of. The program makes it a gentle move. */
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

/** Whether what the program does last is a rest, which whoever rested may end. */
const restsNow = ({ latestState: state }: Connection): boolean => state?.runState === RunState.Stopped && state.rested;

/** A therapist who is there starts it, and chooses what is played. */
function waitsForTherapist(connection: Connection): boolean {
  return connection.controls.led && connection.latestState?.runState !== RunState.Rendering && !restsNow(connection);
}

/** From watching to playing. After a stop the controls are given back: whoever starts it again may command. */
export async function takeOver(connection: Connection, known: () => Known, press: Press, wishes: Wishes): Promise<Outcome> {
  if (waitsForTherapist(connection)) return { is: 'refused', reason: text('welcome.led') };
  const taken = await connection.takeControls();
  if (!taken.accepted) return connection.controls.held ? { is: 'another plays' } : { is: 'refused', reason: taken.reason };
  const outcome = await takeHand(connection, known, press, wishes);
  if (press.holds && outcome.is === 'playing') return outcome;
  // Whoever does not play keeps nobody else from it.
  await connection.releaseControls();
  return press.holds ? outcome : { is: 'stopped' };
}

/** With the controls: loads, starts and steers, each only while the press holds. */
async function takeHand(connection: Connection, known: () => Known, press: Press, wishes: Wishes): Promise<Outcome> {
  const loaded = connection.controls.led ? { accepted: true, reason: '' } : await matchLevel(connection, known, wishes.level);
  if (!loaded.accepted) return { is: 'refused', reason: loaded.reason };
  if (!press.holds) return { is: 'stopped' };
  if (connection.latestState?.runState === RunState.Disarmed || restsNow(connection)) {
    const armed = await connection.arm(press.seen);
    // Somebody who has just left may have armed it: the next states say so, and that is as good.
    const rendering = (): boolean => connection.latestState?.runState === RunState.Rendering;
    await until(() => rendering() || !press.holds, armed.accepted ? TRIES : TRIES_AFTER_REFUSAL);
    if (!press.holds) return { is: 'stopped' };
    if (!armed.accepted && !rendering()) return { is: 'refused', reason: armed.reason };
  }
  const steered = await steer(connection, known);
  if (!steered.accepted) return { is: 'refused', reason: steered.reason };
  if (!press.holds) return { is: 'stopped' };
  await beginDrink(connection, known, wishes);
  return { is: 'playing' };
}

async function beginDrink(connection: Connection, known: () => Known, wishes: Wishes): Promise<void> {
  const { scene, latestState } = connection;
  if (scene && latestState && !known().hardware) await connection.aim(openedHand(scene.axes.map(({ name }) => ({ name: String(name) })), latestState.qM));
  const { script, panel } = known();
  const stage = script && connection.latestState ? figure(script, connection.latestState, 'stage') : Stage.Reach;
  const done = panel && connection.latestState ? panel.done(connection.latestState) : false;
  const over = done || stage === Stage.DrinkDone || stage === Stage.LevelDone;
  await connection.act(wishes.fresh || over ? Act.Restart : Act.Resume);
  if (over && script) await until(() => connection.latestState !== null && script !== null && figure(script, connection.latestState, 'stage') < Stage.DrinkDone);
}

/** Where nothing runs or pushes and nobody commands, the wish to see it is enough to let the program play. */
export async function letProgramPlay(connection: Connection, press: Press): Promise<void> {
  const { latestState: state, controls } = connection;
  const disarmed = (state?.runState === RunState.Disarmed && !controls.led) || restsNow(connection);
  const faded = state?.runState === RunState.Rendering && isFaded(state) && !hasHardware(state);
  if ((!disarmed && !faded) || controls.held) return;
  if (!(await connection.takeControls()).accepted) return;
  if (disarmed && press.holds) await connection.arm(press.seen);
  await connection.releaseControls();
}
