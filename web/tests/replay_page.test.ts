// The page of a replay: its time, its display of two recordings, its texts.
import { describe, expect, it, vi } from 'vitest';
import { en as consoleEn } from '../src/console/i18n/en';
import { replayUrl } from '../src/console/recordings';
import { AxisT } from '../src/protocol';
import { FakeRecordings } from '../fake/fake_recordings';
import { channelOf, ColumnList } from '../src/replay/channels';
import { clockTicks, clockTime } from '../src/replay/clock';
import { de } from '../src/replay/i18n/de';
import { en } from '../src/replay/i18n/en';
import { fr } from '../src/replay/i18n/fr';
import { isBad, lastAt, Moments, plotMark, rowsAround, wordsOf, type Names } from '../src/replay/moments';
import { lineOfFailed, linesOfSecond, linesOf } from '../src/replay/notices';
import { openRecordings } from '../src/replay/open_recordings';
import { allAxes } from '../src/replay/plots';
import { Player } from '../src/replay/player';
import { RecordingSource } from '../src/replay/recording_source';
import { ReplaySide } from '../src/replay/side';
import { keyOrder, type TransportHands } from '../src/replay/transport';
import { Zoom } from '../src/replay/zoom';
import { fill } from '../src/shared/i18n';
import { testTexts } from './texts';

describe('time', () => {
  it('is formatted as a clock, with the requested decimals', () => {
    expect([clockTime(83.4567, 3), clockTime(0, 1), clockTime(3725.25, 0), clockTime(59.9999, 3), clockTime(-0.5, 1), clockTime(NaN, 3)])
      .toEqual(['1:23.457', '0:00.0', '1:02:05', '1:00.000', '−0:00.5', '–']);
  });

  it.each([[0, 3600, '0:00', 600], [0, 0.02, '0:00.000', 0.005], [12, 22, '0:12', 2]])('on an axis from %d to %d s has round steps', (from_s, to_s, first, step_s) => {
    const ticks = clockTicks({ from_s, to_s }, 7);
    expect(ticks.length).toBeLessThanOrEqual(8);
    expect(ticks[0].name).toBe(first);
    expect(ticks[1].at_s - ticks[0].at_s).toBeCloseTo(step_s, 9);
    expect(new Set(ticks.map(({ name }) => name)).size, 'no two have the same name').toBe(ticks.length);
  });

  it.each([[0.1, 0.1], [0.5, 0.5], [1, 1], [2, 2]])('passes at %d times its speed and stops at the end', (speed, after_s) => {
    const player = new Player({ from_s: 0, to_s: 5 });
    player.speed = speed;
    player.toggle();
    for (let i = 0; i < 10; i += 1) player.advance(0.1);
    expect(player.time_s).toBeCloseTo(after_s, 9);
    for (let i = 0; i < 1000; i += 1) player.advance(0.1);
    expect([player.time_s, player.playing]).toEqual([5, false]);
    player.toggle();
    expect([player.time_s, player.playing], 'from the beginning again').toEqual([0, true]);
  });

  it('does not jump after the page was suspended, and never leaves the recording', () => {
    const player = new Player({ from_s: 2, to_s: 5 });
    player.toggle();
    player.advance(60);
    expect(player.time_s).toBeCloseTo(2.25, 9);
    for (const wrong of [-1, 99, NaN, Infinity]) player.seek(wrong);
    expect(player.time_s).toBe(5);
  });
});

describe('the window', () => {
  it('keeps the time under the pointer in place while zooming', () => {
    const zoom = new Zoom({ from_s: 0, to_s: 100 }, 0.02);
    zoom.scale(25, 0.1);
    expect(zoom.window).toEqual({ from_s: 22.5, to_s: 32.5 });
    expect((25 - zoom.window.from_s) / 10).toBeCloseTo(0.25, 9);
  });

  it('is never outside the recording, and never shorter than a minimum of ticks', () => {
    const zoom = new Zoom({ from_s: 0, to_s: 100 }, 0.02);
    zoom.set({ from_s: 50, to_s: 50 });
    expect(zoom.window.to_s - zoom.window.from_s).toBeCloseTo(0.02, 9);
    zoom.set({ from_s: -20, to_s: 10 });
    expect(zoom.window.from_s).toBe(0);
    zoom.set({ from_s: 90, to_s: 130 });
    expect(zoom.window.to_s).toBe(100);
    zoom.scale(50, 1000);
    expect([zoom.window, zoom.shows]).toEqual([{ from_s: 0, to_s: 100 }, 'all']);
  });

  it('follows playback, and grows with a recording that is shown as a whole', () => {
    const zoom = new Zoom({ from_s: 0, to_s: 100 }, 0.02);
    zoom.set({ from_s: 0, to_s: 10 });
    expect([zoom.follow(5), zoom.follow(10.1)]).toEqual([false, true]);
    expect(zoom.window.from_s).toBeCloseTo(9.6, 9);
    zoom.setWhole({ from_s: 0, to_s: 200 });
    expect(zoom.window.to_s - zoom.window.from_s).toBeCloseTo(10, 9);
    zoom.all();
    zoom.setWhole({ from_s: 0, to_s: 300 });
    expect(zoom.window).toEqual({ from_s: 0, to_s: 300 });
  });
});

