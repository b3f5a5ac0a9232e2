// Gives the viewer the recording inside the page. Nothing is loaded later, and no finer data exist.
import type { Span } from '../console/plot_source';
import type { SceneT } from '../protocol';
import type { RecordingInfo } from '../replay/about';
import type { BodiesHistory } from '../replay/bodies_history';
import { Problem } from '../replay/problem';
import type { SeriesPiece } from '../replay/series_piece';
import type { Run } from '../replay/source';
import type { Series, Source, States } from '../replay/source';
import { StateMessages } from '../replay/state_messages';
import type { ReportData } from './report_data';

/** The states at some rows of the recording. */
export class EmbeddedStates extends StateMessages implements States {
  /** @param rows sorted, one for each message */
  constructor(private readonly rows: readonly number[], private readonly messages: readonly Uint8Array[]) {
    super();
  }

  wantAround(): void {}
  wantFrom(): void {}

  existing(row: number): number {
    return this.nearest(row) ?? row;
  }

  stepped(row: number, states: number): number {
    const at = Math.min(this.rows.length - 1, Math.max(0, this.indexOf(row) + states));
    return this.rows[at] ?? row;
  }

  nearest(row: number): number | undefined {
    return this.rows[this.indexOf(row)];
  }

  grow(): void {}
  retry(): void {}
  close(): void {}

  /** Index of the row nearest to this one. */
  private indexOf(row: number): number {
    let [low, high] = [0, this.rows.length - 1];
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.rows[middle] < row) low = middle + 1;
      else high = middle;
    }
    return low > 0 && row - this.rows[low - 1] <= this.rows[low] - row ? low - 1 : low;
  }

  protected messageOf(row: number): Uint8Array | undefined {
    const at = this.indexOf(row);
    return this.rows[at] === row ? this.messages[at] : undefined;
  }
}

/** One piece with the whole recording. */
class EmbeddedSeries implements Series {
  readonly progress = 1;
  private readonly whole: Run;

  constructor(private readonly piece: SeriesPiece) {
    this.whole = { piece, from: 0, to: piece.columns, width_s: (piece.to_s - piece.from_s) / piece.columns };
  }

  look(): void {}
  runs(): Run[] { return [this.whole]; }
  overview(): SeriesPiece[] { return [this.piece]; }
  missing(): Span[] { return []; }
  grow(): void {}
  retry(): void {}
  close(): void {}
}

export class EmbeddedRecording implements Source {
  readonly reportUrl = '#';

  constructor(private readonly data: ReportData) {}

  get name(): string {
    return this.data.about.name;
  }

  async about(): Promise<RecordingInfo> {
    return this.data.about;
  }

  async scene(): Promise<SceneT> {
    if (!this.data.scene) throw new Problem('unreadable', this.data.about.no_picture_because);
    return this.data.scene;
  }

  async bodies(): Promise<BodiesHistory> {
    return this.data.bodies;
  }

  states(): States {
    return new EmbeddedStates(this.data.rows, this.data.states);
  }

  series(_about: RecordingInfo, came: (piece: SeriesPiece) => void): Series {
    queueMicrotask(() => came(this.data.series));
    return new EmbeddedSeries(this.data.series);
  }
}
