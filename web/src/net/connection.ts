// The page's only connection to the program. It receives messages, sends orders, and reconnects by itself after a loss.
import {
  ArmT, EmergencyStopT, HeartbeatT, LoadExerciseT, LoadProfileT, Refusal, ReleaseControlsT, RestT, RunState, SCHEMA_VERSION, StopT, TakeControlsT,
  type CommissioningT, type ControlsT, type EventT, type SceneT, type WelcomeT, type WorldStateT,
} from '../protocol';
import { text } from '../shared/i18n';
import { GameBodyList, type GameBodyShown } from './game_bodies';
import { ControlHolding, type Hands, type Loss } from './holding';
import type { SocketConnection } from './socket_connection';
import { encodeCommand, Orders, type AnyOrder } from './orders';
import { PendingAnswers, type Answer } from './pending_answers';
import { PendingStop } from './pending_stop';
import { readMessage } from './read_message';
import { refusalText } from './refusals';

export type ConnectionStatus = 'connecting' | 'open' | 'lost';

/** The page and the program have different schema versions: the connection is not tried again. */
export interface VersionProblem { readonly theirs: number; readonly ours: number }

export interface ConnectionEvents {
  state: WorldStateT;
  scene: SceneT;
  events: readonly EventT[];
  controls: ControlsT;
  status: ConnectionStatus;
  welcome: WelcomeT;
  /** The current step of a device's commissioning, from a program that commissions one. */
  commissioning: CommissioningT;
  /** All bodies that a game has put into the world. */
  bodies: readonly GameBodyShown[];
  /** The person leaves this page; this is the last moment to send an order. */
  leaving: void;
}

export interface ConnectionOptions {
  /** ws://… or wss://…, with its query. */
  readonly url: string;
  /** Shown to the program by TakeControls; empty on this machine. */
  readonly token?: string;
  /** Asks the program by HTTP why it refused the connection: a browser reports to a page only that it failed. */
  readonly why?: () => Promise<number>;
  /** Opens the socket; a WebSocket by default. */
  readonly open?: (url: string) => SocketConnection;
}

// Reconnection waits this long [ms], twice as long after every failure, up to the second value.
const FIRST_WAIT_MS = 250;
const LONGEST_WAIT_MS = 2000;
const HEARTBEAT_MS = 50;
const ANSWER_WITHIN_MS = 3000;
// Loading and arming take longer: they stop a run gently, read files and build a world first.
const SLOW_ANSWER_WITHIN_MS = 20_000;
// An open connection that is silent for this long is lost: the program sends 60 states a second.
const SILENCE_MS = 3000;

/** The heartbeats that the connection's own thread sends between the page's orders; their number does not count. */
const HEARTBEATS = { alive: encodeCommand(0, new HeartbeatT()), busy: encodeCommand(0, new HeartbeatT(true)) };

type Listeners = { [Name in keyof ConnectionEvents]: Set<(value: ConnectionEvents[Name]) => void> };

export class Connection extends Orders {
  status: ConnectionStatus = 'connecting';
  /** Set when the program speaks another version; then the page does not try again. */
  problem: VersionProblem | null = null;
  /** 401: the token is missing or wrong, 403: not from this page's origin; 0: not known to be refused. */
  refusedWith = 0;
  latestState: WorldStateT | null = null;
  scene: SceneT | null = null;
  welcome: WelcomeT | null = null;
  commissioning: CommissioningT | null = null;
  /** Failed attempts since the connection was last open. They are shown to the person. */
  attempts = 0;
  /** Messages that could not be read. */
  unreadable = 0;
  /** The newest ending that the program has reported (WorldState.endings); 0 before its first state. */
  endings = 0;
  /** The newest WorldState.basis; 0 before the first state. The scene that it belongs to has come before it. */
  basis = 0;
  /** performance.now() when latestState came [ms]. */
  latestStateAt_ms = 0;

  private readonly gameBodies = new GameBodyList();
  private reading_ms = 0;
  private readonly listeners: Listeners = {
    state: new Set(), scene: new Set(), events: new Set(), controls: new Set(), status: new Set(), welcome: new Set(), commissioning: new Set(), bodies: new Set(), leaving: new Set(),
  };
  private readonly pending = new PendingAnswers();
  private socket: SocketConnection | null = null;
  private lastId = 0;
  private wait_ms = FIRST_WAIT_MS;
  private retryTimer: ReturnType<typeof setTimeout> | undefined;
  private readonly heartbeatTimer: ReturnType<typeof setInterval>;
  private lastMessage_ms = 0;
  private lastHeartbeat_ms = 0;
  private excused = false;  // a turn was late since the program's last message
  private closed = false;
  private readonly controlHolding = new ControlHolding((beats) => this.socket?.keepAlive?.(beats ? HEARTBEATS : null));
  private readonly pendingStop = new PendingStop((id) => this.sendAs(id, new EmergencyStopT()), () => this.notify('status', this.status));

