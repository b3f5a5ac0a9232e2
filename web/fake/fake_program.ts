// A stand-in for the program inside the page, for development and tests: the same bytes without a network connection.
// Options, all in the address beside ?fake:
//     level=2       which level            at=pour     plays at once until that stage
//     held          another client commands          lost=8    the connection breaks after 8 s for 5 s
//     version=9     uses another schema version      hardware  a device that is not simulated
//     fault=12      sets that bit of Scene.fault_names after a second, on the first axis
import * as flatbuffers from 'flatbuffers';
import {
  Act, Action, Aim, Arm, AxisT, CapsuleT, Command, ControlsT, DeviceStateT, EventsT, EventT, ReleaseReason, LoadExercise, Message, MessageT, Order,
  ParameterGroup, ParameterRangeT, ParameterT, Payload, Refusal, ReplyT, RunState, SafetyState, SceneT, SCHEMA_VERSION, SetParameter, StatisticsT, Steer, Steering,
  WelcomeT, WorldStateT,
} from '../src/protocol';
import type { SocketConnection } from '../src/net/socket_connection';
import { BAR_FILE } from '../src/exercises/cocktail_bar/bar';
import { AXES, FakeBar, LEVEL_NAMES } from './fake_bar';
import { describeBar, EVENT_NAMES, fillBar, playTo } from './fake_messages';
import { HAND, type Triple } from './fake_hand';
import { pose, vec } from './fake_shapes';

/** The stand-in has one person, and one client that changes levels and limits. */
const BASIS = 1;
const PERIOD_MS = 1000 / 60;
const FAULT_NAMES = ['device read failed', 'device write failed', 'non-finite device position', 'non-finite effort', 'non-finite state',
  'physics step failed', 'effort limited', 'late tick', 'contacts dropped', 'singular reduced inertia', 'stop requested', 'emergency stop',
  'speed limit exceeded', 'workspace left', 'power limited', 'effort slew limited', 'encoder jumped', 'encoder stuck', 'late ticks in a row',
  'gap too long', 'owner silent', 'bodies exploded', 'tank damped', 'drive fault', 'enable lost',
  'stale sample', 'drive hot', 'gentle stop', 'samples delayed', 'effort astray',
  'world gives energy', 'contacts unsettled'];
const STOP_REQUESTED = 1 << 10;
const EMERGENCY_STOP = 1 << 11;
const FAULT_AFTER_S = 1;

const PARAMETERS = [
  ['effort_limit_hand_tip_n', ParameterGroup.Patient, 'N', 2, 10, 10, 2],
  ['effort_limit_arm_n', ParameterGroup.Patient, 'N', 4, 20, 20, 4],
  ['damping_full_n', ParameterGroup.Patient, 'N', 1, 10, 5, 2],
  ['damping_decay_s', ParameterGroup.Hand, 's', 0.05, 1, 0.3, 0.2],
  ['wall_stiffness_ratio', ParameterGroup.Exercise, '', 0, 1.2, 1, 0.2],
  ['viscosity_ratio', ParameterGroup.Exercise, '', 0.1, 2, 1, 0.5],
  ['lead_in_m', ParameterGroup.Exercise, 'm', 0.001, 0.01, 0.004, 0.002],
  ['squeeze_threshold_ratio', ParameterGroup.Exercise, '', 0.5, 2, 1, 0.25],
] as const;

export class FakeProgram {
  private bar: FakeBar;
  private runState = RunState.Rendering;
  private steering = Steering.VirtualPatient;
  private authority = 1;
  private tick = 0;
  private session = 1;
  private latched = 0;
  private faulted = false;
  private endings = 1;
  private rested = false;
  private heldByClient = false;
  private readonly parameters = PARAMETERS.map((p) => ({ now: p[5] as number, target: p[5] as number }));
  private readonly version: number;
  private readonly started_ms = performance.now();
  private breaksAt_ms: number;

