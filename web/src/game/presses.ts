// Turns presses of the person into orders.
import type { Controls } from '../input/controls';
import type { Connection } from '../net/connection';
import { Act, RunState } from '../protocol';
import { text } from '../shared/i18n';
import type { Memory } from './memory';
import type { Sound } from './sound';
import { changeLoaded, letProgramPlay, openCamera, Press, takeOver } from './takeover';
import { isPlaying } from './page_state';

export class Presses {
  private begins = false;  // a press of Start is under way

  constructor(
    private readonly connection: Connection, private readonly controls: Controls,
    private readonly memory: Memory, private readonly sound: Sound,
  ) {
    // A person who leaves while the camera starts must press again.
    connection.on('leaving', () => { if (memory.framing) controls.stopWebcam(); });
  }

  start(): void {
    this.sound.unlock();
    void this.begin();
  }

  async watch(): Promise<void> {
    this.controls.stopWebcam();
    await this.busy(this.press(), (press) => letProgramPlay(this.connection, this.memory.known, press));
    this.memory.wish = 'watch';
    this.memory.isTheirs = true;
  }

  /** Loads the chosen level and hand; the person plays on. */
  async load(): Promise<void> {
    const { connection, memory } = this, { level, hand } = memory;
    const answer = await this.busy(this.press(), (press) => changeLoaded(connection, memory.known, press, { level, hand }));
    memory.notice = answer.reason;
  }

  /** Pauses the exercise while the person reads the praise. */
  hold(): void { void this.connection.act(Act.Pause); }
  again(): void { void this.connection.act(Act.Restart); }
  answer(chosen: 1 | 2): void { void this.connection.choose(chosen); }

  /** Rests between two parts of the exercise; finished parts are kept. */
  async restBetween(): Promise<void> {
    await this.connection.act(Act.Pause);
    this.memory.resting = 'between';
  }

  /** Rests at any time: the device is released gently. The page shows the rest before the program has answered. */
  async rest(): Promise<void> {
    const { connection, memory } = this;
    const starting = memory.press !== null;
    memory.press?.cancel();
    if (memory.framing) this.controls.stopWebcam();
    memory.helpOpen = false;
    if (connection.latestState?.runState !== RunState.Rendering && !starting) return;
    memory.playedBeforeRest = this.begins || isPlaying(memory.situation(connection), connection.latestState);
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
    if (this.memory.partFollows) await this.connection.act(Act.Next);
    this.memory.resting = 'no';
  }

  /** Starts again after a rest with this press alone: the order names the rest as its last ending (ADR 16). */
  private async endRest(): Promise<void> {
    const { connection, memory } = this;
    if (!memory.playedBeforeRest) {
      await this.busy(this.press(), (press) => letProgramPlay(connection, memory.known, press));
      return;
    }
    const wishes = { way: memory.way, level: memory.level, hand: memory.hand, fresh: false };
    const outcome = await this.busy(this.press(), (press) => takeOver(connection, memory.known, press, wishes));
    memory.notice = outcome.is === 'refused' ? outcome.reason : '';
    if (outcome.is === 'playing') memory.wish = 'play';
  }

  stop(): void {
    this.memory.press?.cancel();
    void this.connection.emergencyStop();
    this.controls.stopWebcam();
  }

  /** Continues after the picture was lost and is back. */
  seeAgain(): void {
    this.memory.unseen = 'no';
    void this.connection.act(Act.Resume);
  }

  /** Starts the camera again after a loss. It steers after the same step as the first time. */
  cameraAgain(): void {
    this.memory.way = 'webcam';
    this.start();
  }

  /** Closes the camera; the person continues by another input method. */
  otherWay(): void { this.controls.stopWebcam(); }

  help(): void {
    this.sound.unlock();
    this.memory.helpOpen = !this.memory.helpOpen;
  }

  private async begin(): Promise<void> {
    const { connection, memory } = this;
    const press = this.press();
    const camera = await openCamera(this.controls, memory.way);
    // After a stop in the meantime, here or elsewhere, the person must press again.
    if (!press.holds) return;
    if (!camera.accepted) { memory.notice = camera.reason; return; }
    const wishes = { way: memory.way, level: memory.level, hand: memory.hand, fresh: memory.isTheirs || !memory.credit.own };
    this.begins = true;
    if (wishes.fresh) memory.stars.begin();
    const outcome = await this.busy(press, () => takeOver(connection, memory.known, press, wishes)).finally(() => { this.begins = false; });
    memory.notice = outcome.is === 'refused' ? outcome.reason : '';
    if (outcome.is === 'playing') {
      memory.wish = 'play';
      memory.isTheirs = false;
      memory.remember(connection.latestState);
    }
    // The reason is shown, except after this person's own stop.
    if (outcome.is === 'stopped' && !press.isCancelled) memory.notice = text('refusal.StopNotSeen');
    // Another page plays: this page watches and shows that.
    if (outcome.is === 'another plays') {
      memory.wish = 'watch';
      memory.notice = text('refusal.ControlsHeld');
    }
  }

  /** A press with the endings and the basis that are on the screen now. */
  private press(): Press { return new Press(this.connection, this.memory.endingsShown, this.memory.basisShown); }

  /** Marks that orders are under way: a run that stops to load a level is not shown as stopped. */
  private async busy<Result>(press: Press, orders: (press: Press) => Promise<Result>): Promise<Result> {
    this.memory.press = press;
    try {
      return await orders(press);
    } finally {
      if (this.memory.press === press) this.memory.press = null;
    }
  }
}