  constructor(private readonly options: ConnectionOptions) {
    super();
    this.heartbeatTimer = setInterval(() => this.heartbeat(), HEARTBEAT_MS);
    this.connect();
  }

  /** Whether this client commands, and whether any client does. */
  get controls(): Hands { return this.controlHolding.hands; }
  /** Why this page lost the controls, until it takes them again. */
  get loss(): Loss { return this.controlHolding.loss; }

  /** The program receives this page's messages and has reported its state. */
  get connected(): boolean { return this.status === 'open' && this.latestState !== null; }

  /** The bodies that a game has put into the world. */
  get bodies(): readonly GameBodyShown[] { return this.gameBodies.bodies; }

  /** Calls back with every later message of that kind; returns what ends it. */
  on<Name extends keyof ConnectionEvents>(name: Name, callback: (value: ConnectionEvents[Name]) => void): () => void {
    const set: Set<(value: ConnectionEvents[Name]) => void> = this.listeners[name];
    set.add(callback);
    return () => { set.delete(callback); };
  }

  /** Sends an order. The answer comes from the program, or from here when it cannot be sent. Never rejects. */
  order(order: AnyOrder): Promise<Answer> { return this.sendAs(++this.lastId, order); }

  private sendAs(id: number, order: AnyOrder): Promise<Answer> {
    const socket = this.socket;
    if (this.status !== 'open' || !socket) return Promise.resolve({ accepted: false, reason: text('line.none') });
    // A hidden page may not start or continue anything; it may always stop.
    if (this.controlHolding.away && !(order instanceof EmergencyStopT || order instanceof StopT || order instanceof RestT)) return Promise.resolve({ accepted: false, reason: text('line.away') });
    const within_ms = order instanceof LoadExerciseT || order instanceof LoadProfileT || order instanceof ArmT ? SLOW_ANSWER_WITHIN_MS : ANSWER_WITHIN_MS;
    const answer = this.pending.wait(id, within_ms, { accepted: false, reason: text('line.silent') });
    if (order instanceof ArmT || order instanceof LoadExerciseT) {
      this.controlHolding.onStartAsked();
      void answer.then(() => this.controlHolding.onStartAnswered());
    }
    socket.send(encodeCommand(id, order));
    return answer;
  }

  /** Sends an emergency stop until the program has confirmed it. The answer comes with the confirmation. */
  emergencyStop(): Promise<Answer> { return this.pendingStop.ask(++this.lastId); }
  /** An emergency stop was requested, and the program has not confirmed it within 300 ms. */
  get stopUnconfirmed(): boolean { return this.pendingStop.unconfirmed; }
  async takeControls(): Promise<Answer> {
    this.controlHolding.requestControls();
    const answer = await this.order(new TakeControlsT(this.options.token ?? ''));
    this.controlHolding.onAnswer(answer.accepted);
    return answer;
  }
  releaseControls(): Promise<Answer> {
    this.controlHolding.giveBack();
    return this.order(new ReleaseControlsT());
  }

  /** Records that the person leaves the page. The page is silent from now on, and the program takes the controls back. */
  leave(): void {
    if (this.controlHolding.away) return;
    this.notify('leaving', undefined);
    this.controlHolding.leave(this.rendering);
  }

  /** Records that the person is back. Lost controls must be taken again by a press. */
  comeBack(): void {
    if (!this.controlHolding.away) return;
    this.controlHolding.comeBack();
    this.notify('status', this.status);
  }

  /** Reconnects at once instead of after the wait. */
  retryNow(): void {
    if (this.status !== 'lost' || this.closed || this.problem) return;
    clearTimeout(this.retryTimer);
    this.connect();
  }

  /** Closes the connection for good. */
  close(): void {
    this.closed = true;
    clearInterval(this.heartbeatTimer);
    clearTimeout(this.retryTimer);
    this.pendingStop.close();
    this.dropSocket();
  }

  /** Main-thread time that reading messages and calling the listeners took since the last call [ms]. */
  takeReading_ms(): number {
    const spent_ms = this.reading_ms;
    this.reading_ms = 0;
    return spent_ms;
  }

  private connect(): void {
    let socket: SocketConnection;
    try {
      socket = (this.options.open ?? ((url) => new WebSocket(url) as SocketConnection))(this.options.url);
    } catch {
      this.lost();
      return;
    }
    this.socket = socket;
    this.noteMessage();
    socket.binaryType = 'arraybuffer';
    socket.onopen = () => {
      this.noteMessage();
      this.wait_ms = FIRST_WAIT_MS;
    };
    socket.onmessage = (event) => {
      const began_ms = performance.now();
      this.read(event.data);
      this.pendingStop.onMessage();
      this.reading_ms += performance.now() - began_ms;
    };
    socket.onclose = (event) => { if (this.socket === socket) this.lost(event.reason); };
  }

