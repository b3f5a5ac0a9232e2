// What the person presses becomes orders.
import type { Controls } from '../input/controls';
import type { Connection } from '../net/connection';
import { Act, RunState } from '../protocol';
import { text } from '../shared/i18n';
import type { Memory } from './memory';
import type { Sound } from './sound';
import { changeLevel, letProgramPlay, openCamera, Press, takeOver } from './takeover';
import { isPlaying } from './view';

export class Presses {
  constructor(
    private readonly connection: Connection, private readonly controls: Controls,
    private readonly memory: Memory, private readonly sound: Sound,
  ) {}

  start(): void {
    this.sound.unlock();
    void this.begin();
  }

  async watch(): Promise<void> {
    this.controls.stopWebcam();
    await this.busy(this.press(), (press) => letProgramPlay(this.connection, press));
    this.memory.wish = 'watch';
    this.memory.isTheirs = true;
  }

  async load(level: number): Promise<void> {
    this.memory.chooseLevel(level);
    const answer = await this.busy(this.press(), (press) => changeLevel(this.connection, this.memory.known, press, level));
    this.memory.notice = answer.reason;
  }

  /** Praise stays as long as the person likes: the bar would go on to the next drink by itself. */
  hold(): void { void this.connection.act(Act.Pause); }
  again(): void { void this.connection.act(Act.Restart); }

  /** Between two drinks: what was done stays done. */
  async restBetween(): Promise<void> {
    await this.connection.act(Act.Pause);
    this.memory.resting = 'between';
  }

  /** At any time: the device lets go gently. It is shown at once, whatever the program does. */
  async rest(): Promise<void> {
    const { connection, memory } = this;
    const starting = memory.press !== null;
    memory.press?.cancel();
    if (memory.framing) this.controls.stopWebcam();
    memory.helpOpen = false;
    if (connection.latestState?.runState !== RunState.Rendering && !starting) return;
    memory.playedBeforeRest = isPlaying(memory.situation(connection), connection.latestState);
    memory.beginRest();
    memory.notice = '';
    const answer = await connection.rest();
    if (answer.accepted) return;
    memory.resting = 'no';
    memory.notice = answer.reason;
  }

  async goOn(): Promise<void> {
    if (this.memory.resting === 'off') return this.endRest();
    await this.connection.act(Act.Resume);
    if (this.memory.drinkFollows) await this.connection.act(Act.Next);
    this.memory.resting = 'no';
  }

  /** Whoever rested starts again, by this press alone: the order names the rest as its last ending (ADR 16). */
  private async endRest(): Promise<void> {
    const { connection, memory } = this;
    if (!memory.playedBeforeRest) {
      await this.busy(this.press(), (press) => letProgramPlay(connection, press));
      return;
    }
    const wishes = { way: memory.way, level: memory.level, fresh: false };
    const outcome = await this.busy(this.press(), (press) => takeOver(connection, memory.known, press, wishes));
    memory.notice = outcome.is === 'refused' ? outcome.reason : '';
    if (outcome.is === 'playing') memory.wish = 'play';
  }

  stop(): void {
    this.memory.press?.cancel();
    void this.connection.emergencyStop();
    this.controls.stopWebcam();
  }

  /** The picture that was lost is back, and the person goes on. */
  seeAgain(): void {
    this.memory.unseen = 'no';
    void this.connection.act(Act.Resume);
  }

  /** The camera, after it was gone: with its step before it steers, like the first time. */
  cameraAgain(): void {
    this.memory.way = 'webcam';
    this.start();
  }

  /** Not the camera after all: whoever played goes on by other ways. */
  otherWay(): void { this.controls.stopWebcam(); }

  help(): void {
    this.sound.unlock();
    this.memory.helpOpen = !this.memory.helpOpen;
  }

  private async begin(): Promise<void> {
    const { connection, memory } = this;
    const press = this.press();
    if (connection.status !== 'open' || !connection.latestState) { memory.notice = text('welcome.connecting'); return; }
    const camera = await openCamera(this.controls, memory.way);
    // Stopped meanwhile, here or elsewhere: it has to be pressed again.
    if (!press.holds) return;
    if (!camera.accepted) { memory.notice = camera.reason; return; }
    const wishes = { way: memory.way, level: memory.level, fresh: memory.isTheirs };
    const outcome = await this.busy(press, () => takeOver(connection, memory.known, press, wishes));
    memory.notice = outcome.is === 'refused' ? outcome.reason : '';
    if (outcome.is === 'playing') {
      memory.wish = 'play';
      memory.isTheirs = false;
    }
    // Somebody else plays: there is nothing to do about it here but to watch, and that is said.
    if (outcome.is === 'another plays') memory.wish = 'watch';
  }

  /** Of this moment, with what is on the screen. */
  private press(): Press { return new Press(this.connection, this.memory.endingsShown); }

  /** While orders are on their way: a run that is stopped to load a level is no stop to speak of. */
  private async busy<Result>(press: Press, orders: (press: Press) => Promise<Result>): Promise<Result> {
    this.memory.press = press;
    try {
      return await orders(press);
    } finally {
      if (this.memory.press === press) this.memory.press = null;
    }
  }
}
