// The replay's data from the program, by the contract of src/replay/replay_question.hpp.
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { quantityWords } from '../src/shared/format';
import { FakeRecordings, framed } from '../fake/fake_recordings';
import { readAbout } from '../src/replay/about';
import { BoundedCache } from '../src/replay/bounded_cache';
import { Loader } from '../src/replay/loader';
import { readState, splitStates } from '../src/replay/messages';
import { asProblem, Problem, type ProblemKind } from '../src/replay/problem';
import { RecordingSource } from '../src/replay/recording_source';
import { LONGEST_S, SeriesLevels } from '../src/replay/series_levels';
import { channelKey, readPiece, type SeriesPiece } from '../src/replay/series_piece';
import { SeriesStore } from '../src/replay/series_store';
import { BLOCK, StateStore, stepFor } from '../src/replay/state_store';
import { TimeMap } from '../src/replay/time_map';
import { WindowSamples } from '../src/replay/window_samples';

const ABOUT = { name: 'a.h5', period_s: 0.001, ticks: 10, from_s: 0, to_s: 0.01 };
const kindOf = (read: () => unknown): ProblemKind | 'none' => {
  try { read(); } catch (thrown) { return asProblem(thrown).kind; }
  return 'none';
};
const sourceOf = (fake: FakeRecordings, name = 'a.h5'): RecordingSource => new RecordingSource(name, '', (address) => fake.answer(address));

describe('the description of a recording', () => {
  it('is read as reported; missing fields are unknown and not false', () => {
    expect(readAbout(ABOUT)).toMatchObject({ ticks: 10, whole: true, picture: true, still_written: false, title: '', result: [], unreadable_from_s: undefined });
    expect(readAbout({ ...ABOUT, whole: false, unreadable_from_s: 4, result: [{ label: 'Score', value: 87, unit: '' }, 'x'] }))
      .toMatchObject({ whole: false, unreadable_from_s: 4, result: [{ label: 'Score', value: '87', unit: '' }] });
  });

  it.each([null, [], 'x', {}, { ...ABOUT, period_s: 0 }, { ...ABOUT, ticks: 1.5 }, { ...ABOUT, ticks: -1 }, { ...ABOUT, to_s: -1 }, { ...ABOUT, from_s: 'NaN' }])(
    'is refused where nothing can be shown of it: %j', (json) => { expect(kindOf(() => readAbout(json))).toBe('nonsense'); });

  it('has texts of limited length', () => { expect(readAbout({ ...ABOUT, title: 'x'.repeat(10_000) }).title).toHaveLength(2000); });

  it.each([[404, 'unknown'], [401, 'denied'], [403, 'denied'], [422, 'unreadable'], [400, 'unreadable'], [500, 'gone'], [503, 'gone'], [429, 'gone']] as const)(
    'as HTTP %i is a problem: %s', async (status, kind) => {
      const source = new RecordingSource('a.h5', '', async () => new Response(JSON.stringify({ error: 'of version 9' }), { status }));
      const problem = asProblem(await source.about().catch((thrown: unknown) => thrown));
      expect(problem.kind).toBe(kind);
      if (status === 422) expect(problem.text).toBe('of version 9');
    });

  it('is a Problem if it does not come, or comes as an HTML page', async () => {
    const away = new RecordingSource('a', '', () => Promise.reject(new TypeError('failed')));
    expect(asProblem(await away.about().catch((thrown: unknown) => thrown)).kind).toBe('gone');
    const page = new RecordingSource('a', '', async () => new Response('<!doctype html>'));
    expect(asProblem(await page.about().catch((thrown: unknown) => thrown)).kind).toBe('nonsense');
  });

  it('is requested with encoded name and token', async () => {
    const asked: string[] = [];
    const source = new RecordingSource('a/../b?c&d.h5', 'x&y', async (address) => { asked.push(address); return Response.json(ABOUT); });
    await source.about();
    expect(asked).toEqual(['/api/recordings/a%2F..%2Fb%3Fc%26d.h5/replay/about?token=x%26y']);
  });
});

