import type { Connection } from '../net/connection';
import type { Answer } from '../net/pending_answers';
import { RunState, SafetyState, type EventT, type SceneT, type WorldStateT } from '../protocol';
import { isRecorded } from '../shared/recorded';
import { History, WINDOW_S } from './history';
import { texts } from './i18n';
import { Marks } from './marks';
import type { Recording } from './recording';
import { statusOf, type Status } from './run_status';
import { SessionCounters } from './session_counters';

/** A line of the safety panel. */
export interface Notice {
  at: Date;
  /** In the order of Scene.fault_names. */
  bits: number;
}

/**
 * Faults that are reported without a stop. Bit 6: effort limited, 7: late tick, 8: contacts dropped, 14: power limited,
 * 20: owner silent, 22: the energy tank damped, 26: drive hot, 31: contacts unsettled.
 */
const INFORMATION = (1 << 6) | (1 << 7) | (1 << 8) | (1 << 14) | (1 << 20) | (1 << 22) | (1 << 26) | (1 << 31);
/** Nothing is started for this long after rendering has ended [ms]: a press that was meant for Pause must not start. */
const DEAD_MS = 1000;
/** The header shows a limit that held within this time [s]. */
const LIMITED_FOR_S = 1;

const ENDED: ReadonlySet<RunState> = new Set([RunState.Stopped, RunState.Faulted]);

/** States come 60 times a second; a longer pause than this means that the page or the connection stalled [ms]. */
const LONGEST_PAUSE_MS = 50;

/** The state of the console. Panels read it and send orders through it. */
export class ConsoleModel {
  scene: SceneT | null = null;
  state: WorldStateT | null = null;
  /** Time for which states have come [ms]. It stands still while none comes, or while the page is too busy to read one. */
  stated_ms = 0;
  private state_ms = 0;
  history = new History([]);
  readonly marks = new Marks();
  readonly counters = new SessionCounters();
  paused = false;
  notice: Notice | undefined;
  /** The recording that ended last, until its notice is closed or rendering begins. */
  saved: Recording | undefined;
  /** true when a sample came that is not drawn yet. */
  fresh = false;
  /** Called after a scene came: panels are built for it. */
  onScene: () => void = () => {};
  /** Called when an order was refused, with what it was. */
  onRefused: (what: string, reason: string) => void = () => {};
  private limited_s = -Infinity;
  private ended_ms = -Infinity;
  private faultTicks: { session: number; counts: readonly number[] } = { session: 0, counts: [] };

  constructor(readonly connection: Connection) {
    connection.on('scene', (scene) => this.takeScene(scene));
    connection.on('state', (state) => this.takeState(state));
    connection.on('events', (events) => this.takeEvents(events));
    if (connection.scene) this.takeScene(connection.scene);
  }

  get status(): Status {
    return statusOf(this.connection.status, this.state, this.paused, this.scene?.faultNames ?? [], texts(), this.scene?.axes ?? []);
  }

  /** Whether the page may start: nothing renders, and nothing has for DEAD_MS. */
  get startable(): boolean {
    const { name } = this.status;
    // After a session whose device did not answer at its end, a person may try again.
    const ended = name === 'silent' && this.state !== null && ENDED.has(this.state.runState);
    const startable = ended || ['disarmed', 'stopped', 'faulted'].includes(name);
    return startable && performance.now() - this.ended_ms > DEAD_MS;
  }

  /** Whether the running session is recorded; undefined while none runs. */
  get recorded(): boolean | undefined {
    return this.connection.status === 'open' ? isRecorded(this.scene, this.state) : undefined;
  }

  /** Whether an effort reached its limit within the last LIMITED_FOR_S. */
  get limited(): boolean {
    return this.history.now_s - this.limited_s < LIMITED_FOR_S;
  }

  /** A value of the exercise by its name; undefined where there is none. */
  value(name: string): number | undefined {
    const index = this.scene?.valueNames.indexOf(name) ?? -1;
    return index < 0 ? undefined : this.state?.values[index];
  }

