import { BoundedCache } from './bounded_cache';
import { Loader } from './loader';
import type { Problem } from './problem';
import type { StateReader, States } from './source';
import { StateMessages } from './state_messages';

/** Number of rows in one request. */
export const BLOCK = 64;
/** Total size of the cached messages [bytes]. */
const MOST_BYTES = 48e6;
/** Blocks that are requested during playback: the present one and two ahead. */
const AHEAD = [0, 1, 2];

interface Block { readonly first: number; readonly step: number; readonly messages: readonly Uint8Array[] }

const keyOf = (step: number, index: number): string => `${step}:${index}`;

/** The step between requested states for `rows` rows between two shown ones: 1, 4, 16, ... */
export function stepFor(rows: number): number {
  return 4 ** Math.max(0, Math.floor(Math.log(Math.max(1, rows) * 1.000001) / Math.log(4)));
}

/** States of a recording: blocks of rows, loaded on demand; the last used ones are kept. */
export class StateStore extends StateMessages implements States {
  private readonly blocks = new BoundedCache<Block>(MOST_BYTES);
  private readonly loader: Loader<{ readonly messages: Uint8Array[]; readonly ticks: number }>;

  /** @param changed called when states came */
  constructor(private readonly source: StateReader, private ticks: number, changed: () => void, report: (problem: Problem | undefined) => void) {
    super();
    this.loader = new Loader(async (key) => {
      const [step, index] = key.split(':').map(Number);
      const { ticks: asked } = this;
      return { messages: await this.source.readStates(index * BLOCK * step, this.rowsIn(step, index), step), ticks: asked };
    }, (key, { messages, ticks: asked }) => {
      const [step, index] = key.split(':').map(Number);
      // The block ended with the file, which has grown meanwhile: it is requested again.
      if (messages.length < BLOCK && asked < this.ticks) return changed();
      this.blocks.put(key, { first: index * BLOCK * step, step, messages }, messages.reduce((sum, { length }) => sum + length, 200));
      changed();
    }, report);
  }

  /** Extends the file: blocks that ended with it are read again. */
  grow(ticks: number): void {
    for (const [key, { value }] of [...this.blocks.entries()]) {
      if (value.messages.length < BLOCK) this.blocks.drop(key);
    }
    this.ticks = ticks;
  }

  /** Requests the row that a person chose and its neighbours, then those around it at a coarser step. */
  wantAround(row: number, step: number): void {
    const exact = Math.floor(row / BLOCK);
    this.want([keyOf(1, exact), keyOf(step, Math.floor(row / BLOCK / step)), keyOf(1, exact + 1), keyOf(1, exact - 1)]);
  }

  /** Requests the rows from this one on, for playback. */
  wantFrom(row: number, step: number): void {
    const index = Math.floor(row / BLOCK / step);
    this.want(AHEAD.map((ahead) => keyOf(step, index + ahead)));
  }

  existing(row: number): number {
    return row;
  }

  stepped(row: number, states: number): number {
    return row + states;
  }

  /** The loaded row nearest to this one; undefined: none is loaded yet. */
  nearest(row: number): number | undefined {
    if (this.blocks.peek(keyOf(1, Math.floor(row / BLOCK)))?.messages[row % BLOCK]) return row;
    let found: number | undefined;
    for (const [, { value: { first, step, messages } }] of this.blocks.entries()) {
      if (messages.length === 0) continue;
      const place = Math.min(messages.length - 1, Math.max(0, Math.round((row - first) / step)));
      const here = first + place * step;
      if (found === undefined || Math.abs(here - row) < Math.abs(found - row)) found = here;
    }
    return found;
  }

  get bytes(): number {
    return this.blocks.size;
  }

  retry(): void {
    this.loader.retry();
  }

  close(): void {
    this.loader.close();
    this.blocks.clear();
  }

  protected messageOf(row: number): Uint8Array | undefined {
    const exact = this.blocks.use(keyOf(1, Math.floor(row / BLOCK)))?.messages[row % BLOCK];
    if (exact) return exact;
    for (const [, { value: { first, step, messages } }] of this.blocks.entries()) {
      if (row >= first && (row - first) % step === 0 && messages[(row - first) / step]) return messages[(row - first) / step];
    }
    return undefined;
  }

  private rowsIn(step: number, index: number): number {
    return Math.max(0, Math.min(BLOCK, Math.ceil((this.ticks - index * BLOCK * step) / step)));
  }

  private want(keys: readonly string[]): void {
    const there = keys.filter((key) => {
      const [step, index] = key.split(':').map(Number);
      return index >= 0 && this.rowsIn(step, index) > 0;
    });
    this.loader.want([...new Set(there)].filter((key) => !this.blocks.use(key)));
  }
}
