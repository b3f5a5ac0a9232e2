import { readdirSync } from 'node:fs';
import { describe, expect, it } from 'vitest';
import { asWords, bytes, duration, fixed, grouped, significant } from '../src/shared/format';
import { deviceLines, type ReportedDevice } from '../src/console/device_status';
import { History, displayUnits, WINDOW_S } from '../src/console/history';
import { de } from '../src/console/i18n/de';
import { en } from '../src/console/i18n/en';
import { fr } from '../src/console/i18n/fr';
import { Marks } from '../src/console/marks';
import { meantBySlider, parsed, ParameterTarget, viewOf } from '../src/console/parameter_model';
import { figuresOf, offered, SavedWatch, shownOf, whenMade } from '../src/console/recordings';
import { levelsOf } from '../src/console/setup';
import { SampleWindow } from '../src/console/sample_window';
import { faultWords, statusOf } from '../src/console/run_status';
import { limitOfAxis } from '../src/console/plot_specs';
import { personWords, sessionWords } from '../src/console/title_words';
import { CalmRange, niceStep, ticksIn } from '../src/console/scale';
import { logHeight, logTicks, tail, timeEnd } from '../src/console/timing_model';
import { setLanguage } from '../src/shared/i18n';
import { AxisT, EventT, ReleaseReason, ParameterGroup, ParameterT, RunState, SafetyState, WorldStateT } from '../src/protocol';

describe('formatted numbers', () => {
  it('have a true minus sign and no minus zero', () => {
    expect(fixed(-5.34, 1)).toBe('−5.3');
    expect(fixed(-0.04, 1)).toBe('0.0');
    expect(fixed(Number.NaN, 1)).toBe('–');
    expect([significant(2.5), significant(30), significant(1 / 3, 3)]).toEqual(['2.5', '30', '0.333']);
  });

  it('have a comma in German and French', () => {
    Object.assign(globalThis, { document: { documentElement: {} } });
    for (const language of ['de', 'fr'] as const) {
      setLanguage(language);
      expect([fixed(-5.34, 1), fixed(-0.04, 1), fixed(12, 0), significant(0.25)]).toEqual(['−5,3', '0,0', '12', '0,25']);
    }
    setLanguage('en');
  });

  it('include durations, sizes and grouped digits', () => {
    expect(duration(161.9)).toBe('2:41');
    expect(duration(3761)).toBe('1:02:41');
    expect(bytes(18_400_000)).toBe('18 MB');
    expect(bytes(950)).toBe('950 B');
    expect(grouped(251840n)).toBe('251\u202f840');
    expect(grouped(999)).toBe('999');
  });

  it('file names become words', () => {
    expect(asWords('adult-median_right')).toBe('Adult median right');
  });
});

describe('the levels to choose from', () => {
  it('are those of the loaded exercise, and only the first one of another exercise', () => {
    expect(levelsOf('a', { exercise: 'a', levels: 4 })).toEqual([1, 2, 3, 4]);
    expect(levelsOf('b', { exercise: 'a', levels: 4 })).toEqual([1]);
    expect(levelsOf('', { exercise: '', levels: 0 })).toEqual([1]);
  });
});

describe('the sample window', () => {
  it('returns the latest samples, oldest first, after wrapping around many times', () => {
    const ring = new SampleWindow(2, 4);
    for (let k = 1; k <= 11; k += 1) {
      ring.push([k, 10 * k]);
      const first = Math.max(1, k - 3);
      const expected = Array.from({ length: k - first + 1 }, (_, i) => first + i);
      expect([...ring.column(0)]).toEqual(expected);
      expect([...ring.column(1)]).toEqual(expected.map((v) => 10 * v));
      expect(ring.latest(0)).toBe(k);
    }
    expect([...ring.column(0, 2)]).toEqual([10, 11]);
  });

  it('counts the samples since a time', () => {
    const ring = new SampleWindow(1, 8);
    for (const t of [1, 2, 3, 4]) ring.push([t]);
    expect(ring.countSince(2.5)).toBe(2);
    expect(ring.countSince(2)).toBe(3);
    expect(ring.countSince(9)).toBe(0);
    expect(ring.countSince(0)).toBe(4);
  });
});

