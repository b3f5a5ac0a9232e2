// The page's only way to the program: messages in, orders out, by itself back after a loss.
import * as flatbuffers from 'flatbuffers';
import {
  Act, ActionT, AimT, AnswerT, ArmT, Commissioning, Controls, EmergencyStopT, Events, HeartbeatT, type Help, HoldToMoveT, LoadExerciseT, LoadProfileT, Message, Payload, ReleaseControlsT, Reply, RestT,
  RunState, SaveProfileT, Scene, SCHEMA_VERSION, SetHelpT, SetParameterT, Steering, SteerT, StopT, TakeControlsT, Welcome, WorldState,
  type CommissioningT, type ControlsT, type EventT, type SceneT, type WelcomeT, type WorldStateT,
} from '../protocol';
import { text } from '../shared/i18n';
import { Holding, type Hands, type Loss } from './holding';
import { encodeCommand, type AnyOrder } from './orders';
import { PendingStop } from './pending_stop';
import { refusalText } from './refusals';

export type ConnectionStatus = 'connecting' | 'open' | 'lost';

/** Why no connection can be: it is not tried again by itself. */
export interface VersionProblem { readonly theirs: number; readonly ours: number }

/** `reason`: for the person, in the page's language; empty when accepted. */
export interface Answer { readonly accepted: boolean; readonly reason: string }

export interface ConnectionEvents {
  state: WorldStateT;
  scene: SceneT;
  events: readonly EventT[];
  controls: ControlsT;
  status: ConnectionStatus;
  welcome: WelcomeT;
  /** What a program that leads through a device's commissioning is at. */
  commissioning: CommissioningT;
  /** The person leaves this page: the last moment to order something. */
  leaving: void;
}

/** The part of a WebSocket that is used; net/fake_program.ts is another one. */
export interface Line {
  binaryType: string;
  onopen: ((event: Event) => void) | null;
  onmessage: ((event: MessageEvent) => void) | null;
  onclose: ((event: CloseEvent) => void) | null;
  send(data: Uint8Array<ArrayBuffer>): void;
  /** Sends this by itself, often, for as long as the page answers; null: no more. Without it the page does so. */
  hold?(beat: Uint8Array<ArrayBuffer> | null): void;
  close(): void;
}

export interface ConnectionOptions {
  /** ws://… or wss://…, with its query. */
  readonly url: string;
  /** Shown to the program by TakeControls; empty on this machine. */
  readonly token?: string;
  /** Asks the program by HTTP why it takes no line: a browser tells a page nothing but that it failed. */
  readonly why?: () => Promise<number>;
  /** Makes the line; a WebSocket unless told otherwise. */
  readonly open?: (url: string) => Line;
}

// Reconnection waits this long [ms], twice as long after every failure, up to the second value.
const FIRST_WAIT_MS = 250;
const LONGEST_WAIT_MS = 2000;
const HEARTBEAT_MS = 50;
const ANSWER_WITHIN_MS = 3000;
// Loading and arming stop a run gently, read files and build a world first.
const SLOW_ANSWER_WITHIN_MS = 20_000;
// Of an open line that says nothing at all: the program sends 60 states a second.
const SILENCE_MS = 3000;

/** Sent by the line's own thread, between the page's orders: the number of a beat does not count. */
const BEAT = encodeCommand(0, new HeartbeatT());

interface Waiting { readonly settle: (answer: Answer) => void; readonly timer: ReturnType<typeof setTimeout> }
type Listeners = { [Name in keyof ConnectionEvents]: Set<(value: ConnectionEvents[Name]) => void> };

export class Connection {
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
  /** The newest ending that the program has told of (WorldState.endings); 0 before its first state. */
  endings = 0;
  /** performance.now() when latestState came [ms]. */
  latestStateAt_ms = 0;

  private reading_ms = 0;
  private readonly listeners: Listeners = {
    state: new Set(), scene: new Set(), events: new Set(), controls: new Set(), status: new Set(), welcome: new Set(), commissioning: new Set(), leaving: new Set(),
  };
  private readonly waiting = new Map<number, Waiting>();
  private line: Line | null = null;
  private lastId = 0;
  private wait_ms = FIRST_WAIT_MS;
  private retryTimer: ReturnType<typeof setTimeout> | undefined;
  private readonly beatTimer: ReturnType<typeof setInterval>;
  private heard_ms = 0;
  private beat_ms = 0;
  private closed = false;
  private readonly holding = new Holding((beats) => this.line?.hold?.(beats ? BEAT : null));
  private readonly stopAsked = new PendingStop(() => this.order(new EmergencyStopT()), () => this.tell('status', this.status));