it('the console links to one recording, or to two, with encoded names', () => {
  expect(replayUrl(['a&b #1.h5'], '')).toBe('/replay?recording=a%26b%20%231.h5');
  expect(new URLSearchParams(replayUrl(['يد.h5', '<b>.h5'], 'x&y').slice('/replay?'.length)).toString())
    .toBe(new URLSearchParams({ recording: 'يد.h5', beside: '<b>.h5', token: 'x&y' }).toString());
});

it('every key has the effect that the page describes', () => {
  const done: string[] = [];
  const hands = new Proxy({}, { get: (_target, name) => (...args: unknown[]) => done.push(`${String(name)} ${args.join()}`.trim()) }) as unknown as TransportHands;
  const press = (key: string, shiftKey = false): void => keyOrder({ key, shiftKey }, 100, hands)?.();
  for (const key of [' ', 'ArrowLeft', 'ArrowRight', 'Home', 'End', 'PageUp', 'PageDown', '+', '-', '0', 'x', 'Escape']) press(key);
  press('ArrowRight', true);
  expect(done).toEqual(['toggle', 'step -1', 'step 1', 'home', 'end', 'mark -1', 'mark 1', 'scale 0.5', 'scale 2', 'all', 'step 100']);
});

describe('moments of a recording', () => {
  const names: Names = { eventNames: ['touched', 'new_thing'], ownWords: () => '' };
  const event = (time_s: number, type: number) => ({ time_s, type, index: 0, value: 0 });

  it('are kept once and sorted, although they come with two pieces', () => {
    const moments = new Moments();
    const piece = { events: [event(3, 0), event(1, 1)], gaps: [{ from_s: 2, to_s: 2.1, ticks: 100 }], marks: [{ time_s: 4, kind: 'fault' as const, text: 'speed limit exceeded', axis: 'x' }] };
    moments.add(piece);
    moments.add(piece);
    expect(moments.list.map(({ time_s, kind }) => `${time_s} ${kind}`)).toEqual(['1 event', '2 gap', '3 event', '4 fault']);
    expect(moments.gaps).toHaveLength(1);
    expect([moments.beside(2, 1)?.time_s, moments.beside(2, -1)?.time_s, moments.beside(4, 1)]).toEqual([3, 1, undefined]);
    expect(moments.within({ from_s: 2, to_s: 3 })).toHaveLength(2);
  });

  it('have texts: faults with their axis, gaps with their ticks, and unknown events', () => {
    const moments = new Moments();
    moments.add({ events: [event(1, 0), event(2, 1), event(2.5, 9)], gaps: [{ from_s: 3, to_s: 4, ticks: 1234 }], marks: [{ time_s: 5, kind: 'fault', text: 'speed limit exceeded, of tomorrow', axis: 'x' }, { time_s: 6, kind: 'armed', text: '', axis: '' }] });
    expect(moments.list.map((moment) => wordsOf(moment, names, en, consoleEn))).toEqual(
      ['Touched', 'New thing', '9', '1\u202f234 ticks are missing', 'Fault: the hand moved too fast, of tomorrow, x, away', 'Armed']);
    expect(moments.list.map(isBad)).toEqual([false, false, false, true, true, false]);
    expect(plotMark(moments.list[0], names, en, consoleEn)).toMatchObject({ time_s: 1, label: '①', bad: false });
  });
});

