// The bodies of a game in a recording, row by row.
import { GameBodyList, type GameBodyShown } from '../net/game_bodies';
import { cutMessages, readGameBodies } from './messages';
import { Problem } from './problem';

interface Change { readonly row: number; readonly bodies: readonly GameBodyShown[] }

const HEAD_BYTES = 8;
const NONE: readonly GameBodyShown[] = [];

export class BodiesHistory {
  /** @param changes sorted by row */
  constructor(private readonly changes: readonly Change[] = []) {}

  /** Reads the answer of .../replay/bodies. */
  static read(buffer: ArrayBuffer): BodiesHistory {
    const view = new DataView(buffer);
    const list = new GameBodyList();
    const changes: Change[] = [];
    for (const { at, message } of cutMessages(buffer, HEAD_BYTES)) {
      list.take(readGameBodies(message));
      const row = view.getUint32(at, true);
      if (row < (changes[changes.length - 1]?.row ?? 0)) throw new Problem('nonsense', `bodies: row ${row} comes too late`);
      changes.push({ row, bodies: list.bodies });
    }
    return new BodiesHistory(changes);
  }

  /** Bodies in the world at a row. The same bodies give the same array. */
  at(row: number): readonly GameBodyShown[] {
    let [low, high] = [0, this.changes.length];
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.changes[middle].row <= row) low = middle + 1;
      else high = middle;
    }
    return this.changes[low - 1]?.bodies ?? NONE;
  }
}