const AXES = [new AxisT('x', 'm', -0.085, 0.085, 20, 0, 1.5), new AxisT('finger_flexion', 'rad', 0, 3.14, 0.8, 0.08, 10)];

function state(tick: number, more: Partial<WorldStateT> = {}): WorldStateT {
  return Object.assign(new WorldStateT(), { session: 1, tick: BigInt(tick), timeS: tick / 1000, sent: [0, 0], qM: [0, 0], qS: [0, 0], phi: [0, 0] }, more);
}

describe('the history', () => {
  it('converts to forces at the tip, millimetres and degrees', () => {
    const history = new History(AXES);
    // 0.4 Nm over a lever arm of 0.08 m are 5 N.
    history.add(state(1, { sent: [3, -0.4], qM: [0.02, Math.PI / 2], phi: [0, 1], alpha: 0.25 }));
    expect(history.samples.latest(history.column('effort', 0))).toBe(3);
    expect(history.samples.latest(history.column('effort', 1))).toBeCloseTo(-5, 9);
    expect(history.samples.latest(history.column('device', 0))).toBeCloseTo(20, 9);
    expect(history.samples.latest(history.column('device', 1))).toBeCloseTo(90, 9);
    expect(history.samples.latest(history.column('phi', 1))).toBe(1);
    expect(history.samples.latest(history.alphaColumn)).toBe(0.25);
  });

  it('keeps a rotation without a lever arm as a torque', () => {
    expect(displayUnits(new AxisT('roll', 'rad', -1, 1, 2, 0, 5)).effortUnit).toBe('Nm');
  });

  it('stores the same tick once', () => {
    const history = new History(AXES);
    expect(history.add(state(5))).toBe(true);
    expect(history.add(state(5))).toBe(false);
    expect(history.samples.length).toBe(1);
  });

  it('continues its time when a new session begins at zero', () => {
    const history = new History(AXES);
    history.add(state(5000));
    history.add(state(5100));
    const before_s = history.now_s;
    history.add(state(3, { session: 2 }));
    expect(history.now_s).toBeCloseTo(before_s + 0.6, 9);
  });

  it('computes no speed across missed messages or a new session', () => {
    const history = new History(AXES);
    for (let k = 0; k < 10; k += 1) history.add(state(1000 + 17 * k));
    for (let k = 0; k < 10; k += 1) history.add(state(4000 + 17 * k, { qM: [0.08, 0] }));
    for (let k = 0; k < 10; k += 1) history.add(state(17 * k, { session: 2, qM: [-0.08, 0] }));
    expect(history.peakSpeed([0])).toBe(0);
  });

  it('has peaks of the last ten seconds only', () => {
    const history = new History(AXES);
    history.add(state(0, { sent: [-9, 0] }));
    for (let tick = 100; tick <= 9900; tick += 100) history.add(state(tick, { sent: [2, 0] }));
    expect(history.peak('effort', 0)).toBe(9);
    for (let tick = 10000; tick <= 10300; tick += 100) history.add(state(tick, { sent: [2, 0] }));
    expect(history.peak('effort', 0)).toBe(2);
    expect(WINDOW_S).toBe(10);
  });

  it('computes the speed: 10 mm in 50 ms are 0.2 m/s', () => {
    const history = new History(AXES);
    for (let k = 0; k <= 30; k += 1) history.add(state(1000 + k * 10, { qM: [k * 0.002, 0] }));
    expect(history.peakSpeed([0])).toBeCloseTo(0.2, 6);
  });

  it('treats a state without positions as unknown: no speed, no peak, no line', () => {
    const history = new History(AXES);
    history.add(state(1, { sent: [], qM: [], qS: [], phi: [] }));  // like the first states while arming
    for (let k = 1; k < 10; k += 1) history.add(state(1 + 17 * k, { qM: [0.08, 0] }));
    expect(history.peakSpeed([0])).toBe(0);
    expect(history.samples.column(history.column('device', 0))[0]).toBeNaN();
    expect(history.peak('effort', 0)).toBe(0);
  });

  it('does not join the data before and after a lost connection', () => {
    const history = new History(AXES);
    history.add(state(1000, { qM: [0.01, 0] }));
    history.add(state(4000, { qM: [0.05, 0] }));
    expect([...history.samples.column(history.column('device', 0))]).toEqual([10, NaN, 50]);
    history.add(state(4200, { qM: [0.05, 0] }));  // a late state is not a loss
    expect(history.samples.length).toBe(4);
  });

  it('converts a tick to its clock', () => {
    const history = new History(AXES);
    history.add(state(1000));
    history.add(state(1500));
    expect(history.timeOfTick(1250n, 0.001)).toBeCloseTo(history.now_s - 0.25, 9);
  });
});