describe('the list of moments', () => {
  const moments = [1, 2, 2, 5].map((time_s) => ({ time_s }));

  it('marks the last one at the play head', () => {
    expect([0.5, 1, 1.999, 2, 4.9, 5, 99, NaN].map((time_s) => lastAt(moments, time_s))).toEqual([undefined, 0, 0, 2, 2, 3, 3, undefined]);
    expect(lastAt([], 3)).toBeUndefined();
  });

  it('shows the rows around it, and scrolls only when it leaves them', () => {
    expect(rowsAround(50, 49, 200, 0), 'all of them').toBe(0);
    expect([rowsAround(1000, undefined, 200, 0), rowsAround(1000, 199, 200, 0), rowsAround(1000, 200, 200, 0)]).toEqual([0, 0, 100]);
    expect([rowsAround(1000, 299, 200, 100), rowsAround(1000, 999, 200, 100), rowsAround(1000, 3, 200, 800)]).toEqual([100, 800, 0]);
    expect(rowsAround(300, 250, 200, 200), 'fewer than before').toBe(100);
  });
});

describe('two recordings of which one cannot be shown', () => {
  const sourceOf = (name: string, options: Record<string, string> = { length: '1' }): RecordingSource => {
    const fake = new FakeRecordings(new URLSearchParams(options));
    return new RecordingSource(name, '', (address) => fake.answer(address));
  };

  it.each([[['a.h5', 'unknown'], 'unknown'], [['unknown', 'a.h5'], 'unknown']])('%j: the other one is shown', async (names, missing) => {
    const { sides, failed } = await openRecordings(names.map((name) => sourceOf(name)));
    expect(sides.map(({ source }) => source.name)).toEqual(['a.h5']);
    expect(failed.map(({ name, problem }) => [name, problem.kind])).toEqual([[missing, 'unknown']]);
    for (const side of sides) side.close();
  });

  it('report which one it is, and why', async () => {
    const { sides, failed } = await openRecordings([sourceOf('a.h5'), sourceOf('<b>b.h5', { newer: '' })]);
    expect(lineOfFailed(failed[0])).toMatchObject({ kind: 'bad', act: 'reload', text: expect.stringMatching(/^<b>b\.h5 .*cannot be opened.*newer program/) as string });
    for (const side of sides) side.close();
  });

  it('both open if both can be shown, in the order of their names', async () => {
    const { sides, failed } = await openRecordings([sourceOf('a.h5'), sourceOf('b.h5')]);
    expect([sides.map(({ source }) => source.name), failed]).toEqual([['a.h5', 'b.h5'], []]);
    for (const side of sides) side.close();
  });
});

describe('two recordings of different devices', () => {
  const axis = (name: string, unit = 'm'): AxisT => new AxisT(name, unit, -1, 1, 10, unit === 'rad' ? 0.05 : 0, 1);
  const scenes = [{ axes: [axis('x'), axis('finger_flexion', 'rad')], valueNames: ['score'] }, { axes: [axis('finger_flexion', 'rad'), axis('yaw', 'rad')], valueNames: ['squeeze_n', 'score'] }];

  it('share their axes by name; a missing one is empty', () => {
    expect(allAxes(scenes.map((scene) => ({ scene }) as unknown as ReplaySide)).map(({ name }) => String(name))).toEqual(['x', 'finger_flexion', 'yaw']);
    const keys = (name: string) => scenes.map((scene) => channelOf({ of: 'q_m', name }, scene)?.key);
    expect([keys('x'), keys('finger_flexion'), keys('yaw')]).toEqual([['q_m/0', undefined], ['q_m/1', 'q_m/0'], [undefined, 'q_m/1']]);
    expect(scenes.map((scene) => channelOf({ of: 'value', name: 'score' }, scene)?.key)).toEqual(['value/0', 'value/1']);
  });

  it('are distinguished, with the axes that only one has', () => {
    const about = { patient: 'p', hand: 'h', device: 'lambda', exercise: 'cocktail-bar', level: 1 };
    const side = (i: number, changes = {}): ReplaySide => ({ scene: scenes[i], about: { ...about, ...changes } }) as unknown as ReplaySide;
    expect(linesOfSecond(side(0), side(1, { device: 'desktop', hand: 'left' })).map(({ text }) => text)).toEqual([
      'Differs from A in: Hand, Device.', 'Axes of one recording only: x, away; Yaw.']);
    expect(linesOfSecond(side(0), side(0))).toEqual([]);
  });

  it('are shown in display units', () => {
    expect(channelOf({ of: 'q_m', name: 'x' }, scenes[0])?.factor).toBe(1000);
    expect(channelOf({ of: 'sent', name: 'finger_flexion' }, scenes[0])?.factor).toBeCloseTo(1 / 0.05, 9);
    expect(channelOf({ of: 'phi', name: 'finger_flexion' }, scenes[0])?.factor).toBe(1);
  });

  it('have the same columns by the same numbers', () => {
    const list = new ColumnList();
    expect([list.numberOf({ of: 'alpha' }), list.numberOf({ of: 'q_m', name: 'x' }), list.numberOf({ of: 'alpha' })]).toEqual([0, 1, 0]);
  });
});