describe('the bytes of series and states', () => {
  const header = { from_s: 0, to_s: 1, columns: 2, channels: [{ name: 'q_m', axis: 0 }, { name: 'alpha' }], events: [{ time_s: 0.5, type: 3, index: 0, value: 1 }],
    gaps: [{ from_s: 0.1, to_s: 0.2, ticks: 99 }], marks: [{ time_s: 0.7, kind: 'fault', text: 'x', axis: 'y' }, { time_s: 0.8, kind: 'of tomorrow' }] };

  it('contain low and high of each channel in turn', () => {
    const piece = readPiece(framed(header, Float32Array.of(1, 2, 3, 4, 5, 6, 7, NaN)));
    expect([...piece.channels.get(channelKey('q_m', 0))!.low]).toEqual([1, 2]);
    expect([...piece.channels.get(channelKey('q_m', 0))!.high]).toEqual([3, 4]);
    expect([...piece.channels.get(channelKey('alpha'))!.high]).toEqual([7, NaN]);
    expect(piece.marks).toHaveLength(1);
    expect(piece.gaps).toEqual([{ from_s: 0.1, to_s: 0.2, ticks: 99 }]);
  });

  it('that are truncated anywhere, or have no header, are refused without reading beyond their end', () => {
    const whole = framed(header, new Float32Array(8));
    for (let length = 0; length < whole.byteLength; length += 1) expect(kindOf(() => readPiece(whole.slice(0, length))), `${length}`).toBe('nonsense');
    expect(kindOf(() => readPiece(framed({ ...header, columns: 1e9 }, new Float32Array(8))))).toBe('nonsense');
  });

  it('of states are split into messages, and truncated ones are refused', async () => {
    const fake = new FakeRecordings(new URLSearchParams({ length: '1' }));
    const answer = await (await fake.answer('/api/recordings/a/replay/states?tick=100&count=3&step=7')).arrayBuffer();
    expect(splitStates(answer).map((message) => readState(message).tick)).toEqual([100n, 107n, 114n]);
    expect(kindOf(() => splitStates(answer.slice(0, -1)))).toBe('nonsense');
    expect(kindOf(() => splitStates(answer.slice(0, 2)))).toBe('nonsense');
    expect(kindOf(() => readState(new Uint8Array(64)))).toBe('nonsense');
  });
});

describe('rows and times', () => {
  it('of a file without gaps follow from the tick and the period', () => {
    const map = new TimeMap({ from_s: 2, period_s: 0.001 }, 5000);
    expect([map.rowAt(2), map.rowAt(2.0004), map.rowAt(3.2345), map.rowAt(1), map.rowAt(99)]).toEqual([0, 0, 1235, 0, 4999]);
  });

  it('map to each other over missing ticks: every row is found exactly once', () => {
    const map = new TimeMap({ from_s: 0, period_s: 0.001 }, 1000);
    // From the first missing tick to the first row after it.
    // Rows 0 .. 99 are ticks 0 .. 99, rows 100 .. 299 ticks 150 .. 349, the others ticks 350 + 7 and later.
    map.setGaps([{ from_s: 0.1, to_s: 0.15, ticks: 50 }, { from_s: 0.35, to_s: 0.357, ticks: 7 }]);
    const tick = (row: number): number => row + (row >= 100 ? 50 : 0) + (row >= 300 ? 7 : 0);
    for (let row = 0; row < 1000; row += 1) {
      expect(map.timeAt(row)).toBeCloseTo(tick(row) / 1000, 9);
      expect(map.rowAt(map.timeAt(row))).toBe(row);
    }
    expect([map.rowAt(0.12), map.rowAt(0.149)], 'in a gap: the last one before it').toEqual([99, 99]);
  });
});

it('are exact at a row that the series reported, although the loop was late before it', () => {
  const map = new TimeMap({ from_s: 0, period_s: 0.001 }, 1000);
  // Ten ticks were skipped in the first half second at an unknown time.
  map.addAnchor(490, 0.4995);
  for (const row of [490, 491, 700]) {
    expect(map.timeAt(row)).toBeCloseTo((row + 10) / 1000, 9);
    expect(map.rowAt((row + 10) / 1000)).toBe(row);
  }
  expect(map.rowAt(0.499)).toBeLessThan(490);
});

