import type { WorldStateT } from '../protocol';
import { readState, timeOfState } from './messages';

/** States stored as messages. A message is parsed when its state is requested; the last parsed state is kept. */
export abstract class StateMessages {
  private read: { row: number; state: WorldStateT } | undefined;

  /** The message of a loaded row. */
  protected abstract messageOf(row: number): Uint8Array | undefined;

  /** Time of a row from its state; undefined where the state is not loaded. */
  time_s(row: number): number | undefined {
    const message = this.messageOf(row);
    return message && timeOfState(message);
  }

  /** The state of a loaded row; throws a Problem if its message cannot be read. */
  state(row: number): WorldStateT | undefined {
    if (this.read?.row === row) return this.read.state;
    const message = this.messageOf(row);
    if (!message) return undefined;
    this.read = { row, state: readState(message) };
    return this.read.state;
  }
}