  constructor(private readonly options: URLSearchParams) {
    this.bar = new FakeBar(this.level(options.get('level')));
    this.version = Number(options.get('version') ?? SCHEMA_VERSION);
    this.breaksAt_ms = options.has('lost') ? this.started_ms + 1000 * Number(options.get('lost')) : Infinity;
    playTo(this.bar, options.get('at') ?? '', Number(options.get('drink') ?? 0), Number(options.get('step') ?? 0));
    const further_s = Number(options.get('further') ?? 0);
    for (let k = 0; k < 60 * further_s; k++) this.bar.advance(1 / 60, true, true);
  }

  /** Opens a new connection to it; several may be open at once. */
  connect(): SocketConnection {
    if (performance.now() > this.breaksAt_ms && performance.now() < this.breaksAt_ms + 5000) throw new Error('not there');
    const socket: SocketConnection & { timer?: ReturnType<typeof setInterval> } = {
      binaryType: 'arraybuffer', onopen: null, onmessage: null, onclose: null,
      send: (data) => { setTimeout(() => this.receive(socket, data), 1); },
      close: () => { clearInterval(socket.timer); },
    };
    setTimeout(() => {
      socket.onopen?.({} as Event);
      this.send(socket, Payload.Welcome, new WelcomeT(SCHEMA_VERSION, 1, true, '0.3.0 (stand-in)'));
      this.send(socket, Payload.Controls, new ControlsT(false, this.options.has('held')));
      this.send(socket, Payload.Scene, this.scene());
      let last_ms = performance.now();
      socket.timer = setInterval(() => {
        const now_ms = performance.now();
        if (now_ms > this.breaksAt_ms && now_ms < this.breaksAt_ms + 5000) {
          clearInterval(socket.timer);
          socket.onclose?.({} as CloseEvent);
          return;
        }
        this.advance(Math.min(0.1, (now_ms - last_ms) / 1000));
        last_ms = now_ms;
        this.send(socket, Payload.WorldState, this.state());
        const events = this.bar.takeEvents();
        if (events.length > 0)
          this.send(socket, Payload.Events, new EventsT(events.map((e) => new EventT(BigInt(this.tick), EVENT_NAMES.indexOf(e.name), e.index, e.value))));
      }, PERIOD_MS);
    }, 20);
    return socket;
  }

  /** The state of the safety supervisor, derived from the loop's state. */
  private safetyState(): SafetyState {
    if (this.faulted) return SafetyState.Faulted;
    if (this.runState !== RunState.Rendering && this.authority === 0) return SafetyState.Disarmed;
    return this.authority < 1 && this.runState === RunState.Rendering ? SafetyState.Armed : SafetyState.Rendering;
  }

  private fail(bit: number): void {
    this.faulted = true;
    this.endings += 1;
    this.latched = 1 << bit;
    this.runState = RunState.Stopping;
  }

  /** Advances the simulation by this time [s]. */
  advance(dt: number): void {
    const bit = this.options.get('fault');
    if (bit !== null && this.session === 1 && !this.faulted && performance.now() - this.started_ms > 1000 * FAULT_AFTER_S) this.fail(Number(bit));
    this.tick += Math.round(dt * 1000);
    const on = this.runState === RunState.Rendering;
    this.authority = Math.max(0, Math.min(1, this.authority + (on ? 4 : -4) * dt));
    if (this.runState === RunState.Stopping && this.authority === 0) this.runState = this.faulted ? RunState.Faulted : RunState.Stopped;
    this.bar.advance(dt, this.steering === Steering.VirtualPatient, on);
    this.parameters.forEach((p, i) => {
      const most = PARAMETERS[i][6] * dt;
      p.now += Math.max(-most, Math.min(most, p.target - p.now));
    });
  }

  private level(text: string | null): number { return Math.max(1, Math.min(LEVEL_NAMES.length, Number(text ?? 3) || 1)); }

  private send(socket: SocketConnection, kind: Payload, payload: unknown): void {
    const builder = new flatbuffers.Builder(4096);
    Message.finishMessageBuffer(builder, new MessageT(this.version, kind, payload as MessageT['payload']).pack(builder));
    socket.onmessage?.({ data: builder.asUint8Array().slice().buffer } as MessageEvent);
  }

