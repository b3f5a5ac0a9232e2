import type { SceneT } from '../protocol';
import { readAbout, type RecordingInfo } from './about';
import { BodiesHistory } from './bodies_history';
import { readScene, splitStates } from './messages';
import { Problem } from './problem';
import { recordingUrl, reportUrl } from '../console/recordings';
import { readPiece, type SeriesPiece } from './series_piece';
import { SeriesStore } from './series_store';
import type { Series, Source, States } from './source';
import { StateStore } from './state_store';

/** A request without an answer within this time has failed [ms]; the program's own readers have 60 s. */
const PATIENCE_MS = 90_000;

export type Fetch = (address: string, init?: { signal?: AbortSignal }) => Promise<Response>;

/** Requests the data of one recording from the program. Every failure is a Problem. */
export class RecordingSource implements Source {
  constructor(readonly name: string, private readonly token: string, private readonly get: Fetch = (address, init) => fetch(address, init)) {}

  get reportUrl(): string {
    return reportUrl(this.name, this.token);
  }

  /** The address of the report itself, once it is made. */
  get madeUrl(): string {
    return recordingUrl(this.name, true, this.token);
  }

  async about(): Promise<RecordingInfo> {
    const answer = await this.ask('about');
    return readAbout(await this.body(answer.json() as Promise<unknown>));
  }

  async scene(): Promise<SceneT> {
    return readScene(new Uint8Array(await this.bytes('scene')));
  }

  async bodies(): Promise<BodiesHistory> {
    return BodiesHistory.read(await this.bytes('bodies'));
  }

  states(about: RecordingInfo, changed: () => void, report: (problem: Problem | undefined) => void): States {
    return new StateStore(this, about.ticks, changed, report);
  }

  series(about: RecordingInfo, came: (piece: SeriesPiece) => void, report: (problem: Problem | undefined) => void): Series {
    return new SeriesStore(this, about, came, report);
  }

  /** Messages of the rows first, first + step, ...; fewer at the end of the file. */
  async readStates(first: number, count: number, step: number): Promise<Uint8Array[]> {
    return splitStates(await this.bytes('states', { tick: first, count, step }));
  }

  /** @pre to_s - from_s <= 60 */
  async readSeries(from_s: number, to_s: number, columns: number): Promise<SeriesPiece> {
    return readPiece(await this.bytes('series', { from_s, to_s, columns }));
  }

  private async bytes(what: string, query: Readonly<Record<string, number>> = {}): Promise<ArrayBuffer> {
    return this.body((await this.ask(what, query)).arrayBuffer());
  }

  private async ask(what: string, query: Readonly<Record<string, number>> = {}): Promise<Response> {
    const wanted = new URLSearchParams(Object.entries(query).map(([key, value]) => [key, String(value)]));
    if (this.token !== '') wanted.set('token', this.token);
    const asked = wanted.toString();
    const address = `/api/recordings/${encodeURIComponent(this.name)}/replay/${what}${asked === '' ? '' : `?${asked}`}`;
    let answer: Response;
    try {
      answer = await this.get(address, { signal: AbortSignal.timeout(PATIENCE_MS) });
    } catch {
      throw new Problem('gone');
    }
    if (answer.ok) return answer;
    if (answer.status === 404) throw new Problem('unknown');
    if (answer.status === 401 || answer.status === 403) throw new Problem('denied');
    if (answer.status >= 500 || answer.status === 429) throw new Problem('gone', `HTTP ${answer.status}`);
    throw new Problem('unreadable', await errorText(answer));
  }

  private async body<T>(coming: Promise<T>): Promise<T> {
    try {
      return await coming;
    } catch (thrown) {
      // A truncated answer means that the program went away. A complete answer that is not JSON comes from another program.
      throw thrown instanceof SyntaxError ? new Problem('nonsense', 'no JSON') : new Problem('gone');
    }
  }
}

async function errorText(answer: Response): Promise<string> {
  try {
    const said = JSON.parse(await answer.text()) as { error?: unknown };
    if (typeof said.error === 'string') return said.error;
  } catch { /* the status describes the failure well enough */ }
  return `HTTP ${answer.status}`;
}
