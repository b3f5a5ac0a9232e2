// What the person presses becomes orders.
import type { Controls } from '../input/controls';
import type { Connection } from '../net/connection';
import { Act } from '../protocol';
import { text } from '../shared/i18n';
import type { Memory } from './memory';
import type { Sound } from './sound';
import { changeLevel, letProgramPlay, openCamera, Press, takeOver } from './takeover';

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
    await this.busy(this.press(), (press) => letProgramPlay(this.connection, press));
    this.memory.wish = 'watch';
  }

  async load(level: number): Promise<void> {
    this.memory.chooseLevel(level);
    const answer = await this.busy(this.press(), (press) => changeLevel(this.connection, this.memory.known, press, level));
    this.memory.notice = answer.reason;
  }

  /** Praise stays as long as the person likes: the bar would go on to the next drink by itself. */
  hold(): void { void this.connection.act(Act.Pause); }
  again(): void { void this.connection.act(Act.Restart); }

  async rest(): Promise<void> {
    await this.connection.act(Act.Pause);
    this.memory.resting = true;
  }

  async goOn(): Promise<void> {
    await this.connection.act(Act.Resume);
    if (this.memory.drinkFollows) await this.connection.act(Act.Next);
    this.memory.resting = false;
  }

  stop(): void {
    this.memory.press?.cancel();
    void this.connection.emergencyStop();
  }

  help(): void {
    this.sound.unlock();
    this.memory.helpOpen = !this.memory.helpOpen;
  }

  private async begin(): Promise<void> {
    const { connection, memory } = this;
    const press = this.press();
    if (connection.status !== 'open' || !connection.latestState) { memory.notice = text('welcome.connecting'); return; }
    const camera = await openCamera(this.controls, memory.way);
    if (!camera.accepted) { memory.notice = camera.reason; return; }
    const wishes = { way: memory.way, level: memory.level, fresh: memory.wish === 'undecided' };
    const outcome = await this.busy(press, () => takeOver(connection, memory.known, press, wishes));
    memory.notice = outcome.is === 'refused' ? outcome.reason : '';
    if (outcome.is === 'playing') memory.wish = 'play';
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
