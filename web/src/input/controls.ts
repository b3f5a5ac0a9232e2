import './input.css';
import { targetsOf } from '../exercises';
import type { Connection } from '../net/connection';
import { Help as HelpGiven, RunState, Steering, type SceneT } from '../protocol';
import { hasHardware } from '../shared/hardware';
import { language, type Language } from '../shared/i18n';
import { AimModel, type AimConfig } from './aim_model';
import { partOfAxis } from './axis_range';
import { GamepadWay } from './gamepad';
import { de } from './i18n/de';
import { en, type HelpLine, type InputTexts } from './i18n/en';
import { fr } from './i18n/fr';
import { Keys } from './keys';
import { limitsOf } from './limits';
import { Mouse, type PointedPlace } from './mouse';
import { Perceiver, type RowPoint } from './perceiver';
import { clamp } from './posture';
import { Touch } from './touch';
import { Webcam, type WebcamProblem, type WebcamView } from './webcam';
import { now_s, restingWish, WAYS, type Help, type InputWay, type Way, type Wish } from './wish';

const TEXTS: Readonly<Record<Language, InputTexts>> = { en, de, fr };

/** Largest rate of sent aims [Hz]. */
const RATE_HZ = 60;
/** Longest time step between two looks of a slow page; a longer gap means that the page was suspended [s]. */
const ASLEEP_S = 0.5;
/** A refused request is repeated after this time [s]. */
const ASK_AGAIN_S = 1;
/** An aim faster than this counts as moving [m/s or rad/s]; the person counts as active for this long after it [s]. */
const MOVES = 0.01;
const MOVING_S = 0.5;
/** A shorter press is a tap; where taps have no effect, a hint is shown for this long [s]. */
const TAP_S = 0.6;
const SAID_S = 6;

/** The help that is reported with every aim. */
const GIVEN: Readonly<Record<Help, HelpGiven>> = { full: HelpGiven.Full, some: HelpGiven.Some, none: HelpGiven.None };

export interface ControlsOptions {
  /** Language of the texts; the page's by default. */
  language?: () => Language;
  aim?: Partial<AimConfig>;
}

export interface HelpEntry {
  way: Way;
  name: string;
  lines: readonly HelpLine[];
}

/** A key of the scene's parts that steering is built from. */
function steeredIn({ axes, exerciseJson, valueNames, bodies, capsules, rightHand, level }: SceneT): string {
  return JSON.stringify([axes, exerciseJson, valueNames, bodies, capsules, rightHand, level]);
}

/** The input method that was used last; undefined while none has been. */
export function latestOf<W extends Pick<InputWay, 'claimed_s'>>(ways: readonly W[]): W | undefined {
  const used = ways.filter((way) => way.claimed_s > -Infinity);
  return used.reduce<W | undefined>((a, b) => (a && a.claimed_s >= b.claimed_s ? a : b), undefined);
}

/**
 * All input methods by which a person at the screen steers the virtual patient, while this page has the
 * controls. The first use of any of them asks the program to let the person steer; from then on the
 * aim is sent while rendering. The hand opens whenever the input is lost.
 */
export class Controls {
  /** Called with the reason why a person may not steer, in the program's words; empty: it was granted. */
  onRefused: (reason: string) => void = () => {};
  /** Called with the camera's picture and whether a hand is seen; undefined: the camera is off. `reason`: why, for the person. */
  onWebcam: (view: WebcamView | undefined, reason: string) => void = () => {};

  /** Maps a point of the page to the row; null: outside the picture. Unset: there is no picture. */
  pointing: ((x_px: number, y_px: number) => RowPoint | null) | undefined;

  private readonly ways: readonly InputWay[];
  private readonly pad = new GamepadWay();
  private readonly webcam = new Webcam((view, problem) => this.onWebcam(view, this.reasonOf(problem)));
  private readonly modeListeners = new Set<(way: Way | undefined) => void>();
  private model: AimModel | undefined;
  private perceiver: Perceiver | undefined;
  private current: InputWay | undefined;
  private timer: ReturnType<typeof setInterval> | undefined;
  private last_s = 0;
  private asked_s = -Infinity;
  private moved_s = -Infinity;
  private began = false;
  /** The hand was taken over and there was no input yet: it opens and draws back first. */
  private handedOver = false;
  private revoked_s = -Infinity;
  private pressed_s: number | undefined;
  private tapped_s = -Infinity;
  private steered = '';
  private helped: Help = 'full';

  constructor(
    private readonly connection: Connection,
    element: HTMLElement,
    private readonly options: ControlsOptions = {},
  ) {
    this.ways = [
      new Keys(),
      new Mouse(element, () => this.part('x'), (x_px, y_px) => this.pointed(x_px, y_px)),
      new Touch(element, () => ({ x: this.part('x'), y: this.part('y') }), () => this.texts().touch,
        (x_px, y_px) => this.pointed(x_px, y_px)?.target, () => this.helped === 'full', () => !this.pressIsEnough),
      this.pad,
      this.webcam,
    ];
    connection.on('scene', (scene) => this.onScene(scene));
    connection.on('status', (status) => { if (status !== 'open') this.began = false; });
    connection.on('leaving', () => this.letGo());
    if (connection.scene) this.onScene(connection.scene);
  }