describe('scales', () => {
  it('have steps of 1, 2 or 5 times a power of ten', () => {
    expect(niceStep(10, 5)).toBe(2);
    expect(niceStep(11, 5)).toBe(5);
    expect(niceStep(0.09, 10)).toBeCloseTo(0.01, 12);
  });

  it('have ticks inside the range, with a true zero', () => {
    expect(ticksIn(-9, 5, 4)).toEqual([-8, -4, 0, 4]);
    expect(Object.is(ticksIn(-1, 1, 1)[1], 0)).toBe(true);
  });

  it('grow at once, and shrink only after two calm seconds', () => {
    const range = new CalmRange(4, true);
    range.follow(-1, 1, 0);
    expect(range.follow(-1, 17, 1)).toBe(true);
    expect(range.upper).toBeGreaterThanOrEqual(17);
    expect(range.follow(-1, 1, 2)).toBe(false);
    expect(range.follow(-1, 1, 3.5)).toBe(true);
    expect(range.upper).toBeLessThan(10);
  });

  it('leave room around a constant line', () => {
    const range = new CalmRange(4, true);
    range.follow(0, 0, 0);
    expect(range.lower).toBeLessThan(-1);
    expect(range.upper).toBeGreaterThan(1);
  });
});

describe('the time per tick', () => {
  const times = { ticks: 200_000, p50_us: 155, p99_us: 260, p999_us: 402, max_us: 874 };

  it('has a tail that follows from the definition of quantiles', () => {
    expect(tail(times)).toEqual([
      { time_us: 0, count: 200_000 }, { time_us: 155, count: 100_000 }, { time_us: 260, count: 2000 },
      { time_us: 402, count: 200 }, { time_us: 874, count: 1 },
    ]);
  });

  it('has no point for one in a thousand in a run of 500 ticks', () => {
    expect(tail({ ...times, ticks: 500 }).map((point) => point.count)).toEqual([500, 250, 5, 1]);
    expect(tail({ ...times, ticks: 0 })).toEqual([]);
  });

  it('has an axis that ends after the deadline, or after the slowest tick', () => {
    expect(timeEnd(1000, 874)).toBeCloseTo(1100, 9);
    expect(timeEnd(1000, 2000)).toBeCloseTo(2100, 9);
  });

  it('has a logarithmic axis: a factor of 100 is a constant height', () => {
    const step = logHeight(10_000, 1e6) - logHeight(100, 1e6);
    expect(logHeight(1e6, 1e6) - logHeight(10_000, 1e6)).toBeCloseTo(step, 12);
    expect(logHeight(0, 1e6)).toBe(0);
    expect(logTicks(20_000).map((tick) => tick.name)).toEqual(['1', '10²', '10⁴']);
  });
});

