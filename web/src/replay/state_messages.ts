import type { WorldStateT } from '../protocol';
import { readState, timeOfState } from './messages';

/** States that are kept as messages: each is read when it is asked for, the last one once. */
export abstract class StateMessages {
  private read: { row: number; state: WorldStateT } | undefined;

  /** Of a known row. */
  protected abstract messageOf(row: number): Uint8Array | undefined;

  /** Time of a row, as its state gives it; undefined where that is not known. */
  time_s(row: number): number | undefined {
    const message = this.messageOf(row);
    return message && timeOfState(message);
  }

  /** The state of a known row; throws a Problem where its message cannot be read. */
  state(row: number): WorldStateT | undefined {
    if (this.read?.row === row) return this.read.state;
    const message = this.messageOf(row);
    if (!message) return undefined;
    this.read = { row, state: readState(message) };
    return this.read.state;
  }
}
