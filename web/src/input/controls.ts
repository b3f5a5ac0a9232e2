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
import { Mouse, type Pointed } from './mouse';
import { Perceiver, type RowPoint } from './perceiver';
import { clamp } from './posture';
import { Touch } from './touch';
import { Webcam, type WebcamProblem, type WebcamView } from './webcam';
import { now_s, restingWish, WAYS, type Help, type InputWay, type Way, type Wish } from './wish';

const TEXTS: Readonly<Record<Language, InputTexts>> = { en, de, fr };

/** Aims go out this often at most [Hz]. */
const RATE_HZ = 60;
/** From one look of a page that draws slowly to the next; who was away for longer was asleep [s]. */
const ASLEEP_S = 0.5;
/** After a refusal the program is asked again this much later [s]. */
const ASK_AGAIN_S = 1;
/** An aim that moves faster than this [m/s or rad/s] moves; so long after it a person is still at it [s]. */
const MOVES = 0.01;
const MOVING_S = 0.5;
/** A press shorter than this is a tap; where taps do nothing, that is said for so long [s]. */
const TAP_S = 0.6;
const SAID_S = 6;

/** What every aim says of the help in it. */
const GIVEN: Readonly<Record<Help, HelpGiven>> = { full: HelpGiven.Full, some: HelpGiven.Some, none: HelpGiven.None };

export interface ControlsOptions {
  /** Language of what is said; the page's by default. */
  language?: () => Language;
  aim?: Partial<AimConfig>;
}

export interface HelpEntry {
  way: Way;
  name: string;
  lines: readonly HelpLine[];
}

/** The parts of a scene that steering is built from. */
function steeredIn({ axes, exerciseJson, valueNames, bodies, capsules, rightHand, level }: SceneT): string {
  return JSON.stringify([axes, exerciseJson, valueNames, bodies, capsules, rightHand, level]);
}

/** The way that was used last; undefined while none has been. */
export function latestOf<W extends Pick<InputWay, 'claimed_s'>>(ways: readonly W[]): W | undefined {
  const used = ways.filter((way) => way.claimed_s > -Infinity);
  return used.reduce<W | undefined>((a, b) => (a && a.claimed_s >= b.claimed_s ? a : b), undefined);
}

/**
 * Everything by which a person at the screen steers the virtual patient, while this page has the
 * controls. The first touch of any of them asks the program to let the person steer; from then on the
 * aim goes out while rendering. Whatever takes the input away opens the hand.
 */
export class Controls {
  /** Called with why a person may not steer, in the program's words; empty: it was granted. */
  onRefused: (reason: string) => void = () => {};
  /** Called with the camera's picture and whether a hand is seen; undefined: the camera is off, and why, for the person. */
  onWebcam: (view: WebcamView | undefined, reason: string) => void = () => {};

  /** Where in the row a point of the page is; null: it is not in the picture. Unset: there is no picture. */
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
  /** The hand was taken over and not touched yet: it opens and draws back before anything else. */
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

  /** Where the person wants the hand to be, one position per axis; undefined while nobody steers. */
  get aim(): readonly number[] | undefined {
    return this.began ? this.model?.aim : undefined;
  }

  /** How far the hand is asked to close, 0 .. 1. */
  get squeeze(): number {
    return this.began ? (this.model?.squeeze ?? 0) : 0;
  }

  /** A squeeze is asked for, and the hand is on its way to the target first. */
  get onItsWay(): boolean {
    return this.began && (this.model?.onItsWay ?? false);
  }

  /** The target that is asked for is out of reach. */
  get outOfReach(): boolean {
    return this.began && (this.model?.outOfReach ?? false);
  }

  /** The aim moved a moment ago: something is being done. */
  get moving(): boolean {
    return now_s() - this.moved_s < MOVING_S;
  }

  /** The hand shows what to do next, once; a person who moves or presses takes over. */
  show(): void {
    this.model?.show();
  }

  /** How much of reaching, gripping and letting go is done for the person. */
  get help(): Help {
    return this.helped;
  }

  set help(help: Help) {
    this.helped = help;
    if (this.model) this.model.config.help = help;
    this.model?.release();
  }

  /** With full help a press reaches, squeezes and lets go, where the exercise says what may be grasped. */
  private get pressIsEnough(): boolean {
    return this.helped === 'full' && (this.perceiver?.hasTargets ?? false);
  }

  /** Reports which way is in use whenever it changes; undefined: none any more. */
  onMode(callback: (way: Way | undefined) => void): () => void {
    this.modeListeners.add(callback);
    return () => { this.modeListeners.delete(callback); };
  }

  /** What to press and what it does, in the language of the page. @param easy what one press does with full help */
  helpEntries(easy: { readonly press: string; readonly point: string } | undefined): HelpEntry[] {
    const texts = this.texts();
    return WAYS.map((way) => {
      const key = this.helped === 'full' && easy ? texts.oneButton[way] : undefined;
      const lines = key === undefined || !easy ? texts.help[way] : [{ keys: [key], does: (way === 'mouse' || way === 'touch') && this.pointing ? easy.point : easy.press }];
      return { way, name: texts.ways[way], lines };
    });
  }