  private receive(socket: SocketConnection, data: Uint8Array<ArrayBuffer>): void {
    const message = Message.getRootAsMessage(new flatbuffers.ByteBuffer(data));
    if (message.payloadType() !== Payload.Command) return;
    const command = message.payload(new Command()) as Command;
    const refusal = this.apply(socket, command);
    this.send(socket, Payload.Reply, new ReplyT(command.id(), refusal === Refusal.None, Refusal[refusal], refusal));
  }

  private apply(socket: SocketConnection, command: Command): Refusal {
    const kind = command.orderType();
    const held = this.options.has('held');
    if (kind === Order.EmergencyStop) return this.halt(EMERGENCY_STOP);
    if (kind === Order.TakeControls) {
      if (held) return Refusal.ControlsHeld;
      this.heldByClient = true;
      this.send(socket, Payload.Controls, new ControlsT(true, true));
      return Refusal.None;
    }
    if (!this.heldByClient && kind !== Order.Stop && kind !== Order.Rest) return Refusal.NotHolder;
    switch (kind) {
      case Order.ReleaseControls:
        this.heldByClient = false;
        this.steering = Steering.VirtualPatient;
        this.send(socket, Payload.Controls, new ControlsT(false, false));
        return Refusal.None;
      case Order.Arm:
        if ((command.order(new Arm()) as Arm).endingsSeen() !== this.endings) return Refusal.StopNotSeen;
        if ((command.order(new Arm()) as Arm).basisSeen() !== BASIS) return Refusal.BasisChanged;
        if (this.runState === RunState.Rendering) return Refusal.ArmedAlready;
        this.runState = RunState.Rendering;
        this.latched = 0;
        this.faulted = false;
        this.session += 1;
        this.bar.restart();
        this.send(socket, Payload.Scene, this.scene());
        return Refusal.None;
      case Order.Stop: return this.halt();
      case Order.Rest: {
        const rests = this.heldByClient && this.runState === RunState.Rendering;
        this.halt();
        this.rested = rests;
        return Refusal.None;
      }
      case Order.Steer: this.steering = (command.order(new Steer()) as Steer).by(); return Refusal.None;
      case Order.Aim: {
        const aim = command.order(new Aim()) as Aim;
        if (aim.qLength() !== AXES.length) return Refusal.NotAPosture;
        if (this.steering === Steering.Person) AXES.forEach((_, i) => { this.bar.intention[i] = aim.q(i) ?? 0; });
        return Refusal.None;
      }
      case Order.SetParameter: return this.setParameter(command.order(new SetParameter()) as SetParameter);
      case Order.LoadExercise: {
        const order = command.order(new LoadExercise()) as LoadExercise;
        const level = order.level() || this.bar.level;
        if (level > LEVEL_NAMES.length) return Refusal.CannotLoad;
        if (order.exercise() && order.exercise() !== BAR_FILE) return Refusal.UnknownExercise;
        this.bar = new FakeBar(level);
        this.send(socket, Payload.Scene, this.scene());
        return Refusal.None;
      }
      case Order.Action: {
        const act = (command.order(new Action()) as Action).act();
        if (act === Act.Next) this.bar.next();
        if (act === Act.Restart) this.bar.restart();
        if (act === Act.Pause || act === Act.Resume) this.bar.paused = act === Act.Pause;
        return Refusal.None;
      }
      default: return Refusal.None;
    }
  }

  private halt(why = 0): Refusal {
    if (this.runState === RunState.Rendering) this.runState = RunState.Stopping;
    this.latched |= STOP_REQUESTED | why;
    this.endings += 1;
    this.rested = false;
    return Refusal.None;
  }

  private setParameter(order: SetParameter): Refusal {
    const index = PARAMETERS.findIndex((p) => p[0] === order.name());
    if (index < 0) return Refusal.UnknownParameter;
    const [, , , lower, upper] = PARAMETERS[index];
    if (!(order.value() >= lower && order.value() <= upper)) return Refusal.OutOfRange;
    this.parameters[index].target = order.value();
    return Refusal.None;
  }

