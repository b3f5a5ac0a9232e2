// The game: connects the program's messages with the page's memory and its display.
import type { Chime } from '../exercises/exercise';
import type { Controls } from '../input/controls';
import type { Connection } from '../net/connection';
import { RunState, type EventT, type SceneT, type WorldStateT } from '../protocol';
import type { ToneName as Tone } from '../hand/tones';
import { Memory } from './memory';
import type { Picture } from './picture';
import { Presses } from './presses';
import { Screen } from './screen';
import { Sound } from './sound';
import { pageState } from './page_state';

/** Default sounds of events, where the exercise has no sound of its own. */
const CHIMES: Readonly<Record<string, Chime>> = { step_done: 'step', level_done: 'done' };

/** The sound of a flow ends when the program has been silent for this long [ms]. */
const SILENT_MS = 500;

export class Game {
  private readonly memory = new Memory();
  private readonly sound = new Sound();
  private readonly screen: Screen;
  private followed: WorldStateT | null = null;

  constructor(root: HTMLElement, play: HTMLElement, private readonly connection: Connection, private readonly controls: Controls) {
    const { memory, sound } = this;
    const presses = new Presses(connection, controls, memory, sound);
    this.screen = new Screen(root, play, { connection, controls, memory, presses, sound });
    connection.on('scene', (scene) => this.takeScene(scene));
    connection.on('events', (events) => this.takeEvents(events));
    connection.on('bodies', (bodies) => this.screen.setBodies(bodies));
    controls.onRefused = (reason) => { memory.notice = reason; };
    controls.onMode((way) => { if (way) memory.way = way; });
    controls.onWebcam = (view, reason) => this.screen.camera(view, reason);
  }

  get tone(): Tone { return this.memory.tone; }

  /** The camera step is shown: nobody plays yet. */
  get framing(): boolean { return this.memory.framing; }

  /** Sets the picture; null: it cannot be drawn. */
  setPicture(picture: Picture | null): void {
    this.screen.setPicture(picture);
    this.controls.pointing = picture ? (x_px, y_px) => picture.rowPoint(x_px, y_px) : undefined;
  }

  /** The browser lost the picture, or has it again: a player who needs it waits until they continue. */
  pictureLost(lost: boolean): void {
    this.memory.unseen = lost ? 'lost' : 'back';
    this.frame();
  }

  /** Called once a frame, and by a timer where frames are slow. */
  frame(): void {
    const { memory, connection } = this;
    const { latestState: state, status } = connection;
    memory.everOpen ||= status === 'open';
    if (performance.now() - connection.latestStateAt_ms > SILENT_MS) {
      this.sound.flow(0, 0);
      this.sound.gurgle(0);
    }
    if (state && state !== this.followed) this.takeState(state);
    const now = pageState(memory.situation(connection), memory.play, state);
    if (memory.unseen === 'back' && now !== 'unseen') memory.unseen = 'no';
    this.screen.show(now, state);
    memory.endingsShown = connection.endings;
    memory.basisShown = connection.basis;
  }

  private takeScene(scene: SceneT): void {
    this.followed = this.connection.latestState;   // it belongs to the scene before
    this.memory.takeScene(scene);
    this.screen.setScene(scene);
  }

  private takeState(state: WorldStateT): void {
    this.followed = state;
    this.memory.takeState(state);
    if (this.controls.help !== this.memory.help) this.controls.help = this.memory.help;
    this.memory.rememberCredit();
    this.screen.setState(state);
    const { play } = this.memory;
    const { rate, level, air = 0, sound } = play?.flow(state) ?? { rate: 0, level: 0 };
    const renders = state.runState === RunState.Rendering && !state.silent;
    this.sound.flow(renders ? rate : 0, level, sound);
    this.sound.gurgle(renders ? air : 0);
    const chime = play?.takeChime?.();
    if (chime) this.sound.chime(chime);
  }

  private takeEvents(events: readonly EventT[]): void {
    for (const event of events) {
      const name = String(this.connection.scene?.eventNames[event.type] ?? '');
      const words = this.memory.play?.panel?.event(event.type);
      if (words) this.screen.hud.panel.showEvent(words, performance.now());
      const chime = this.memory.play?.chimes[name] ?? CHIMES[name];
      if (chime) this.sound.chime(chime);
    }
  }
}