  /** Present value of a live parameter; undefined where there is none. */
  parameter(name: string): number | undefined {
    const index = this.scene?.parameters.findIndex((parameter) => parameter.name === name) ?? -1;
    return index < 0 ? undefined : this.state?.parameters[index];
  }

  /**
   * Sends an order. A therapist needs the controls only for an order that `steers`, which sets who moves the hand. A
   * refusal is returned and, unless `quietly`, shown.
   */
  async command(what: string, send: () => Promise<Answer>, { quietly = false, steers = false } = {}): Promise<Answer> {
    let answer: Answer = { accepted: true, reason: '' };
    if (steers && !this.connection.controls.heldByYou) answer = await this.connection.takeControls();
    if (answer.accepted) answer = await send();
    if (!answer.accepted && !quietly) this.onRefused(what, answer.reason);
    return answer;
  }

  /** Stops at once. Any client may, at any time, without the controls. */
  async emergencyStop(): Promise<void> {
    await this.connection.emergencyStop();
  }

  private takeScene(scene: SceneT): void {
    const axes = (of: SceneT | null): string => JSON.stringify(of?.axes ?? null);
    if (axes(this.scene) !== axes(scene)) this.history = new History(scene.axes);
    if (this.scene?.session !== scene.session) this.paused = false;
    this.scene = scene;
    this.fresh = false;   // the last state belongs to the scene before
    this.onScene();
  }

  private takeState(state: WorldStateT): void {
    const before = this.state;
    const ended = before?.runState === RunState.Rendering && state.runState !== RunState.Rendering;
    if (before && (ended || before.endings !== state.endings)) this.ended_ms = performance.now();
    this.state = state;
    const now_ms = performance.now();
    this.stated_ms += Math.min(now_ms - this.state_ms, LONGEST_PAUSE_MS);
    this.state_ms = now_ms;
    if (state.runState === RunState.Rendering) this.saved = undefined;
    this.paused = (this.value('paused') ?? Number(this.paused)) > 0.5;
    this.counters.onState(state, new Date(), String(this.scene?.recording ?? ''));
    this.takeFaults(state);
    if (!this.history.add(state)) return;
    this.fresh = true;
    this.marks.addRunState(state.runState, this.history.now_s, texts(), state.safetyState === SafetyState.Faulted);
    this.marks.forgetBefore(this.history.now_s - WINDOW_S);
  }

  /** Reads the fault counters. One tick in 17 is sent; the counters cover the others. */
  private takeFaults({ session, faults, faultTicks }: WorldStateT): void {
    const before = this.faultTicks.session === session ? this.faultTicks.counts : [];
    let bits = faults & INFORMATION;
    faultTicks.forEach((count, bit) => { if (count > (before[bit] ?? 0)) bits |= INFORMATION & (1 << bit); });
    // Counting starts anew on a page that was just opened, and in a new session.
    const counted = this.faultTicks.counts.length > 0 || this.faultTicks.session !== 0;
    this.faultTicks = { session, counts: [...faultTicks] };
    if (!counted) bits = faults & INFORMATION;
    if (bits === 0) return;
    if ((bits & (1 << 6)) !== 0) this.limited_s = this.history.now_s;
    this.notice = { at: new Date(), bits };
  }

  private takeEvents(events: readonly EventT[]): void {
    const names = this.scene?.eventNames ?? [];
    const period_s = this.scene?.periodS ?? 1e-3;
    this.marks.addEvents(events, names, (tick) => this.history.timeOfTick(tick, period_s), texts());
    for (const event of events) {
      this.counters.count(String(names[event.type]), names.map(String));
      if (names[event.type] === 'paused') this.paused = true;
      if (names[event.type] === 'resumed' || names[event.type] === 'restarted') this.paused = false;
    }
    if (this.state?.runState !== RunState.Rendering) this.paused = false;
  }
}

/** A part of the page. */
export interface Panel {
  readonly element: HTMLElement;
  /** Draws new samples, once a frame. */
  draw?(): void;
  /** Updates words and numbers, a few times a second. */
  refresh?(): void;
  /** Releases the panel before the page is built again. */
  close?(): void;
}
