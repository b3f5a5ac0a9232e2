import type { Span } from '../console/plot_source';
import { Problem } from './problem';

export interface ReplayEvent { readonly time_s: number; readonly type: number; readonly index: number; readonly value: number }
/** A gap: missing ticks, up to the first existing one. */
export interface Gap extends Span { readonly ticks: number }
export type MarkKind = 'stop' | 'emergency_stop' | 'fault' | 'controls_lost' | 'armed' | 'neutral';
export interface ReplayMark { readonly time_s: number; readonly kind: MarkKind; readonly text: string; readonly axis: string }

/** Smallest and largest values of every channel in the columns of a span of time. */
export interface SeriesPiece extends Span {
  readonly columns: number;
  /** Low and high values by the key of channelKey(). */
  readonly channels: ReadonlyMap<string, { readonly low: Float32Array; readonly high: Float32Array }>;
  readonly events: readonly ReplayEvent[];
  readonly gaps: readonly Gap[];
  /** Spans that exist in the file and cannot be read. */
  readonly unreadable: readonly Span[];
  /** Row of the first tick at or after its begin. */
  readonly first_tick: number;
  readonly marks: readonly ReplayMark[];
  /** The program had more entries than it sends at once. */
  readonly truncated: boolean;
  readonly bytes: number;
}

export const channelKey = (name: string, axis = 0): string => `${name}/${axis}`;

const KINDS: readonly string[] = ['stop', 'emergency_stop', 'fault', 'controls_lost', 'armed', 'neutral'];

type JsonFields = Readonly<Record<string, unknown>>;
const list = (value: unknown): JsonFields[] => (Array.isArray(value) ? value.filter((entry): entry is JsonFields => typeof entry === 'object' && entry !== null) : []);
const number = (value: unknown): number => (typeof value === 'number' ? value : NaN);

/** Reads the answer of .../replay/series. */
export function readPiece(buffer: ArrayBuffer): SeriesPiece {
  if (buffer.byteLength < 4) throw new Problem('nonsense', 'series: no header');
  const length = new DataView(buffer).getUint32(0, true);
  const start = 4 + length;
  if (start > buffer.byteLength) throw new Problem('nonsense', `series: header of ${length} bytes in ${buffer.byteLength}`);
  const header = parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length)));
  const columns = number(header.columns);
  const named = list(header.channels);
  if (!Number.isInteger(columns) || columns < 1 || buffer.byteLength - start < 8 * columns * named.length) {
    throw new Problem('nonsense', `series: ${named.length} channels of ${columns} columns in ${buffer.byteLength - start} bytes`);
  }
  const values = floats(buffer, start, 2 * columns * named.length);
  const channels = new Map(named.map((channel, i) => {
    const low = values.subarray(2 * i * columns, (2 * i + 1) * columns);
    const high = values.subarray((2 * i + 1) * columns, (2 * i + 2) * columns);
    return [channelKey(String(channel.name), Number(channel.axis ?? 0)), { low, high }] as const;
  }));
  return {
    from_s: number(header.from_s), to_s: number(header.to_s), columns, channels, truncated: header.truncated === true, bytes: buffer.byteLength,
    first_tick: number(header.first_tick),
    unreadable: list(header.unreadable).map((span) => ({ from_s: number(span.from_s), to_s: number(span.to_s) })),
    events: list(header.events).map((e) => ({ time_s: number(e.time_s), type: number(e.type), index: number(e.index), value: number(e.value) })),
    gaps: list(header.gaps).map((g) => ({ from_s: number(g.from_s), to_s: number(g.to_s), ticks: number(g.ticks) })),
    marks: list(header.marks).filter((m) => KINDS.includes(String(m.kind))).map((m) => ({
      time_s: number(m.time_s), kind: String(m.kind) as MarkKind, text: String(m.text ?? ''), axis: String(m.axis ?? ''),
    })),
  };
}

function parse(text: string): JsonFields {
  try {
    return JSON.parse(text) as JsonFields;
  } catch {
    throw new Problem('nonsense', 'series: the header is no JSON');
  }
}

/** Reads floats without a copy where byte order and alignment allow it. */
function floats(buffer: ArrayBuffer, start: number, count: number): Float32Array {
  const littleEndian = new Uint8Array(new Uint16Array([1]).buffer)[0] === 1;
  if (littleEndian && start % 4 === 0) return new Float32Array(buffer, start, count);
  const view = new DataView(buffer, start);
  return Float32Array.from({ length: count }, (_, i) => view.getFloat32(4 * i, true));
}
