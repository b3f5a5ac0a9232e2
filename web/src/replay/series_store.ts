import type { Span } from '../console/plot_source';
import type { RecordingInfo } from './about';
import { BoundedCache } from './bounded_cache';
import { Loader } from './loader';
import type { Problem } from './problem';
import type { Run, Series, SeriesReader } from './source';
import { SeriesLevels, type Slot } from './series_levels';
import type { SeriesPiece } from './series_piece';

/** Total size of the cached pieces in addition to those of the whole recording [bytes]. */
const MOST_BYTES = 48e6;
/** Number of columns for the whole recording: about the width of the time line in pixels. */
const OVERVIEW = 800;

/** Series of a recording: the whole of it coarsely, and the visible window finely, piece by piece as it loads. */
export class SeriesStore implements Series {
  readonly levels: SeriesLevels;
  private readonly overviewLevel: number;
  private readonly coarse = new Map<string, SeriesPiece>();
  private readonly fine = new BoundedCache<SeriesPiece>(MOST_BYTES);
  private readonly slots = new Map<string, Slot>();
  private readonly loader: Loader<{ readonly piece: SeriesPiece; readonly end_s: number }>;
  private looked: readonly Slot[] = [];
  private whole: Span;

  /** @param came called with every piece; `coarse`: it belongs to the whole recording's */
  constructor(
    private readonly source: SeriesReader, about: Pick<RecordingInfo, 'from_s' | 'to_s' | 'period_s'>,
    came: (piece: SeriesPiece, coarse: boolean) => void, report: (problem: Problem | undefined) => void,
  ) {
    this.whole = { from_s: about.from_s, to_s: about.to_s };
    this.levels = new SeriesLevels(about.from_s, about.to_s, about.period_s);
    this.overviewLevel = this.levels.overview(OVERVIEW);
    this.loader = new Loader(async (key) => {
      const { from_s, to_s, columns } = this.slots.get(key)!;
      const { whole: { to_s: end_s } } = this;
      return { piece: await this.source.readSeries(from_s, to_s, columns), end_s };
    }, (key, { piece, end_s }) => {
      const slot = this.slots.get(key)!;
      this.slots.delete(key);
      // The piece ended with the file, which has grown meanwhile: it is requested again.
      if (end_s < this.whole.to_s && piece.to_s >= end_s - 1e-9) return this.order();
      if (slot.level === this.overviewLevel) this.coarse.set(key, piece);
      else this.fine.put(key, piece, piece.bytes);
      came(piece, slot.level === this.overviewLevel);
      this.order();
    }, report);
    this.order();
  }

  /** Share of the whole recording that is loaded. */
  get progress(): number {
    const slots = this.overviewSlots();
    return slots.length === 0 ? 1 : slots.filter(({ key }) => this.coarse.has(key)).length / slots.length;
  }

  /** Spans of the whole recording that are not loaded yet. */
  missing(): Span[] {
    return this.overviewSlots().filter(({ key }) => !this.coarse.has(key));
  }

  /** Loaded pieces of the whole recording, in order of time. */
  overview(): SeriesPiece[] {
    return this.overviewSlots().map(({ key }) => this.coarse.get(key)).filter((piece) => piece !== undefined);
  }

  /** Requests a window in this many columns. */
  look(window: Span, columns: number): void {
    // The level is never coarser than the overview's, which is loaded anyway: no tick is read twice.
    const level = Math.min(this.overviewLevel, this.levels.levelFor(window.to_s - window.from_s, columns));
    this.looked = this.levels.slots(level, window);
    this.order();
  }

  /** The loaded data of the window: fine pieces, and coarse ones where these are missing. */
  runs(): Run[] {
    return this.looked.flatMap((slot) => {
      const piece = this.piece(slot.key);
      return piece ? [{ piece, from: 0, to: piece.columns, width_s: this.levels.width_s(slot.level) }] : this.coarseRuns(slot);
    });
  }

  /** Extends the recording to this time: pieces that ended with the file are read again. */
  grow(to_s: number): void {
    const old = this.whole.to_s;
    const ends = (piece: SeriesPiece): boolean => piece.to_s >= old - 1e-9;
    for (const [key, piece] of this.coarse) if (ends(piece)) this.coarse.delete(key);
    for (const [key, { value }] of [...this.fine.entries()]) if (ends(value)) this.fine.drop(key);
    this.whole = { ...this.whole, to_s };
    this.levels.grow(to_s);
    this.order();
  }

  retry(): void {
    this.loader.retry();
  }

  close(): void {
    this.loader.close();
    this.fine.clear();
  }

  private overviewSlots(): Slot[] {
    return this.levels.slots(this.overviewLevel, this.whole);
  }

  private piece(key: string): SeriesPiece | undefined {
    return this.coarse.get(key) ?? this.fine.peek(key);
  }

  /** Requests the pieces of the window before those of the whole. */
  private order(): void {
    for (const { key } of this.looked) this.fine.use(key);
    const missing = [...this.looked, ...this.overviewSlots()].filter(({ key }) => !this.piece(key));
    for (const slot of missing) this.slots.set(slot.key, slot);
    this.loader.want([...new Set(missing.map(({ key }) => key))]);
  }

  private coarseRuns(slot: Slot): Run[] {
    const width_s = this.levels.width_s(this.overviewLevel);
    return this.levels.slots(this.overviewLevel, slot).flatMap(({ key, from_s }) => {
      const piece = this.coarse.get(key);
      if (!piece) return [];
      // Columns whose middle lies in the slot, so that none is drawn twice.
      const from = Math.max(0, Math.ceil((slot.from_s - from_s) / width_s - 0.5));
      const to = Math.min(piece.columns, Math.ceil((slot.to_s - from_s) / width_s - 0.5));
      return to > from ? [{ piece, from, to, width_s }] : [];
    });
  }
}