  scene(): SceneT {
    const s = new SceneT(this.session, '0.3.0 (stand-in)', BAR_FILE, HAND.name, true, this.options.has('hardware') ? 'lambda-pride' : 'simulated lambda-pride', 'relaxed-adult', BAR_FILE);
    s.periodS = 0.001;
    s.axes = AXES.map((a) => new AxisT(a.name, a.unit, a.lower, a.upper, a.limit, a.lever, a.speed));
    s.jointNames = HAND.joints;
    s.linkNames = HAND.links.map((l) => l.name);
    s.capsules = HAND.capsules.map((c) => new CapsuleT(c.name, c.part, c.link, vec(c.a as unknown as Triple), vec(c.b as unknown as Triple), c.r));
    describeBar(s, this.bar);
    s.faultNames = FAULT_NAMES;
    s.parameters = PARAMETERS.map(([name, group, unit, lower, upper, initial, rate]) => new ParameterT(name, group, unit, lower, upper, initial, rate, new ParameterRangeT(lower, upper, initial), name.startsWith('effort_limit_')));
    s.exercises = [BAR_FILE, 'free-grasping'];
    s.hands = [HAND.name, 'woman-p50-right'];
    s.levels = LEVEL_NAMES.length;
    s.level = this.bar.level;
    return s;
  }

  state(): WorldStateT {
    const bar = this.bar, s = new WorldStateT();
    s.session = this.session;
    s.endings = this.endings;
    s.basis = BASIS;
    s.rested = this.rested && this.runState !== RunState.Rendering;
    s.tick = BigInt(this.tick);
    s.timeS = bar.time_s;
    s.sentMonotonicNs = BigInt(Math.round(performance.now() * 1e6));
    s.runState = this.runState;
    s.steering = this.steering;
    s.latchedFaults = s.faults = this.runState === RunState.Rendering ? 0 : this.latched;
    s.safetyState = this.safetyState();
    s.faultAxis = this.faulted ? 0 : -1;
    s.faultValue = this.faulted ? 1.62 : 0;
    s.faultLimit = this.faulted ? 1.5 : 0;
    s.authority = this.authority;
    s.qM = bar.qM;
    s.qS = bar.qS;
    s.theta = bar.theta;
    s.intention = this.options.has('hardware') ? [] : bar.intention;  // a real device has no virtual patient
    const wobble = (i: number) => 0.05 * Math.sin(bar.time_s * (5 + i)) * AXES[i].limit / 20;
    s.coupling = AXES.map((a, i) => Math.max(-a.limit, Math.min(a.limit, a.spring * (bar.qS[i] - bar.qM[i]) + wobble(i))));
    s.exerciseEffort = AXES.map((_, i) => (i === 3 || i === 5 ? -bar.alpha * 0.02 * bar.squeeze_n : 0));
    s.phi = AXES.map((a, i) => Math.min(1, Math.abs(s.coupling[i]) / (0.5 * a.limit)));
    s.damping = s.phi.map((phi, i) => -0.1 * phi * Math.sin(bar.time_s * 3 + i) * AXES[i].limit / 20);
    s.sent = s.coupling.map((c, i) => this.authority * (c + s.exerciseEffort[i] + s.damping[i]));
    s.alpha = bar.alpha;
    s.links = bar.links.map((l) => pose(l.p, l.q));
    fillBar(s, this.bar);
    s.parameters = this.parameters.map((p) => p.now);
    s.settings = this.parameters.map((p) => p.target);
    s.statistics = new StatisticsT(BigInt(this.tick), BigInt(2), BigInt(0), 148 + 4 * Math.random(), 236, 402, 890);
    s.recordingBytes = BigInt(this.tick * 400);
    const enabled = this.runState !== RunState.Disarmed;
    s.device = this.options.has('hardware') ? new DeviceStateT(enabled, true, false, true, 38, 0.001, true, 0.0003, ReleaseReason.None) : null;
    return s;
  }
}