  /** How the person lets go, by the way that is used; empty: nothing is used. */
  get letGoWords(): string {
    return this.current ? this.texts().letGo[this.current.way] : '';
  }

  /** How to squeeze, after a tap with full help where it does nothing, because the exercise names no targets; else empty. */
  get holdWords(): string {
    return this.current && now_s() - this.tapped_s < SAID_S ? this.texts().hold[this.current.way] : '';
  }

  /** Begins to listen. Whose hand it is already opens it and draws it back; nothing else is sent before the person does something. */
  enable(): void {
    if (this.timer !== undefined) return;
    for (const way of this.ways) way.enable();
    addEventListener('blur', this.release);
    this.handedOver = true;
    this.last_s = now_s();
    this.timer = setInterval(() => this.step(), 1000 / RATE_HZ);
  }

  /** Stops listening; the hand opens where it was last aimed, and an open camera stays open. */
  disable(): void {
    if (this.timer === undefined) return;
    clearInterval(this.timer);
    this.timer = undefined;
    this.letGo();
    removeEventListener('blur', this.release);
    for (const way of this.ways) way.disable();
    this.use(undefined);
  }

  /** Opens the camera, and waits for a hand in its frame; the reason why not is for the person, '' where they wanted it no more. */
  async startWebcam(): Promise<{ ok: boolean; reason: string }> {
    const problem = await this.webcam.start();
    return { ok: problem === '', reason: this.reasonOf(problem) };
  }

  stopWebcam(): void {
    this.webcam.stop();
  }

  /** What to say of the camera while it is on. */
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
    // A profile that is saved, or a recording that begins, tells the same scene anew: the hand goes on.
    const steered = steeredIn(scene);
    if (steered === this.steered) return;
    this.steered = steered;
    const axes = scene.axes.map(({ name, lower, upper }) => ({ name: String(name), lower, upper }));
    this.model = new AimModel(axes, { ...this.options.aim, help: this.helped });
    this.perceiver = new Perceiver(scene, targetsOf(scene));
    this.began = false;
  }

  /** Where the hand (or its aim) is along an axis, -1 .. 1. */
  private part(name: string): number {
    const i = this.connection.scene?.axes.findIndex((axis) => axis.name === name) ?? -1;
    const axis = this.connection.scene?.axes[i];
    if (!axis) return 0;
    const q = this.aim?.[i] ?? this.connection.latestState?.qM[i] ?? 0;
    return partOfAxis(axis, q);
  }

  /** What was held is not held any more, and a hand that this page closed opens: nobody is there to let go of it. */
  private letGo(): void {
    for (const way of this.ways) way.yield();
    const { connection, model } = this;
    if (this.began && model && connection.latestState?.runState === RunState.Rendering) {
      model.open();
      void connection.aim([...model.aim], GIVEN[this.helped]);
    }
    this.began = false;
  }

  /** In another window nobody can end what a tap began. */
  private readonly release = (): void => { this.model?.release(); };

  /** What is drawn at a point of the page; undefined where the picture or the hand is not known. */
  private pointed(x_px: number, y_px: number): Pointed | undefined {
    const at = this.pointing?.(x_px, y_px);
    const { perceiver, connection: { scene, latestState: state } } = this;
    const palm = at && state ? perceiver?.palmAt(state, at) : undefined;
    if (!at || !state || !scene || !palm) return undefined;
    const part = (name: 'y' | 'z'): number => {
      const axis = scene.axes.find((candidate) => String(candidate.name) === name);
      return axis ? clamp(partOfAxis(axis, palm[name]), -1, 1) : 0;
    };
    return { y: part('y'), z: part('z'), target: perceiver?.targetAt(state, at.y_m) };
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
    // A page that was asleep must not jump when it wakes; one that draws slowly steers as fast as any.
    const dt_s = Math.min(now - this.last_s, ASLEEP_S);
    this.last_s = now;
    this.pad.poll();
    const { current: before } = this;
    this.use(latestOf(this.ways));
    // A camera that is unplugged, a pad that is gone: what it held is let go of.
    if (before && !this.current) this.letGo();
    const { connection, model, perceiver, current } = this;
    const state = connection.latestState;
    // On a real device the person's own hand steers.
    if (!model || !perceiver || !state || connection.status !== 'open' || hasHardware(state)) return;
    const isHanded = this.handedOver && state.steering === Steering.Person && connection.controls.heldByYou;
    if (!current && !model.showing && !isHanded) return;
    // Steering that was taken away (somebody wants to watch) is only asked for with a new touch.
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
    model.advance(wish, perceiver.see(state), dt_s);
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

  /** Asks for steering where it is missing, now and then. The controls are taken by a press only. */
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
