// The page's only connection to the program. It brings messages, sends orders, and comes back by itself after a loss.
import {
  ArmT, EmergencyStopT, HeartbeatT, LoadExerciseT, LoadProfileT, ReleaseControlsT, RestT, RunState, SCHEMA_VERSION, StopT, TakeControlsT,
  type CommissioningT, type ControlsT, type EventT, type SceneT, type WelcomeT, type WorldStateT,
} from '../protocol';
import { text } from '../shared/i18n';
import { GameBodyList, type GameBodyShown } from './game_bodies';
import { Holding, type Hands, type Loss } from './holding';
import type { Line } from './line';
import { encodeCommand, Orders, type AnyOrder } from './orders';
import { PendingAnswers, type Answer } from './pending_answers';
import { PendingStop } from './pending_stop';
import { readMessage } from './read_message';
import { refusalText } from './refusals';

export type ConnectionStatus = 'connecting' | 'open' | 'lost';

/** The page and the program speak different versions: the connection is not tried again. */
export interface VersionProblem { readonly theirs: number; readonly ours: number }

export interface ConnectionEvents {
  state: WorldStateT;
  scene: SceneT;
  events: readonly EventT[];
  controls: ControlsT;
  status: ConnectionStatus;
  welcome: WelcomeT;
  /** The step of a device's commissioning, from a program that leads through one. */
  commissioning: CommissioningT;
  /** All bodies of a game in the world. */
  bodies: readonly GameBodyShown[];
  /** The person leaves this page; this is the last moment to order something. */
  leaving: void;
}

export interface ConnectionOptions {
  /** ws://… or wss://…, with its query. */
  readonly url: string;
  /** Shown to the program by TakeControls; empty on this machine. */
  readonly token?: string;
  /** Asks the program by HTTP why it refused the connection: a browser reports to a page only that it failed. */
  readonly why?: () => Promise<number>;
  /** Makes the line; a WebSocket by default. */
  readonly open?: (url: string) => Line;
}

// Reconnection waits this long [ms], twice as long after every failure, up to the second value.
const FIRST_WAIT_MS = 250;
const LONGEST_WAIT_MS = 2000;
const HEARTBEAT_MS = 50;
const ANSWER_WITHIN_MS = 3000;
// Loading and arming take longer: they stop a run gently, read files and build a world first.
const SLOW_ANSWER_WITHIN_MS = 20_000;
// An open line that is silent for this long is lost: the program sends 60 states a second.
const SILENCE_MS = 3000;