describe('parameters', () => {
  const lead = viewOf(new ParameterT('lead_in_m', ParameterGroup.Exercise, 'm', 0.001, Math.fround(0.01), 0.004, 0.002), {});

  it('show metres as millimetres, with rounded ranges', () => {
    expect(lead).toMatchObject({ unit: 'mm', lower: 1, upper: 10, factor: 1000, label: 'Lead in m' });
  });

  it('accept typed numbers with comma or point, converted to SI, and refuse others', () => {
    expect(parsed('4,5', lead)).toBeCloseTo(0.0045, 12);
    expect(parsed(' 4.5 ', lead)).toBeCloseTo(0.0045, 12);
    for (const wrong of ['', 'four', '0.5', '11', '1e999', 'NaN']) expect(parsed(wrong, lead)).toBeUndefined();
  });

  it('have decimals by their range: 1 to 10 N in steps of 0.1, 0.05 to 1 s in steps of 0.01', () => {
    const newton = viewOf(new ParameterT('a', 0, 'N', 1, 10, 5, 1), {});
    expect([newton.step, newton.decimals]).toEqual([0.1, 1]);
    const second = viewOf(new ParameterT('b', 0, 's', 0.05, 1, 0.3, 1), {});
    expect([second.step, second.decimals]).toEqual([0.01, 2]);
  });

  it('show a ramp until it arrives; a refusal restores the value', () => {
    const target = new ParameterTarget(1.4);
    target.ask(1.6, 0);
    target.onState(1.5, 200);
    expect([target.target, target.shown, target.now]).toEqual([1.6, 1.6, 1.5]);
    target.onState(Math.fround(1.6), 400);
    expect(target.target).toBeUndefined();
    target.ask(9, 500);
    target.refuse();
    expect(target.shown).toBe(Math.fround(1.6));
  });

  it('drop a request when the value moves away, as another console requested', () => {
    const target = new ParameterTarget(8);
    target.ask(2, 0);
    target.onState(7.5, 200);
    expect(target.target).toBe(2);
    for (let k = 1; k <= 5; k += 1) target.onState(7.5 + 0.3 * k, 200 + 200 * k);  // up to 9 N
    expect([target.target, target.shown]).toEqual([undefined, 9]);
  });

  it('drop a request when the value stands still short of it', () => {
    const target = new ParameterTarget(8);
    target.ask(2, 0);
    target.onState(7, 200);
    target.onState(7, 1600);
    expect(target.target).toBe(2);
    target.onState(7, 1800);
    expect([target.target, target.shown]).toEqual([undefined, 7]);
  });

  it('tolerate an earlier ramp for a moment before the newer value arrives', () => {
    const target = new ParameterTarget(5);
    target.ask(2, 0);
    target.onState(5.1, 100);
    expect(target.target).toBe(2);
    target.onState(4.9, 200);
    expect(target.target).toBe(2);
  });

  it('let a slider return to the initial value, although its steps do not contain it', () => {
    // squeeze_threshold_ratio: 1 in 0.25 to 2, in steps of 0.02 from 0.25: 0.99 and 1.01 are the nearest values.
    const squeeze = viewOf(new ParameterT('squeeze_threshold_ratio', 2, '1', 0.25, 2, 1, 0.5), {});
    expect([squeeze.lower, squeeze.step]).toEqual([0.25, 0.02]);
    expect([0.97, 0.99, 1.01, 1.03].map((at) => meantBySlider(at, 1, squeeze.step))).toEqual([0.97, 1, 1, 1.03]);
  });
});

describe('the status of a real device', () => {
  const device: ReportedDevice = {
    enabled: true, homed: true, silenced: false, temperatureKnown: true, temperatureC: 41.4,
    sampleAgeS: 0.0012, hosted: true, hostAgeS: 2.34, letGo: ReleaseReason.None,
  };

  it('is undefined for a simulated device', () => {
    expect(deviceLines(null, en)).toBeUndefined();
    expect(deviceLines(new WorldStateT().device, en)).toBeUndefined();
  });

  it('has its state, its temperature and the ages of its sample and its host', () => {
    expect(deviceLines(device, en, false, -0.128)).toEqual({ state: 'Enabled, homed', figures: 'Temperature 41 °C · sample 1 ms · host 2.3 s · work −0.13 J', letGo: '' });
    const plain = { ...device, enabled: false, homed: false, temperatureKnown: false, sampleAgeS: -1, hosted: false };
    expect(deviceLines(plain, en)).toEqual({ state: 'Not enabled, not homed', figures: 'Temperature not known · sample none yet · work 0.00 J', letGo: '' });
  });

  it('has a release reason in every language, for every reason of the schema', () => {
    const reasons = Object.values(ReleaseReason).filter((value): value is ReleaseReason => typeof value === 'number' && value !== ReleaseReason.None);
    expect(reasons.length).toBe(6);   // all of ReleaseReason in the schema except None
    for (const texts of [en, de, fr]) {
      const lines = reasons.map((letGo) => deviceLines({ ...device, silenced: true, letGo }, texts)?.letGo ?? '');
      expect(new Set(lines).size).toBe(reasons.length);
      for (const line of lines) expect(line).not.toMatch(/[{}]/);
    }
    expect(deviceLines({ ...device, letGo: ReleaseReason.LoopSilent }, de)?.letGo).toBe('Der Host hat losgelassen: 20 ms lang kein neuer Befehl');
  });
});