  /** The person's intended position of the hand, one value per axis; undefined while nobody steers. */
  get aim(): readonly number[] | undefined {
    return this.began ? this.model?.aim : undefined;
  }

  /** Degree to which the hand is asked to close, 0 .. 1. */
  get squeeze(): number {
    return this.began ? (this.model?.squeeze ?? 0) : 0;
  }

  /** A squeeze is requested, and the hand is still moving to the target. */
  get onItsWay(): boolean {
    return this.began && (this.model?.onItsWay ?? false);
  }

  /** With full help the page does what was asked for. */
  get acts(): boolean {
    return this.began && (this.model?.acts ?? false);
  }

  /** The name of the single press that is enough with full help; empty: none is used, or a press is not enough. */
  get pressName(): string {
    return this.current && this.pressIsEnough ? this.texts().oneButton[this.current.way] ?? '' : '';
  }

  /** The current target is out of reach. */
  get outOfReach(): boolean {
    return this.began && (this.model?.outOfReach ?? false);
  }

  /** Whether the aim moved recently. */
  get moving(): boolean {
    return now_s() - this.moved_s < MOVING_S;
  }

  /** Demonstrates the next action once; a person who moves or presses takes over. */
  show(): void {
    this.model?.show();
  }

  /** The degree of help with reaching, gripping and letting go. */
  get help(): Help {
    return this.helped;
  }

  set help(help: Help) {
    this.helped = help;
    if (this.model) this.model.config.help = help;
    this.model?.release();
  }

  /** Whether a press reaches, squeezes and lets go: with full help, in an exercise with grasp targets. */
  private get pressIsEnough(): boolean {
    return this.helped === 'full' && (this.perceiver?.hasTargets ?? false);
  }

  /** Calls back whenever the input method changes; undefined: none any more. */
  onMode(callback: (way: Way | undefined) => void): () => void {
    this.modeListeners.add(callback);
    return () => { this.modeListeners.delete(callback); };
  }

  /** The keys of each input method and their effects, in the page's language. @param easy the effect of one press with full help */
  helpEntries(easy: { readonly press: string; readonly point: string } | undefined): HelpEntry[] {
    const texts = this.texts();
    return WAYS.map((way) => {
      const key = this.helped === 'full' && easy ? texts.oneButton[way] : undefined;
      const lines = key === undefined || !easy ? texts.help[way] : [{ keys: [key], does: (way === 'mouse' || way === 'touch') && this.pointing ? easy.point : easy.press }];
      return { way, name: texts.ways[way], lines };
    });
  }

  /** How the person lets go with the present input method; empty: none is used. */
  get letGoWords(): string {
    return this.current ? this.texts().letGo[this.current.way] : '';
  }

  /** How to squeeze, after a tap with full help that had no effect because the exercise names no targets; else empty. */
  get holdWords(): string {
    return this.current && now_s() - this.tapped_s < SAID_S ? this.texts().hold[this.current.way] : '';
  }

  /** Begins to listen. A hand that this person already steers opens and draws back; nothing else is sent before the person acts. */
  enable(): void {
    if (this.timer !== undefined) return;
    for (const way of this.ways) way.enable();
    addEventListener('blur', this.release);
    this.handedOver = true;
    this.last_s = now_s();
    this.timer = setInterval(() => this.step(), 1000 / RATE_HZ);
  }

  /** Stops listening; the hand opens at its last aim, and an open camera stays open. */
  disable(): void {
    if (this.timer === undefined) return;
    clearInterval(this.timer);
    this.timer = undefined;
    this.letGo();
    removeEventListener('blur', this.release);
    for (const way of this.ways) way.disable();
    this.use(undefined);
  }

  /** Opens the camera, and waits for a hand in its frame. The reason of a failure is for the person; '' if they cancelled it. */
  async startWebcam(): Promise<{ ok: boolean; reason: string }> {
    const problem = await this.webcam.start();
    return { ok: problem === '', reason: this.reasonOf(problem) };
  }

  stopWebcam(): void {
    this.webcam.stop();
  }

  /** Texts for the camera while it is on. */
  cameraTexts(): InputTexts['camera'] {
    return this.texts().camera;
  }

  private reasonOf(problem: WebcamProblem): string {
    return problem === '' || problem === 'cancelled' ? '' : this.texts().webcam[problem];
  }

  private texts(): InputTexts {
    return TEXTS[(this.options.language ?? language)()];
  }

