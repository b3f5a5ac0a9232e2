import { describe, expect, it, vi } from 'vitest';
import { ConsoleModel } from '../src/console/model';
import type { Connection } from '../src/net/connection';
import { WINDOW_S } from '../src/console/history';
import { AxisT, RunState, SceneT, WorldStateT } from '../src/protocol';

/** A connection that records its orders. */
function connectionWith(controls: { heldByYou: boolean; held: boolean }, takes = true) {
  const asked: string[] = [];
  const connection = {
    controls, scene: null, status: 'open', on: () => () => {},
    takeControls: async () => {
      asked.push('take');
      if (takes) Object.assign(controls, { heldByYou: true, held: true });
      return takes ? { accepted: true, reason: '' } : { accepted: false, reason: 'another client holds the controls' };
    },
    releaseControls: async () => {
      asked.push('give back');
      Object.assign(controls, { heldByYou: false, held: false });
      return { accepted: true, reason: '' };
    },
  };
  return { asked, model: new ConsoleModel(connection as unknown as Connection) };
}

const order = (asked: string[], name: string, accepted = true) => async () => {
  await Promise.resolve();
  asked.push(name);
  return { accepted, reason: accepted ? '' : 'out of range' };
};

describe('an order of the therapist', () => {
  it('is sent without taking the controls, whoever has them', async () => {
    for (const controls of [{ heldByYou: false, held: false }, { heldByYou: false, held: true }, { heldByYou: true, held: true }]) {
      const { asked, model } = connectionWith(controls);
      await model.command('a', order(asked, 'a'));
      expect(asked).toEqual(['a']);
    }
  });

  it('to steer takes the controls, whoever has them, and keeps them', async () => {
    const { asked, model } = connectionWith({ heldByYou: false, held: true });
    await model.command('a', order(asked, 'a'), { steers: true });
    expect(asked).toEqual(['take', 'a']);
  });

  it('to steer is not sent if the controls are refused, and the reason is reported', async () => {
    const { asked, model } = connectionWith({ heldByYou: false, held: true }, false);
    model.onRefused = vi.fn();
    await model.command('Who plays', order(asked, 'a'), { steers: true });
    expect(asked).toEqual(['take']);
    expect(model.onRefused).toHaveBeenCalledWith('Who plays', 'another client holds the controls');
  });

  it('is reported with its reason when refused, unless it is quiet', async () => {
    const { asked, model } = connectionWith({ heldByYou: false, held: false });
    model.onRefused = vi.fn();
    await model.command('Fingers', order(asked, 'a', false));
    expect(model.onRefused).toHaveBeenCalledWith('Fingers', 'out of range');
    await model.command('Fingers', order(asked, 'a', false), { quietly: true });
    expect(model.onRefused).toHaveBeenCalledTimes(1);
  });
});

describe('the history after a stop', () => {
  const AXIS = new AxisT('x', 'm', -0.1, 0.1, 20, 0, 1.5);

  /** The messages to a console: a scene, half a minute of states at 60 Hz, then states of a stopped program, which repeat the last tick. */
  function stopped() {
    const handlers: { scene?: (scene: SceneT) => void; state?: (state: WorldStateT) => void } = {};
    const connection = {
      controls: { heldByYou: false, held: false }, status: 'open', scene: null,
      on: (name: 'scene' | 'state', callback: never) => { handlers[name] = callback; return () => {}; },
    };
    const model = new ConsoleModel(connection as unknown as Connection);
    handlers.scene!(Object.assign(new SceneT(), { session: 1, axes: [AXIS] }));
    const sendState = (tick: number, more: Partial<WorldStateT> = {}): void => handlers.state!(Object.assign(new WorldStateT(), {
      session: 1, tick: BigInt(tick), timeS: tick / 1000, runState: RunState.Rendering, sent: [tick / 1000], qM: [0], qS: [0], phi: [0], ...more,
    }));
    for (let tick = 0; tick <= 30_000; tick += 16) sendState(tick);
    return { model, sendState, handlers };
  }

  it('keeps the last 10 s, however long no state comes', () => {
    const { model, sendState } = stopped();
    for (let i = 0; i < 2000; i += 1) sendState(30_000, { runState: RunState.Stopped, endings: 1 });
    const { history } = model;
    const efforts = [...history.values(history.column('effort', 0))];
    // 10 s in steps of 16 ms; the effort equals the time, so the last ten seconds are identified.
    expect([efforts.length, efforts[0], efforts.at(-1)]).toEqual([626, 20, 30]);
    expect(history.window.to_s - history.window.from_s).toBe(WINDOW_S);
    expect(history.peak('effort', 0)).toBe(30);
    expect(model.state?.runState, 'and the state that is shown is the last').toBe(RunState.Stopped);
  });

  it('has a clock that stands still while no state comes', () => {
    const now = vi.spyOn(performance, 'now').mockReturnValue(1000);
    const { model, sendState } = stopped();
    const began_ms = model.stated_ms;
    for (const at_ms of [1016, 1032, 9032, 9048]) {  // 8 s without a state
      now.mockReturnValue(at_ms);
      sendState(30_000);
    }
    expect(model.stated_ms - began_ms).toBe(16 + 16 + 50 + 16);
    now.mockRestore();
  });

  it('is kept when the program sends a new scene, and beside the next session', () => {
    const { model, sendState, handlers } = stopped();
    handlers.scene!(Object.assign(new SceneT(), { session: 2, axes: [AXIS] }));
    sendState(16, { session: 2 });
    const efforts = model.history.values(model.history.column('effort', 0));
    expect(efforts.length, 'less than a second of them has left the window').toBeGreaterThan(560);
    expect(efforts[efforts.length - 3]).toBe(30);
    expect(efforts[efforts.length - 1]).toBe(0.016);
  });
});

describe('notices', () => {
  /** A model that receives states like those of a connection. */
  function listening() {
    let handlers: (state: WorldStateT) => void = () => {};
    const connection = {
      controls: { heldByYou: false, held: false }, status: 'open', scene: null,
      on: (name: string, callback: (state: WorldStateT) => void) => { if (name === 'state') handlers = callback; return () => {}; },
    };
    const model = new ConsoleModel(connection as unknown as Connection);
    model.scene = Object.assign(new SceneT(), { faultNames: Array.from({ length: 27 }, (_, i) => (i === 6 ? 'effort limited' : `fault ${i}`)) });
    let tick = 0;
    const sendState = (limited: number, faults = 0, session = 1): void => {
      tick += 17;
      const faultTicks = Array.from({ length: 27 }, (_, i) => (i === 6 ? limited : 0));
      handlers(Object.assign(new WorldStateT(), { session, tick: BigInt(tick), timeS: tick / 1000, faultTicks, faults }));
    };
    return { model, sendState };
  }

  it('contain a limit that held only between two received states', () => {
    const { model, sendState } = listening();
    sendState(0);
    expect(model.notice).toBeUndefined();
    sendState(5);  // in none of the ticks that were sent
    expect(model.notice?.bits).toBe(1 << 6);
    expect(model.limited).toBe(true);
  });

  it('do not contain faults that were counted before the page was opened', () => {
    const { model, sendState } = listening();
    sendState(94);
    expect(model.notice).toBeUndefined();
    sendState(94);
    expect(model.notice).toBeUndefined();
    sendState(1, 0, 2);  // another session counts from 0
    expect(model.notice).toBeDefined();
  });
});