  constructor(private readonly options: ConnectionOptions) {
    this.beatTimer = setInterval(() => this.beat(), HEARTBEAT_MS);
    this.connect();
  }

  /** Whether this client commands, and whether any client does. */
  get controls(): Hands { return this.holding.hands; }
  /** Why this page lost them, until they are taken anew. */
  get loss(): Loss { return this.holding.loss; }

  /** Calls back with every later message of that kind; returns what ends it. */
  on<Name extends keyof ConnectionEvents>(name: Name, callback: (value: ConnectionEvents[Name]) => void): () => void {
    const set: Set<(value: ConnectionEvents[Name]) => void> = this.listeners[name];
    set.add(callback);
    return () => { set.delete(callback); };
  }

  /** Sends an order. The answer comes from the program, or from here when it cannot be sent. Never rejects. */
  order(order: AnyOrder): Promise<Answer> {
    const line = this.line;
    if (this.status !== 'open' || !line) return Promise.resolve({ accepted: false, reason: text('line.none') });
    // Nothing begins or goes on by an order of a page that nobody sees; a stop always may.
    if (this.holding.away && !(order instanceof EmergencyStopT || order instanceof StopT || order instanceof RestT)) return Promise.resolve({ accepted: false, reason: text('line.away') });
    const id = ++this.lastId;
    const within_ms = order instanceof LoadExerciseT || order instanceof LoadProfileT || order instanceof ArmT ? SLOW_ANSWER_WITHIN_MS : ANSWER_WITHIN_MS;
    return new Promise((settle) => {
      const timer = setTimeout(() => this.settle(id, { accepted: false, reason: text('line.silent') }), within_ms);
      this.waiting.set(id, { settle, timer });
      line.send(encodeCommand(id, order));
    });
  }

  /** `endingsSeen`: what `endings` was when the person was shown what they pressed on. */
  arm(endingsSeen: number): Promise<Answer> { return this.order(new ArmT(endingsSeen)); }
  stop(): Promise<Answer> { return this.order(new StopT()); }
  /** A gentle stop that the same page may end by arming again. */
  rest(): Promise<Answer> { return this.order(new RestT()); }
  /** Sent until the program has confirmed it; answered then. */
  emergencyStop(): Promise<Answer> { return this.stopAsked.ask(); }
  /** An emergency stop was asked for, and the program has not said within 300 ms that it has it. */
  get stopUnconfirmed(): boolean { return this.stopAsked.unconfirmed; }
  /** Empty names and level 0 leave that part as it is. */
  loadExercise(exercise: string, level: number, hand: string): Promise<Answer> {
    return this.order(new LoadExerciseT(exercise, level, hand));
  }
  /** Of a patient, by name: what is loaded and set now; or what was saved, while nothing is armed. */
  saveProfile(name: string): Promise<Answer> { return this.order(new SaveProfileT(name)); }
  loadProfile(name: string): Promise<Answer> { return this.order(new LoadProfileT(name)); }
  /** What pages do for the player; Unsaid: the player chooses. */
  setHelp(help: Help): Promise<Answer> { return this.order(new SetHelpT(help)); }
  setParameter(name: string, value: number): Promise<Answer> { return this.order(new SetParameterT(name, value)); }
  /** Where the person wants to be, one value per axis of the scene [m or rad]. */
  aim(q: number[]): Promise<Answer> { return this.order(new AimT(q)); }
  steer(by: Steering): Promise<Answer> { return this.order(new SteerT(by)); }
  act(act: Act): Promise<Answer> { return this.order(new ActionT(act)); }
  /** To a question of a commissioning, by its number. */
  answer(question: number, words: string): Promise<Answer> { return this.order(new AnswerT(question, words)); }
  /** A button is held, or let go, without which a commissioning moves nothing. */
  holdToMove(press: number, held: boolean): Promise<Answer> { return this.order(new HoldToMoveT(press, held)); }
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

  /** The person leaves the page: it is silent from now on, and the program takes the controls back by itself. */
  leave(): void {
    if (this.holding.away) return;
    this.tell('leaving', undefined);
    this.holding.leave(this.rendering);
  }

  /** The person is here again. What was lost must be taken anew, by a press. */
  comeBack(): void { this.holding.away = false; }

  /** Tries at once instead of after the wait. */
  retryNow(): void {
    if (this.status !== 'lost' || this.closed || this.problem) return;
    clearTimeout(this.retryTimer);
    this.connect();
  }