describe('pieces of series', () => {
  it.each([[3600, 800], [60, 500], [0.3, 500], [28_800, 800]])('of %d s are adjacent, none longer than a request may be', (length_s, columns) => {
    const levels = new SeriesLevels(5, 5 + length_s, 0.001);
    const slots = levels.slots(levels.levelFor(length_s, columns), { from_s: 5, to_s: 5 + length_s });
    expect(slots[0].from_s).toBeCloseTo(5 - 0.0005, 9);
    expect(slots.at(-1)!.to_s).toBeGreaterThanOrEqual(5 + length_s - 0.0005 - 1e-6);
    slots.forEach((slot, i) => {
      expect(slot.to_s - slot.from_s).toBeLessThanOrEqual(LONGEST_S + 1e-9);
      expect(slot.columns).toBeGreaterThanOrEqual(1);
      expect(slot.columns).toBeLessThanOrEqual(2000);
      if (i > 0) expect(slot.from_s).toBeCloseTo(slots[i - 1].to_s, 6);
    });
  });

  it('have columns that are at most a pixel wide, and at least a tick', () => {
    const levels = new SeriesLevels(0, 3600, 0.001);
    for (const span_s of [0.02, 0.6, 7, 61, 800]) {
      const width_s = levels.width_s(levels.levelFor(span_s, 500));
      expect(width_s).toBeGreaterThanOrEqual(0.001);
      expect(width_s).toBeLessThanOrEqual(Math.max(0.001, span_s / 500) * 1.000001);
    }
  });

  const pieceOf = (from_s: number, low: number[], high: number[], width_s: number): SeriesPiece => ({
    from_s, to_s: from_s + low.length * width_s, columns: low.length, channels: new Map([['x/0', { low: Float32Array.from(low), high: Float32Array.from(high) }]]),
    events: [], gaps: [], unreadable: [], first_tick: 0, marks: [], truncated: false, bytes: 100 });

  it('are drawn with the extremes of every column, and without invented values', () => {
    const piece = pieceOf(0, [1, NaN, -5], [2, NaN, 9], 0.1);
    const samples = new WindowSamples([{ piece, from: 0, to: 3, width_s: 0.1 }], [], 0.001);
    expect([...samples.values('x/0', 10)]).toEqual([10, 20, -50, 90]);
    expect([...samples.values('y/0', 10)], 'a channel that this recording has not').toEqual([NaN, NaN, NaN, NaN]);
    expect([...samples.times].every((time_s, i, all) => i === 0 || time_s >= all[i - 1])).toBe(true);
  });

  it('have a gap where ticks are missing, and where nothing is loaded yet', () => {
    const [a, b] = [pieceOf(0, [1, 2], [1, 2], 0.001), pieceOf(0.01, [3, 4], [3, 4], 0.001)];
    const runs = [a, b].map((piece) => ({ piece, from: 0, to: 2, width_s: 0.001 }));
    expect([...new WindowSamples(runs, [], 0.001).values('x/0', 1)]).toEqual([1, 2, NaN, 3, 4]);
    const gap = [{ from_s: 0.0009, to_s: 0.0014, ticks: 1 }];
    expect([...new WindowSamples([runs[0]], gap, 0.001).values('x/0', 1)]).toEqual([1, NaN, 2]);
  });
});

describe('the loader', () => {
  beforeEach(() => { vi.useFakeTimers(); });
  afterEach(() => { vi.useRealTimers(); });

  it('loads the present keys, not the earlier ones', async () => {
    const asked: string[] = [];
    const open = new Map<string, (value: string) => void>();
    const loader = new Loader<string>((key) => { asked.push(key); return new Promise((done) => open.set(key, done)); }, () => {}, () => {});
    loader.want(['a', 'b', 'c']);
    loader.want(['d', 'a']);
    open.get('a')!('A');
    await vi.advanceTimersByTimeAsync(0);
    expect(asked).toEqual(['a', 'b', 'd']);
  });

  it('repeats requests while the program is absent, and not after a refusal', async () => {
    let away = true;
    const reported: (string | undefined)[] = [];
    const taken: string[] = [];
    let asked = 0;
    const loader = new Loader<string>(async (key) => {
      asked += 1;
      if (key === 'bad') throw new Problem('unreadable', 'damaged');
      if (away) throw new Problem('gone');
      return key;
    }, (key) => taken.push(key), (problem) => reported.push(problem?.kind));
    loader.want(['bad', 'a']);
    await vi.advanceTimersByTimeAsync(10);
    expect([reported, asked]).toEqual([['unreadable', 'gone'], 2]);
    away = false;
    await vi.advanceTimersByTimeAsync(1100);
    expect([taken, reported.at(-1), asked]).toEqual([['a'], undefined, 3]);
    expect(loader.idle).toBe(true);
    loader.want(['bad']);
    loader.retry();
    await vi.advanceTimersByTimeAsync(10);
    expect(asked).toBe(4);
  });

  it('keeps values up to a size, the last used longest', () => {
    const cache = new BoundedCache<string>(10);
    cache.put('a', 'A', 4);
    cache.put('b', 'B', 4);
    cache.use('a');
    cache.put('c', 'C', 4);
    expect([cache.has('a'), cache.has('b'), cache.has('c'), cache.size]).toEqual([true, false, true, 8]);
    cache.put('d', 'D', 50);
    expect([cache.has('d'), cache.size], 'what is larger than all is kept until the next comes').toEqual([true, 50]);
  });
});