/** The beat that the line's own thread sends between the page's orders; its number does not count. */
const BEAT = encodeCommand(0, new HeartbeatT());

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
  /** Failed attempts since the line was last open, for the person to see that something happens. */
  attempts = 0;
  /** Messages that could not be read. */
  unreadable = 0;
  /** The newest ending that the program has reported (WorldState.endings); 0 before its first state. */
  endings = 0;
  /** performance.now() when latestState came [ms]. */
  latestStateAt_ms = 0;

  private readonly gameBodies = new GameBodyList();
  private reading_ms = 0;
  private readonly listeners: Listeners = {
    state: new Set(), scene: new Set(), events: new Set(), controls: new Set(), status: new Set(), welcome: new Set(), commissioning: new Set(), bodies: new Set(), leaving: new Set(),
  };
  private readonly pending = new PendingAnswers();
  private line: Line | null = null;
  private lastId = 0;
  private wait_ms = FIRST_WAIT_MS;
  private retryTimer: ReturnType<typeof setTimeout> | undefined;
  private readonly beatTimer: ReturnType<typeof setInterval>;
  private heard_ms = 0;
  private beat_ms = 0;
  private excused = false;  // a late turn, since the program's last message
  private closed = false;
  private readonly holding = new Holding((beats) => this.line?.hold?.(beats ? BEAT : null));
  private readonly stopAsked = new PendingStop((id) => this.sendAs(id, new EmergencyStopT()), () => this.tell('status', this.status));

  constructor(private readonly options: ConnectionOptions) {
    super();
    this.beatTimer = setInterval(() => this.beat(), HEARTBEAT_MS);
    this.connect();
  }

  /** Whether this client commands, and whether any client does. */
  get controls(): Hands { return this.holding.hands; }
  /** Why this page lost them, until they are taken anew. */
  get loss(): Loss { return this.holding.loss; }

  /** The program receives this page's messages and has reported its state. */
  get connected(): boolean { return this.status === 'open' && this.latestState !== null; }

  /** Of a game, in the world. */
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
    const line = this.line;
    if (this.status !== 'open' || !line) return Promise.resolve({ accepted: false, reason: text('line.none') });
    // Nothing begins or goes on by an order of a page that nobody sees; a stop always may.
    if (this.holding.away && !(order instanceof EmergencyStopT || order instanceof StopT || order instanceof RestT)) return Promise.resolve({ accepted: false, reason: text('line.away') });
    const within_ms = order instanceof LoadExerciseT || order instanceof LoadProfileT || order instanceof ArmT ? SLOW_ANSWER_WITHIN_MS : ANSWER_WITHIN_MS;
    const answer = this.pending.wait(id, within_ms, { accepted: false, reason: text('line.silent') });
    line.send(encodeCommand(id, order));
    return answer;
  }

  /** Sends an emergency stop until the program has confirmed it, and then answers. */
  emergencyStop(): Promise<Answer> { return this.stopAsked.ask(++this.lastId); }
  /** An emergency stop was asked for, and the program has not said within 300 ms that it has it. */
  get stopUnconfirmed(): boolean { return this.stopAsked.unconfirmed; }
  async takeControls(): Promise<Answer> {
    this.holding.asks();
    const answer = await this.order(new TakeControlsT(this.options.token ?? ''));
    this.holding.answered(answer.accepted);
    return answer;
  }
  releaseControls(): Promise<Answer> {
    this.holding.gives();
    return this.order(new ReleaseControlsT());
  }

  /** Takes note that the person leaves the page. It is silent from now on, and the program takes the controls back. */
  leave(): void {
    if (this.holding.away) return;
    this.tell('leaving', undefined);
    this.holding.leave(this.rendering);
  }

  /** Takes note that the person is back. Controls that were lost have to be taken anew, by a press. */
  comeBack(): void { this.holding.away = false; }

  /** Tries at once instead of after the wait. */
  retryNow(): void {
    if (this.status !== 'lost' || this.closed || this.problem) return;
    clearTimeout(this.retryTimer);
    this.connect();
  }

  /** Closes the connection for good. */
  close(): void {
    this.closed = true;
    clearInterval(this.beatTimer);
    clearTimeout(this.retryTimer);
    this.stopAsked.close();
    this.dropLine();
  }

  /** Main-thread time that reading messages (and those who listen) took since the last call [ms]. */
  takeReading_ms(): number {
    const spent_ms = this.reading_ms;
    this.reading_ms = 0;
    return spent_ms;
  }

  private connect(): void {
    let line: Line;
    try {
      line = (this.options.open ?? ((url) => new WebSocket(url) as Line))(this.options.url);
    } catch {
      this.lost();
      return;
    }
    this.line = line;
    this.heard();
    line.binaryType = 'arraybuffer';
    line.onopen = () => {
      this.heard();
      this.wait_ms = FIRST_WAIT_MS;
    };
    line.onmessage = (event) => {
      const began_ms = performance.now();
      this.read(event.data);
      this.stopAsked.heard();
      this.reading_ms += performance.now() - began_ms;
    };
    line.onclose = (event) => { if (this.line === line) this.lost(event.reason); };
  }

  /** @param why the program's reason for closing the line: a message that it could not read */
  private lost(why = ''): void {
    this.dropLine();
    this.pending.settleAll({ accepted: false, reason: why === '' ? text('line.lost') : why });
    this.attempts += 1;
    this.setStatus('lost');
    void this.askWhy();
    if (this.closed || this.problem) return;
    clearTimeout(this.retryTimer);
    this.retryTimer = setTimeout(() => this.connect(), this.wait_ms);
    this.wait_ms = Math.min(2 * this.wait_ms, LONGEST_WAIT_MS);
  }

  private async askWhy(): Promise<void> {
    const status = await this.options.why?.().catch(() => 0) ?? 0;
    const refused = status === 401 || status === 403 ? status : 0;
    if (this.status === 'open' || refused === this.refusedWith) return;
    this.refusedWith = refused;
    this.tell('status', this.status);
  }

  private dropLine(): void {
    const line = this.line;
    this.line = null;
    this.holding.lineGone();
    if (!line) return;
    line.onopen = line.onmessage = line.onclose = null;
    line.close();
  }

  private setStatus(status: ConnectionStatus): void {
    this.status = status;
    this.tell('status', status);
  }

  private beat(): void {
    const now_ms = performance.now();
    const late = now_ms - this.beat_ms > 10 * HEARTBEAT_MS;
    this.beat_ms = now_ms;
    if (!this.line) return;
    if (now_ms - this.heard_ms > SILENCE_MS) {
      // A page that was busy or asleep may not have read what came meanwhile. It does until its next turn.
      if (!late || this.excused) return this.lost();
      this.excused = true;
    }
    // The answer to a beat is not waited for: the next beat follows.
    if (!this.line.hold && this.status === 'open' && this.holding.beats) this.line.send(encodeCommand(++this.lastId, new HeartbeatT()));
  }

  private heard(): void {
    this.heard_ms = performance.now();
    this.excused = false;
  }

  private get rendering(): boolean { return this.latestState?.runState === RunState.Rendering; }

  private tell<Name extends keyof ConnectionEvents>(name: Name, value: ConnectionEvents[Name]): void {
    const set: Set<(value: ConnectionEvents[Name]) => void> = this.listeners[name];
    for (const callback of set) callback(value);
  }

  private read(data: unknown): void {
    this.heard();
    const message = readMessage(data);
    switch (message.is) {
      case 'state': return this.takeState(message.value);
      case 'scene':
        this.scene = message.value;
        return this.tell('scene', message.value);
      case 'events': return this.tell('events', message.value);
      case 'welcome': return this.takeWelcome(message.value);
      case 'controls': return this.receiveControls(message.value);
      case 'commissioning':
        this.commissioning = message.value;
        return this.tell('commissioning', message.value);
      case 'bodies':
        this.gameBodies.take(message.value);
        return this.tell('bodies', this.bodies);
      case 'reply': {
        const { command, accepted, refusal, reason } = message.value;
        return this.pending.settle(command, { accepted, reason: accepted ? '' : refusalText(refusal, String(reason ?? '')) });
      }
      case 'foreign':
        this.problem = { theirs: message.version, ours: SCHEMA_VERSION };
        return this.lost();
      case 'unreadable': return this.countUnreadable();
    }
  }

  private takeState(state: WorldStateT): void {
    this.latestState = state;
    if (state.endings !== this.endings) this.holding.ended();
    this.endings = state.endings;
    this.latestStateAt_ms = this.heard_ms;
    this.tell('state', state);
  }

  private takeWelcome(welcome: WelcomeT): void {
    this.welcome = welcome;
    this.gameBodies.clear();
    this.tell('bodies', this.bodies);
    this.endings = 0;  // another run of the program counts anew
    this.attempts = this.refusedWith = 0;
    this.setStatus('open');
    this.stopAsked.lineLives();
    this.tell('welcome', welcome);
  }

  private receiveControls(controls: ControlsT): void {
    this.holding.update({ heldByYou: controls.heldByYou, held: controls.held, role: controls.yourRole, holder: controls.holderRole, led: controls.led }, this.rendering);
    this.tell('controls', controls);
  }

  private countUnreadable(): void {
    this.unreadable += 1;
    if (this.unreadable === 1) console.warn('A message of the program could not be read; further ones are only counted.');
  }
}