describe('an opened recording', () => {
  const open = async (options: Record<string, string>): Promise<{ side: ReplaySide; fake: FakeRecordings }> => {
    const fake = new FakeRecordings(new URLSearchParams(options));
    return { side: await ReplaySide.open(new RecordingSource('a', '', (address) => fake.answer(address))), fake };
  };
  const settled = async (until: () => boolean): Promise<void> => {
    for (let i = 0; !until() && i < 5000; i += 1) await new Promise((resolve) => setTimeout(resolve, 0));
    expect(until()).toBe(true);
  };

  it('shows the row of its time, and the value of every column there', async () => {
    const { side, fake } = await open({ length: '2' });
    side.setColumns(new ColumnList(), side.scene.axes.map(({ name }) => String(name)));
    side.seek(1.5, side.span, false, 1);
    await settled(() => side.states.nearest(1500) === 1500);
    expect(side.seek(1.5, side.span, false, 1)).toBe(true);
    expect([side.shown, side.state?.tick]).toEqual([1500, 1500n]);
    const column = side.history.column('device', 0);
    expect(side.history.current(column)).toBeCloseTo(1000 * fake.state(1500).qM[0], 3);
    side.close();
  });

  it('finds every tick by its row, with ticks missing', async () => {
    const { side, fake } = await open({ length: '3', gap: '' });
    await settled(() => side.series.progress === 1);
    expect([side.about.ticks_missing, side.about.ticks, fake.rows]).toEqual([200, 2800, 2800]);
    for (const row of [0, 999, 1000, 1001, 2799]) expect(side.timeOf(row)).toBeCloseTo(fake.state(row).timeS, 9);
    side.close();
  });

  it('without a scene has its plots, and explains the missing picture', async () => {
    const { side, fake } = await open({ length: '2', nopicture: '' });
    expect(side.hasScene).toBe(false);
    await settled(() => side.series.progress === 1);
    expect(side.scene.axes.length).toBe(fake.scene.axes.length);
    side.close();
  });

  it('of a newer version is refused with the program’s words', async () => {
    await expect(open({ newer: '' })).rejects.toMatchObject({ kind: 'unreadable', text: expect.stringContaining('newer program') as string });
  });

  it('that is still being written grows when it is read again', async () => {
    const { side } = await open({ length: '2', written: '' });
    const before = side.span.to_s;
    side.grow(await side.source.about());
    expect(side.span.to_s).toBeCloseTo(before + 1, 9);
    await settled(() => side.series.progress === 1);
    side.close();
  });

  it('whose end cannot be read states the time from which it is unreadable', async () => {
    const { side } = await open({ length: '10', damaged: '' });
    expect(side.about.whole).toBe(false);
    expect(linesOf(side)).toContainEqual({ kind: 'warn', text: fill(en.notices.damaged, { time: '0:09.000' }) });
    const whole = await open({ length: '10' });
    expect(linesOf(whole.side)).toEqual([]);
    for (const each of [side, whole.side]) each.close();
  });

  it('keeps loaded data while the program is absent, and continues when it is back', async () => {
    vi.useFakeTimers();
    let away = false;
    const fake = new FakeRecordings(new URLSearchParams({ length: '2' }));
    const opened = ReplaySide.open(new RecordingSource('a', '', (address) => (away ? Promise.reject(new TypeError('gone')) : fake.answer(address))));
    await vi.advanceTimersByTimeAsync(200);
    const side = await opened;
    side.seek(0.1, side.span, false, 1);
    await vi.advanceTimersByTimeAsync(200);
    side.seek(0.1, side.span, false, 1);
    expect(side.shown).toBe(100);
    away = true;
    side.seek(1.9, side.span, false, 1);
    await vi.advanceTimersByTimeAsync(200);
    expect([side.problem?.kind, side.state?.tick !== undefined]).toEqual(['gone', true]);
    away = false;
    await vi.advanceTimersByTimeAsync(3000);
    expect(side.problem).toBeUndefined();
    side.seek(1.9, side.span, false, 1);
    expect(side.shown).toBe(1900);
    side.close();
    vi.useRealTimers();
  });
});

describe('the texts', () => {
  testTexts(en, de, fr);

  it('name a report like its button (WCAG 2.5.3)', () => { for (const t of [en, de, fr]) expect(t.reportOf).toContain(t.report); });
});