describe('states', () => {
  const settled = async (): Promise<void> => { for (let i = 0; i < 50; i += 1) await new Promise((resolve) => setTimeout(resolve, 0)); };

  it('near a time are shown at once, the exact one when it comes, equal to the program\'s', async () => {
    const fake = new FakeRecordings(new URLSearchParams({ length: '4' }));
    const states = new StateStore(sourceOf(fake), fake.rows, () => {}, (problem) => { if (problem) throw problem; });
    expect(states.nearest(1234)).toBeUndefined();
    states.wantAround(1234, 16);
    await settled();
    expect(states.nearest(1234)).toBe(1234);
    const state = states.state(1234)!;
    const sent = fake.state(1234);
    expect([state.tick, state.timeS]).toEqual([1234n, sent.timeS]);
    expect(state.qM).toEqual([...Float32Array.from(sent.qM)]);
    expect(state.links.length).toBe(sent.links.length);
    // 1100 is in no loaded block of single rows; the nearest at a step of 16 is 1104.
    expect(states.nearest(1100)).toBe(1104);
    states.close();
  });

  it('are requested in blocks of at most 256, each once, and never beyond the end', async () => {
    const fake = new FakeRecordings(new URLSearchParams({ length: '1' }));
    const states = new StateStore(sourceOf(fake), fake.rows, () => {}, () => {});
    for (let row = 0; row < 1000; row += 50) {
      states.wantAround(row, 16);
      await settled();
    }
    expect(new Set(fake.asked).size).toBe(fake.asked.length);
    for (const address of fake.asked) {
      const query = new URL(address, 'http://a').searchParams;
      const [tick, count, step] = ['tick', 'count', 'step'].map((key) => Number(query.get(key)));
      expect(count).toBeLessThanOrEqual(BLOCK);
      expect(tick + (count - 1) * step).toBeLessThan(1000);
    }
    expect(states.nearest(999)).toBe(999);
    states.close();
  });

  it('of a file that has grown are read again at its former end', async () => {
    const fake = new FakeRecordings(new URLSearchParams({ length: '1' }));
    const states = new StateStore(sourceOf(fake), 990, () => {}, () => {});
    states.wantAround(989, 4);
    await settled();
    states.grow(1000);
    states.wantAround(999, 4);
    await settled();
    expect(states.nearest(999)).toBe(999);
    states.close();
  });

  it('that were under way while the file grew are requested again, and only then', async () => {
    const fake = new FakeRecordings(new URLSearchParams({ length: '1' }));
    const waiting: (() => void)[] = [];
    const source = new RecordingSource('a', '', (address) => new Promise((done) => { waiting.push(() => { void fake.answer(address).then(done); }); }));
    const states = new StateStore(source, 990, () => {}, () => {});
    states.wantAround(989, 4);
    await settled();
    states.grow(1000);
    for (let i = 0; i < 20; i += 1) {
      while (waiting.length > 0) waiting.shift()!();
      await settled();
      states.wantAround(999, 4);
    }
    expect(states.nearest(999)).toBe(999);
    expect(fake.asked.length, 'the last block at both steps twice, those before it once').toBeLessThanOrEqual(7);
    states.close();
  });

  it('have steps of 1, 4, 16 ...', () => {
    expect([0, 1, 3, 4, 15.9, 16, 64, 3600].map(stepFor)).toEqual([1, 1, 1, 4, 4, 16, 64, 1024]);
  });
});