  /** @param why the program's reason for closing the connection: a message that it could not read */
  private lost(why = ''): void {
    this.dropSocket();
    this.pending.settleAll({ accepted: false, reason: why === '' ? text('line.lost') : why });
    this.attempts += 1;
    this.setStatus('lost');
    void this.requestReason();
    if (this.closed || this.problem) return;
    clearTimeout(this.retryTimer);
    this.retryTimer = setTimeout(() => this.connect(), this.wait_ms);
    this.wait_ms = Math.min(2 * this.wait_ms, LONGEST_WAIT_MS);
  }

  private async requestReason(): Promise<void> {
    const status = await this.options.why?.().catch(() => 0) ?? 0;
    const refused = status === 401 || status === 403 ? status : 0;
    if (this.status === 'open' || refused === this.refusedWith) return;
    this.refusedWith = refused;
    this.notify('status', this.status);
  }

  private dropSocket(): void {
    const socket = this.socket;
    this.socket = null;
    this.controlHolding.onConnectionLost();
    if (!socket) return;
    socket.onopen = socket.onmessage = socket.onclose = null;
    socket.close();
  }

  private setStatus(status: ConnectionStatus): void {
    this.status = status;
    this.notify('status', status);
  }

  private heartbeat(): void {
    const now_ms = performance.now();
    const late = now_ms - this.lastHeartbeat_ms > 10 * HEARTBEAT_MS;
    this.lastHeartbeat_ms = now_ms;
    if (!this.socket) return;
    if (now_ms - this.lastMessage_ms > SILENCE_MS) {
      // A page that was busy or suspended may have unread messages. It gets one more turn to read them.
      if (!late || this.excused) return this.lost();
      this.excused = true;
    }
    // The answer to a heartbeat is not awaited: the next heartbeat follows.
    if (!this.socket.keepAlive && this.status === 'open' && this.controlHolding.needsHeartbeat) this.socket.send(encodeCommand(++this.lastId, new HeartbeatT()));
  }

  private noteMessage(): void {
    this.lastMessage_ms = performance.now();
    this.excused = false;
  }

  private get rendering(): boolean { return this.latestState?.runState === RunState.Rendering; }

  private notify<Name extends keyof ConnectionEvents>(name: Name, value: ConnectionEvents[Name]): void {
    const set: Set<(value: ConnectionEvents[Name]) => void> = this.listeners[name];
    for (const callback of set) callback(value);
  }

  private read(data: unknown): void {
    this.noteMessage();
    const message = readMessage(data);
    switch (message.is) {
      case 'state': return this.onState(message.value);
      case 'scene':
        this.scene = message.value;
        return this.notify('scene', message.value);
      case 'events': return this.notify('events', message.value);
      case 'welcome': return this.onWelcome(message.value);
      case 'controls': return this.onControls(message.value);
      case 'commissioning':
        this.commissioning = message.value;
        return this.notify('commissioning', message.value);
      case 'bodies':
        this.gameBodies.take(message.value);
        return this.notify('bodies', this.bodies);
      case 'reply': {
        const { command, accepted, refusal, reason } = message.value;
        const unheard = !accepted && refusal === Refusal.NotHeard ? { unheard: true } : {};
        return this.pending.settle(command, { accepted, reason: accepted ? '' : refusalText(refusal, String(reason ?? '')), ...unheard });
      }
      case 'foreign':
        this.problem = { theirs: message.version, ours: SCHEMA_VERSION };
        return this.lost();
      case 'unreadable': return this.countUnreadable();
    }
  }

  private onState(state: WorldStateT): void {
    this.latestState = state;
    if (state.endings !== this.endings) this.controlHolding.onStop();
    this.endings = state.endings;
    this.basis = state.basis;
    this.latestStateAt_ms = this.lastMessage_ms;
    this.notify('state', state);
  }

  private onWelcome(welcome: WelcomeT): void {
    this.welcome = welcome;
    this.gameBodies.clear();
    this.notify('bodies', this.bodies);
    this.endings = this.basis = 0;  // another run of the program counts from 0
    this.attempts = this.refusedWith = 0;
    this.setStatus('open');
    this.pendingStop.onConnected();
    this.notify('welcome', welcome);
  }

  private onControls(controls: ControlsT): void {
    this.controlHolding.onReport({ heldByYou: controls.heldByYou, held: controls.held, role: controls.yourRole, holder: controls.holderRole, led: controls.led }, this.rendering);
    this.notify('controls', controls);
  }

  private countUnreadable(): void {
    this.unreadable += 1;
    if (this.unreadable === 1) console.warn('A message of the program could not be read; further ones are only counted.');
  }
}
