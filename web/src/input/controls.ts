import './input.css';
import type { Connection } from '../net/connection';
import { RunState, Steering, type SceneT } from '../protocol';
import { language, type Language } from '../shared/i18n';
import { AimModel, partOfAxis, type AimConfig } from './aim_model';
import { GamepadWay } from './gamepad';
import { de } from './i18n/de';
import { en, type HelpLine, type InputTexts } from './i18n/en';
import { fr } from './i18n/fr';
import { Keys } from './keys';
import { Mouse } from './mouse';
import { Perceiver } from './perception';
import { Touch } from './touch';
import { Webcam, type WebcamView } from './webcam';
import { now_s, WAYS, type InputWay, type Way } from './wish';

const TEXTS: Readonly<Record<Language, InputTexts>> = { en, de, fr };

/** Aims go out this often at most [Hz]. */
const RATE_HZ = 60;
/** After a refusal the program is asked again this much later [s]. */
const ASK_AGAIN_S = 1;

export interface ControlsOptions {
  /** Language of what is said; the page's unless told otherwise. */
  language?: () => Language;
  aim?: Partial<AimConfig>;
}

export interface HelpEntry {
  way: Way;
  name: string;
  lines: readonly HelpLine[];
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
  /** Called with the camera's picture and whether a hand is seen; undefined: the camera is off. */
  onWebcam: (view: WebcamView | undefined) => void = () => {};

  private readonly ways: readonly InputWay[];
  private readonly pad = new GamepadWay();
  private readonly webcam = new Webcam((view) => this.onWebcam(view));
  private readonly modeListeners = new Set<(way: Way | undefined) => void>();
  private model: AimModel | undefined;
  private perceiver: Perceiver | undefined;
  private current: InputWay | undefined;
  private timer: ReturnType<typeof setInterval> | undefined;
  private last_s = 0;
  private asked_s = -Infinity;
  private began = false;
  private revoked_s = -Infinity;
  private assisted = true;

  constructor(
    private readonly connection: Connection,
    element: HTMLElement,
    private readonly options: ControlsOptions = {},
  ) {
    this.ways = [
      new Keys(),
      new Mouse(element, () => this.part('x')),
      new Touch(element, () => ({ x: this.part('x'), y: this.part('y') }), () => this.texts().touch),
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

  /** Eases the hand to the grip and steadies the squeeze; on unless switched off. */
  get assist(): boolean {
    return this.assisted;
  }

  set assist(on: boolean) {
    this.assisted = on;
    if (this.model) this.model.config.assist = on;
  }

  /** Tells which way is in use whenever it changes; undefined: none any more. */
  onMode(callback: (way: Way | undefined) => void): () => void {
    this.modeListeners.add(callback);
    return () => { this.modeListeners.delete(callback); };
  }

  /** What to press and what it does, in the language of the page. */
  helpEntries(): HelpEntry[] {
    const texts = this.texts();
    return WAYS.map((way) => ({ way, name: texts.ways[way], lines: texts.help[way] }));
  }

  /** Begins to listen. Nothing is sent before the person does something. */
  enable(): void {
    if (this.timer !== undefined) return;
    for (const way of this.ways) way.enable();
    this.last_s = now_s();
    this.timer = setInterval(() => this.step(), 1000 / RATE_HZ);
  }

  /** Stops listening; the hand opens where it was last aimed, and an open camera stays open. */
  disable(): void {
    if (this.timer === undefined) return;
    clearInterval(this.timer);
    this.timer = undefined;
    this.letGo();
    for (const way of this.ways) way.disable();
    this.use(undefined);
  }

  /** Opens the camera; the reason why not is for the person. */
  async startWebcam(): Promise<{ ok: boolean; reason: string }> {
    const problem = await this.webcam.start();
    return { ok: problem === '', reason: problem === '' ? '' : this.texts().webcam[problem] };
  }

  stopWebcam(): void {
    this.webcam.stop();
  }

  /** What to say while the camera sees no hand. */
  noHandText(): string {
    return this.texts().webcam.noHand;
  }

  private texts(): InputTexts {
    return TEXTS[(this.options.language ?? language)()];
  }

  private onScene(scene: SceneT): void {
    const axes = scene.axes.map(({ name, lower, upper }) => ({ name: String(name), lower, upper }));
    this.model = new AimModel(axes, { ...this.options.aim, assist: this.assisted });
    this.perceiver = new Perceiver(scene);
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
      void connection.aim([...model.aim]);
    }
    this.began = false;
  }

  private use(way: InputWay | undefined): void {
    if (way === this.current) return;
    this.current?.yield();
    this.current = way;
    for (const callback of this.modeListeners) callback(way?.way);
  }

  private step(): void {
    const now = now_s();
    // A page that was asleep must not jump when it wakes.
    const dt_s = Math.min(now - this.last_s, 0.1);
    this.last_s = now;
    this.pad.poll();
    this.use(latestOf(this.ways));
    const { connection, model, perceiver, current } = this;
    const state = connection.latestState;
    if (!current || !model || !perceiver || !state || connection.status !== 'open') return;
    // Steering that was taken away (somebody wants to watch) is only asked for with a new touch.
    if (this.began && state.steering !== Steering.Person) this.revoked_s = now;
    if (state.runState !== RunState.Rendering || state.steering !== Steering.Person) this.began = false;
    if (state.runState !== RunState.Rendering || !this.maySteer(now, state.steering)) return;
    if (!this.began) {
      model.begin(state.intention.length > 0 ? state.intention : state.qM);
      this.began = true;
    }
    model.step(current.wish(now), perceiver.see(state), dt_s);
    current.overruled?.(model.overruled);
    void connection.aim([...model.aim]);
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