describe('the meaning of the state', () => {
  const names = ['device read failed', 'device write failed', 'effort limited', 'stop requested', 'something new'];

  it('names faults by their bits, unknown ones in the program’s words', () => {
    expect(faultWords(0b10101, names)).toEqual(['the device gave no position', 'effort held at its limit', 'something new']);
    expect(faultWords(0, names)).toEqual([]);
  });

  it('shows the cause of a fault, without the stop that followed it', () => {
    const status = statusOf('open', { runState: RunState.Faulted, latchedFaults: 0b1001 }, false, names, en);
    expect(status).toMatchObject({ name: 'faulted', step: 3, bad: true, cause: 'Cause: the device gave no position' });
  });

  it('names an exceeded limit with its axis, the excess, and the advice', () => {
    const names = ['speed limit exceeded', 'workspace left', 'encoder stuck', 'stop requested'];
    const axes = [{ name: 'x', unit: 'm' }, { name: 'finger_flexion', unit: 'rad' }];
    const faulted = { runState: RunState.Faulted, faults: 0, safetyState: SafetyState.Faulted };
    const fast = { ...faulted, latchedFaults: 0b1001, faultAxis: 0, faultValue: 1.6234, faultLimit: 1.5 };
    const status = statusOf('open', fast, false, names, en, axes);
    expect(status.cause).toBe('Cause: the hand moved too fast');
    expect(status.excess).toBe('x, away: 1.62 m/s, limit 1.5');
    expect(status.did).toContain('within 0.1 s');
    expect(status.todo).toBe(en.advice['speed limit exceeded']);
    const left = { ...faulted, latchedFaults: 0b0010, faultAxis: 1, faultValue: Math.PI, faultLimit: Math.PI / 2 };
    expect(statusOf('open', left, false, names, de, axes).excess).toBe('Finger: 180 °, Grenze 90');
    const stuck = { ...faulted, latchedFaults: 0b0100, faultAxis: 1, faultValue: 0, faultLimit: 0 };
    expect(statusOf('open', stuck, false, names, fr, axes)).toMatchObject({ excess: 'Doigts' });
  });

  it('has a name for every shipped hand and patient in every language', () => {
    const shipped = (folder: string): string[] => readdirSync(new URL(`../../config/${folder}/`, import.meta.url)).map((file) => file.replace('.toml', '')).sort();
    for (const texts of [en, de, fr]) {
      expect(Object.keys(texts.hands).sort()).toEqual(shipped('hands'));
      expect(Object.keys(texts.patients).sort()).toEqual(shipped('patients'));
    }
  });

  it('has advice for every stopping fault in every language', () => {
    const stopping = ['device read failed', 'device write failed', 'non-finite device position', 'non-finite effort', 'non-finite state',
      'physics step failed', 'singular reduced inertia', 'speed limit exceeded', 'workspace left', 'encoder jumped', 'encoder stuck',
      'late ticks in a row', 'gap too long', 'bodies exploded'];  // kStopping of src/loop/core/fault.hpp
    for (const texts of [en, de, fr]) {
      for (const name of stopping) {
        expect(texts.advice[name], name).toBeDefined();
      }
    }
  });

  it('distinguishes an emergency stop, and shows the effort while it is blended in', () => {
    const names = ['stop requested', 'emergency stop'];
    const stopped = { runState: RunState.Stopped, latchedFaults: 0, faults: 0b11 };
    expect(statusOf('open', stopped, false, names, en).cause).toBe(en.safety.emergency);
    expect(statusOf('open', { ...stopped, faults: 0b01 }, false, names, en).cause).toBe(en.safety.stopped);
    const armed = { runState: RunState.Rendering, latchedFaults: 0, faults: 0, safetyState: SafetyState.Armed };
    expect(statusOf('open', armed, false, names, en)).toMatchObject({ name: 'rendering', cause: en.safety.armed });
    expect(statusOf('open', { ...armed, rehearsedTicks: 7 }, false, names, en).cause, 'the next level is rehearsed').toBe(en.safety.armed);
    expect(statusOf('open', { runState: RunState.Disarmed, latchedFaults: 0, rehearsedTicks: 1234 }, false, names, en)).toMatchObject({ name: 'disarmed', cause: en.safety.rehearsing, did: '1234 ticks so far. It starts when all are fast enough.' });
  });

  it('is unknown without a connection', () => {
    expect(statusOf('lost', { runState: RunState.Rendering, latchedFaults: 0 }, false, names, en).name).toBe('lost');
    expect(statusOf('connecting', null, false, names, en).step).toBeUndefined();
  });

  it('shows a pause only while rendering', () => {
    expect(statusOf('open', { runState: RunState.Rendering, latchedFaults: 0 }, true, names, en)).toMatchObject({ name: 'paused', step: 1 });
    expect(statusOf('open', { runState: RunState.Stopped, latchedFaults: 0 }, true, names, en).name).toBe('stopped');
  });
});