describe('series of a recording', () => {
  it('of an hour come piece by piece, each of at most a minute, the visible window first', async () => {
    const asked: URLSearchParams[] = [];
    const open: (() => void)[] = [];
    const source = new RecordingSource('a', '', (address) => new Promise((done) => {
      const query = new URL(address, 'http://a').searchParams;
      asked.push(query);
      const columns = Number(query.get('columns'));
      open.push(() => done(new Response(framed({ from_s: Number(query.get('from_s')), to_s: Number(query.get('to_s')), columns, channels: [{ name: 'alpha', axis: 0 }] }, new Float32Array(2 * columns)))));
    }));
    let pieces = 0;
    const series = new SeriesStore(source, { from_s: 0, to_s: 3600, period_s: 0.001 }, () => { pieces += 1; }, () => {});
    series.look({ from_s: 1800, to_s: 1810 }, 500);
    for (let i = 0; series.progress < 1 && i < 500; i += 1) {
      open.shift()?.();
      await new Promise((resolve) => setTimeout(resolve, 0));
    }
    expect(series.progress).toBe(1);
    for (const query of asked) {
      expect(Number(query.get('to_s')) - Number(query.get('from_s'))).toBeLessThanOrEqual(LONGEST_S + 1e-9);
      expect(Number(query.get('columns'))).toBeGreaterThanOrEqual(1);
    }
    expect(asked.length).toBe(pieces);
    expect(asked.length).toBeLessThan(90);
    const fine = asked.findIndex((query) => Number(query.get('from_s')) > 1790 && Number(query.get('to_s')) - Number(query.get('from_s')) < 20);
    expect(fine, 'behind the two that were under way').toBeLessThanOrEqual(4);
    series.close();
  });

  it('that were under way while the file grew are read to its new end', async () => {
    const asked: { to_s: number; answer: () => void }[] = [];
    const source = new RecordingSource('a', '', (address) => new Promise((done) => {
      const query = new URL(address, 'http://a').searchParams;
      const columns = Number(query.get('columns'));
      asked.push({ to_s: Number(query.get('to_s')), answer: () => done(new Response(framed({ from_s: Number(query.get('from_s')), to_s: Number(query.get('to_s')), columns, channels: [{ name: 'alpha', axis: 0 }] }, new Float32Array(2 * columns)))) });
    }));
    const series = new SeriesStore(source, { from_s: 0, to_s: 30, period_s: 0.001 }, () => {}, () => {});
    await new Promise((resolve) => setTimeout(resolve, 0));
    series.grow(31);
    for (let i = 0, answered = 0; i < 200; i += 1) {
      for (; answered < asked.length; answered += 1) asked[answered].answer();
      await new Promise((resolve) => setTimeout(resolve, 0));
    }
    expect(series.progress).toBe(1);
    expect(series.overview().at(-1)!.to_s).toBeGreaterThanOrEqual(30.99);
    series.close();
  });

  it('are drawn from coarse pieces until the fine ones come, without an overlap', async () => {
    const fake = new FakeRecordings(new URLSearchParams({ length: '30' }));
    let block = false;
    const source = new RecordingSource('a', '', (address) => (block ? new Promise<Response>(() => {}) : fake.answer(address)));
    const series = new SeriesStore(source, { from_s: 0, to_s: 30, period_s: 0.001 }, () => {}, () => {});
    for (let i = 0; series.progress < 1 && i < 5000; i += 1) await new Promise((resolve) => setTimeout(resolve, 0));
    expect(series.progress).toBe(1);
    block = true;
    series.look({ from_s: 10, to_s: 11 }, 500);
    const runs = series.runs();
    expect(runs.length).toBeGreaterThan(0);
    const { times } = new WindowSamples(runs, [], 0.001);
    expect([times[0] <= 10.1, times.at(-1)! >= 10.9]).toEqual([true, true]);
    expect([...times].every((time_s, i) => i < 2 || time_s > times[i - 2])).toBe(true);
    series.close();
  });
});

describe('values of an exercise in the plots', () => {
  it('are called by words and a unit where the panel does not name them', () => {
    expect(['squeeze_low_n', 'flow_l_s', 'layer_l/2', 'score'].map(quantityWords)).toEqual(['Squeeze low, N', 'Flow, l/s', 'Layer 2, l', 'Score']);
  });
});