  /** Ends it for good. */
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
    this.heard_ms = performance.now();
    line.binaryType = 'arraybuffer';
    line.onopen = () => {
      this.heard_ms = performance.now();
      this.wait_ms = FIRST_WAIT_MS;
    };
    line.onmessage = (event) => {
      const began_ms = performance.now();
      this.read(event.data);
      this.reading_ms += performance.now() - began_ms;
    };
    line.onclose = () => { if (this.line === line) this.lost(); };
  }

  private lost(): void {
    this.dropLine();
    for (const id of [...this.waiting.keys()]) this.settle(id, { accepted: false, reason: text('line.lost') });
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

  private settle(id: number, answer: Answer): void {
    const waiting = this.waiting.get(id);
    if (!waiting) return;
    clearTimeout(waiting.timer);
    this.waiting.delete(id);
    waiting.settle(answer);
  }

  private setStatus(status: ConnectionStatus): void {
    this.status = status;
    this.tell('status', status);
  }

  private beat(): void {
    // A page that was busy or asleep has not read what came meanwhile: that is no silence of the program.
    const now_ms = performance.now();
    if (now_ms - this.beat_ms > 10 * HEARTBEAT_MS) this.heard_ms = now_ms;
    this.beat_ms = now_ms;
    if (!this.line) return;
    if (now_ms - this.heard_ms > SILENCE_MS) {
      this.lost();
      return;
    }
    // Not answered for: a beat whose answer is lost is followed by the next one.
    if (!this.line.hold && this.status === 'open' && this.holding.beats) this.line.send(encodeCommand(++this.lastId, new HeartbeatT()));
  }

  private get rendering(): boolean { return this.latestState?.runState === RunState.Rendering; }

  private tell<Name extends keyof ConnectionEvents>(name: Name, value: ConnectionEvents[Name]): void {
    const set: Set<(value: ConnectionEvents[Name]) => void> = this.listeners[name];
    for (const callback of set) callback(value);
  }

  private read(data: unknown): void {
    this.heard_ms = performance.now();
    let message: Message;
    try {
      const buffer = new flatbuffers.ByteBuffer(new Uint8Array(data as ArrayBuffer));
      if (!Message.bufferHasIdentifier(buffer)) throw new Error('not a Wholehand message');
      message = Message.getRootAsMessage(buffer);
      if (message.schemaVersion() !== SCHEMA_VERSION) {
        this.problem = { theirs: message.schemaVersion(), ours: SCHEMA_VERSION };
        this.lost();
        return;
      }
    } catch {
      this.countUnreadable();
      return;
    }
    this.dispatch(message);
  }

  // There is no verifier in this language: a WebSocket brings whole messages, and the program verifies its own.
  private dispatch(message: Message): void {
    const unpack = <Table extends { unpack(): unknown }>(table: Table): ReturnType<Table['unpack']> | null => {
      try {
        return (message.payload(table as never) as Table).unpack() as ReturnType<Table['unpack']>;
      } catch {
        this.countUnreadable();
        return null;
      }
    };
    switch (message.payloadType()) {
      case Payload.WorldState: {
        const state = unpack(new WorldState());
        if (!state) return;
        this.latestState = state;
        if (state.endings !== this.endings) this.holding.ended();
        this.endings = state.endings;
        this.latestStateAt_ms = this.heard_ms;
        this.tell('state', state);
        return;
      }
      case Payload.Scene: {
        const scene = unpack(new Scene());
        if (!scene) return;
        this.scene = scene;
        this.tell('scene', scene);
        return;
      }
      case Payload.Events: {
        const events = unpack(new Events());
        if (events) this.tell('events', events.events);
        return;
      }
      case Payload.Welcome: {
        const welcome = unpack(new Welcome());
        if (!welcome) return;
        this.welcome = welcome;
        this.endings = 0;  // another run of the program counts anew
        this.attempts = this.refusedWith = 0;
        this.setStatus('open');
        this.tell('welcome', welcome);
        return;
      }
      case Payload.Controls: {
        const controls = unpack(new Controls());
        if (!controls) return;
        this.holding.told({ heldByYou: controls.heldByYou, held: controls.held, role: controls.yourRole, holder: controls.holderRole, led: controls.led }, this.rendering);
        this.tell('controls', controls);
        return;
      }
      case Payload.Commissioning: {
        const commissioning = unpack(new Commissioning());
        if (!commissioning) return;
        this.commissioning = commissioning;
        this.tell('commissioning', commissioning);
        return;
      }
      case Payload.Reply: {
        const reply = unpack(new Reply());
        if (reply) this.settle(reply.command, { accepted: reply.accepted, reason: reply.accepted ? '' : refusalText(reply.refusal, String(reply.reason ?? '')) });
        return;
      }
      default:
        this.countUnreadable();
    }
  }

  private countUnreadable(): void {
    this.unreadable += 1;
    if (this.unreadable === 1) console.warn('A message of the program could not be read; further ones are only counted.');
  }
}