describe('marks', () => {
  it('number the phases of a grasp ① to ④, once for each moment', () => {
    const marks = new Marks();
    const names = ['touched', 'engaged', 'spilt'];
    const event = (type: number, tick: number): EventT => new EventT(BigInt(tick), type, 0, 0);
    marks.addEvents([event(0, 1000), event(0, 1100), event(1, 1200), event(2, 1300), event(0, 2000)], names, (tick) => Number(tick) / 1000, en);
    expect(marks.list.map((mark) => `${mark.label}${mark.time_s}`)).toEqual(['①1', '②1.2', '①2']);
    marks.forgetBefore(1.1);
    expect(marks.list.length).toBe(2);
  });

  it('contain the end of rendering once', () => {
    const marks = new Marks();
    for (const [run, t] of [[RunState.Rendering, 0], [RunState.Faulted, 1], [RunState.Faulted, 2]] as const) marks.addRunState(run, t, en);
    expect(marks.list).toMatchObject([{ time_s: 1, label: 'fault', bad: true }]);
  });
});

describe('texts', () => {
  const gaps = (text: string): string[] => (text.match(/\{\w+\}/g) ?? []).sort();
  const flat = (value: object, at = ''): [string, string][] => Object.entries(value).flatMap(([key, inner]) =>
    typeof inner === 'string' ? [[`${at}${key}`, inner]] : flat(inner as object, `${at}${key}.`)) as [string, string][];

  it.each([['German', de], ['French', fr]])('in %s have the keys and placeholders of English', (_name, other) => {
    const english = flat(en);
    const theirs = new Map(flat(other));
    expect([...theirs.keys()]).toEqual(english.map(([key]) => key));
    for (const [key, text] of english) {
      expect(theirs.get(key)?.length, key).toBeGreaterThan(0);
      expect(gaps(theirs.get(key) ?? ''), key).toEqual(gaps(text));
    }
  });

  it('in German use Swiss spelling', () => {
    expect(JSON.stringify(de)).not.toContain('ß');
  });
});