  private onScene(scene: SceneT): void {
    // A saved profile or a new recording sends the same scene again: steering continues.
    const steered = steeredIn(scene);
    if (steered === this.steered) return;
    this.steered = steered;
    const axes = scene.axes.map(({ name, lower, upper }) => ({ name: String(name), lower, upper }));
    this.model = new AimModel(axes, { ...this.options.aim, help: this.helped });
    this.perceiver = new Perceiver(scene, targetsOf(scene));
    this.began = false;
  }

  /** Position of the hand (or its aim) along an axis, -1 .. 1. */
  private part(name: string): number {
    const i = this.connection.scene?.axes.findIndex((axis) => axis.name === name) ?? -1;
    const axis = this.connection.scene?.axes[i];
    if (!axis) return 0;
    const q = this.aim?.[i] ?? this.connection.latestState?.qM[i] ?? 0;
    return partOfAxis(axis, q);
  }

  /** Ends every held input, and opens a hand that this page closed, since nobody is there to let go. */
  private letGo(): void {
    for (const way of this.ways) way.yield();
    const { connection, model } = this;
    if (this.began && model && connection.latestState?.runState === RunState.Rendering) {
      model.open();
      void connection.aim([...model.aim], GIVEN[this.helped]);
    }
    this.began = false;
  }

  /** In another window nobody can end the action of a tap. */
  private readonly release = (): void => { this.model?.release(); };

  /** The place of the row at a point of the page; undefined where the picture or the hand is unknown. */
  private pointed(x_px: number, y_px: number): PointedPlace | undefined {
    const at = this.pointing?.(x_px, y_px);
    const { perceiver, connection: { scene, latestState: state } } = this;
    const palm = at && state ? perceiver?.palmAt(state, at) : undefined;
    if (!at || !state || !scene || !palm) return undefined;
    const part = (name: 'y' | 'z'): number => {
      const axis = scene.axes.find((candidate) => String(candidate.name) === name);
      return axis ? clamp(partOfAxis(axis, palm[name]), -1, 1) : 0;
    };
    return { y: part('y'), z: part('z'), target: perceiver?.targetAt(state, at) };
  }

  private use(way: InputWay | undefined): void {
    if (way === this.current) return;
    this.current?.yield();
    this.model?.release();
    this.current = way;
    for (const callback of this.modeListeners) callback(way?.way);
  }

  private step(): void {
    const now = now_s();
    // The step is limited, so that a suspended page does not jump; a slow page steers as fast as any.
    const dt_s = Math.min(now - this.last_s, ASLEEP_S);
    this.last_s = now;
    this.pad.poll();
    const { current: before } = this;
    this.use(latestOf(this.ways));
    // An unplugged camera or a removed gamepad ends what it held.
    if (before && !this.current) this.letGo();
    const { connection, model, perceiver, current } = this;
    const state = connection.latestState;
    // On a real device the person's own hand steers.
    if (!model || !perceiver || !state || connection.status !== 'open' || hasHardware(state)) return;
    const isHanded = this.handedOver && state.steering === Steering.Person && connection.controls.heldByYou;
    if (!current && !model.showing && !isHanded) return;
    // Steering that was taken away (somebody wants to watch) is requested again only by new input.
    if (this.began && state.steering !== Steering.Person) this.revoked_s = now;
    if (state.runState !== RunState.Rendering || state.steering !== Steering.Person) this.began = false;
    if (state.runState !== RunState.Rendering || !this.maySteer(now, state.steering)) return;
    if (!this.began) {
      model.begin(state.intention.length > 0 ? state.intention : state.qM);
      this.began = true;
      this.handedOver = false;
    }
    if (connection.scene) model.limits = limitsOf(connection.scene, state);
    const aimed = [...model.aim], wish = current?.wish(now) ?? restingWish();
    this.lookForTaps(wish, now);
    model.advance(wish, perceiver.onState(state), dt_s);
    if (model.aim.some((q, i) => Math.abs(q - aimed[i]!) > MOVES * dt_s)) this.moved_s = now;
    current?.overruled?.(model.overruled);
    void connection.aim([...model.aim], GIVEN[this.helped]);
  }

  private lookForTaps({ squeeze }: Wish, now: number): void {
    if (squeeze === true) this.pressed_s ??= now;
    else if (this.pressed_s !== undefined) {
      if (this.helped === 'full' && !this.pressIsEnough && now - this.pressed_s < TAP_S) this.tapped_s = now;
      this.pressed_s = undefined;
    }
  }

  /** Requests steering where it is missing, at intervals. The controls are taken only by a press. */
  private maySteer(now: number, steering: Steering): boolean {
    const mine = this.connection.controls.heldByYou;
    if (!mine) return false;
    if (steering === Steering.Person) return true;
    if (now - this.asked_s < ASK_AGAIN_S || (this.current?.claimed_s ?? 0) <= this.revoked_s) return false;
    this.asked_s = now;
    void this.ask();
    return false;
  }

  private async ask(): Promise<void> {
    const answer = await this.connection.steer(Steering.Person);
    this.onRefused(answer.accepted ? '' : answer.reason);
  }
}