describe('recordings that have ended', () => {
  const entry = { name: '20261122-081500-p-014-cocktail-bar-level-1.h5', title: 'cocktail-bar, level 1', duration_s: 63, bytes: 11_000_000, report: '/r' };

  it('are reported once, when they appear in the list', () => {
    const watch = new SavedWatch();
    expect(watch.take('')).toBe(false);
    expect(watch.take(entry.name)).toBe(false);
    expect(watch.found([])).toEqual([]);
    expect(watch.take('')).toBe(true);
    expect(watch.found([])).toEqual([]);  // not in the list yet
    expect(watch.found([{ name: 'older.h5' }, entry])).toEqual([entry]);
    expect(watch.found([entry])).toEqual([]);
  });

  it('are reported even if the next recording begins at once', () => {
    const watch = new SavedWatch();
    watch.take(entry.name);
    expect(watch.take('next.h5')).toBe(true);
    expect(watch.found([entry])).toEqual([entry]);
  });

  it('are not reported if they ended before the page was opened', () => {
    expect(new SavedWatch().found([entry])).toEqual([]);
  });

  it('are listed with the figures of the file', () => {
    expect(figuresOf(entry)).toContain(duration(63));
    expect(figuresOf(entry)).toContain(bytes(11_000_000));
    expect(figuresOf({ name: 'a.h5' })).toBe('');
    // The length of a file that is being written is unknown: the file states 0 s until it is closed.
    expect(figuresOf({ name: 'a.h5', duration_s: 0, being_written: true, bytes: 1000 })).not.toContain(duration(0));
  });

  it('that were broken off are called by person, exercise and begin, and say so', () => {
    const killed = { name: '20261129-141813-p-014-cocktail-bar-level-2.h5', title: '20261129-141813-p-014-cocktail-bar-level-2', created_utc: '', duration_s: 0, bytes: 50_000_000 };
    expect([sessionWords(killed), figuresOf(killed)]).toEqual(['p-014: Cocktail bar, Level 2', `broken off, ${bytes(50_000_000)}`]);
    expect(whenMade(killed, new Date(2026, 10, 29, 18), 'en-GB')).toBe('14:18');
    expect(sessionWords({ name: '20261129-141813-light-switch-level-1-2.h5' })).toBe('Light switch, Level 1');
    expect(sessionWords({ name: '20261129-141813-something-level-1.h5' })).toBe('20261129-141813-something-level-1.h5');
  });

  it('are limited to the newest at first, plus those being written or chosen', () => {
    const many = Array.from({ length: 1000 }, (_, k) => ({ name: `${k}.h5`, being_written: k === 900 }));
    expect(shownOf(many, ['500.h5'], false).map(({ name }) => name)).toEqual(['0.h5', '1.h5', '2.h5', '3.h5', '4.h5', '5.h5', '500.h5', '900.h5']);
    expect(shownOf(many, [], true)).toEqual(many);
  });

  it('offer neither report nor download while they are still written', () => {
    const growing = { name: 'a.h5', bytes: 11_000_000, being_written: true, report: '/api/recordings/a.h5/report/' };
    expect(figuresOf(growing)).toBe(`${en.recordings.beingWritten}, ${bytes(11_000_000)}`);
    expect(offered(growing)).toEqual({ report: false, download: false });
    expect(offered({ ...growing, being_written: false })).toEqual({ report: true, download: true });
    expect(offered({ name: 'a.h5' })).toEqual({ report: false, download: true });
  });
});

describe('limits of axes', () => {
  // config/devices/lambda-pride.toml: fingers 10 N at the tip; circumduction 0.6 Nm over 0.08 m, 7.5 N.
  const axis = (name: string, effortLimit: number): AxisT => Object.assign(new AxisT(), { name, unit: 'rad', leverArmM: 0.08, effortLimit });
  it.each([[undefined, [10, 7.5]], [8, [8, 7.5]], [5, [5, 5]]])('are the lower one of the device\'s and the set limit: %s', (set, limits) => {
    const all = [axis('finger_flexion', 0.8), axis('thumb_circumduction', 0.6)];
    expect(all.map((one) => Number(limitOfAxis(one, (name) => (name === 'effort_limit_hand_tip_n' ? set : undefined)).toFixed(9)))).toEqual(limits);
  });
});

describe('the name of the player', () => {
  it('is the code of the open profile, else that of the virtual patient; a real device without a profile has none', () => {
    expect([personWords('P-014', 'relaxed-adult', true), personWords('', 'relaxed-adult', true), personWords('', 'relaxed-adult', false)])
      .toEqual(['P-014', 'Virtual patient: Relaxed adult', '']);
    expect([sessionWords({ profile: 'P-014', title: 'cocktail-bar, level 1 of 4', name: 'a.h5' }), sessionWords({ name: 'a.h5' })]).toEqual(['P-014: Cocktail bar, Level 1', 'a.h5']);
  });
});
