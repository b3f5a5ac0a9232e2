// Actions of a person who is slow, shaky or in a hurry cost no drink, and never move the hand to an unrequested place.
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { holdZone } from '../src/input/carry_speed';
import { Pilot, type PilotInput } from '../src/input/pilot';
import { Trigger, type TriggerInput } from '../src/input/trigger';
import { restingWish, type Triple } from '../src/input/wish';
import { playWords, type PlayWordsInput } from '../src/game/words';
import { Memory } from '../src/game/memory';
import { RunState, Steering, type SceneT, type WorldStateT } from '../src/protocol';
import type { Play } from '../src/exercises/exercise';
import { en as input } from '../src/input/i18n/en';
import { fill } from '../src/shared/i18n';
import { en } from '../src/shared/i18n/en';

describe('another press', () => {
  const DT_S = 0.02;
  /** Presses and releases, each for a given time; returns the final request. */
  function presses(meets: Partial<TriggerInput>, ...times_s: number[]): boolean | number {
    const trigger = new Trigger();
    let asked: boolean | number = false;
    times_s.forEach((time_s, i) => {
      for (let t = 0; t < time_s; t += DT_S) asked = trigger.step(i % 2 === 0, { taps: true, closed: true, ...meets }, DT_S);
    });
    return asked;
  }

  it('ends the squeeze of a tap; but not within 400 ms, nor while it requests the same action', () => {
    expect(presses({}, 0.1, 1)).toBe(true);
    expect(presses({}, 0.1, 1, 0.1, 0.1)).toBe(false);
    expect(presses({}, 0.1, 0.3, 0.1, 0.1)).toBe(true);
    expect(presses({}, 0.1, 0.3, 0.1, 0.3, 0.1, 0.1)).toBe(true);
    expect(presses({ same: true }, 0.1, 1, 0.1, 0.1)).toBe(true);
  });

  it('that is held ends it on release, but not while it pours', () => {
    expect(presses({ same: true }, 0.1, 1, 1, 0.1)).toBe(false);
    expect(presses({ same: true, well: true }, 0.1, 1, 1, 0.1)).toBe(true);
    expect(presses({ well: true }, 0.1, 1, 0.1, 0.1)).toBe(true);
  });
});

describe('a carried bottle', () => {
  const HOME: Triple = { x: 0.07, y: -0.06, z: 0 }, USE: Triple = { x: -0.03, y: 0, z: 0.05 }, LOW_N = 8.5, DT_S = 0.016;
  const HELD_N = (holdZone(LOW_N).squeezeLow_n + holdZone(LOW_N).squeezeHigh_n) / 2;

  /** Lifted and on its way over the glass, by a tap; then there is no input. */
  function carried(ends: (pilot: Pilot) => void): { at: Triple; squeezed: boolean } {
    const pilot = new Pilot();
    let at = { ...HOME }, squeezed = true;
    for (let t = 0, ended = false; t < 20 && squeezed; t += DT_S) {
      const sight: PilotInput = {
        hand: at, aim: at, back_m: -0.08, grips: [HOME], awayFromUse: [{ x: USE.x - at.x, y: USE.y - at.y, z: USE.z - at.z }], squeeze_n: HELD_N,
        squeezeLow_n: LOW_N, beside: 1, target: 0, reachable: () => true, closed: true, letGo: false,
      };
      const { wish } = pilot.steer({ ...restingWish(), squeeze: t < 0.2 }, sight, 'full', DT_S);
      squeezed = wish.squeeze === true;
      const { x, y, z } = wish.velocity;
      at = { x: at.x + x * DT_S, y: at.y + y * DT_S, z: at.z + z * DT_S };
      if (!ended && Math.hypot(at.x - HOME.x, at.y - HOME.y) > 0.04) { ended = true; ends(pilot); }
    }
    return { at, squeezed };
  }
  const far_m = ({ at }: { at: Triple }): number => Math.hypot(at.x - HOME.x, at.y - HOME.y, at.z - HOME.z);

  it('is put back in its place before the hand opens, when another window or input method takes the input', () => {
    const ended = carried((pilot) => pilot.release());
    expect(ended.squeezed).toBe(false);
    expect(far_m(ended)).toBeLessThan(0.005);
  });

  it('falls if the hand must open at once', () => {
    expect(far_m(carried((pilot) => pilot.drop()))).toBeGreaterThan(0.03);
  });
});

describe('the strip', () => {
  const play = { prompt: () => ({ title: 'Let go', more: 'of the thing' }) } as unknown as Play;
  const asked: PlayWordsInput = { now: 'squeeze', help: 'full', hint: 0, oneButton: true, onItsWay: false, outOfReach: false, closing: false, letGo: input.letGo.keys, beside: null };
  const more = (change: Partial<PlayWordsInput>): string => playWords(play, {} as WorldStateT, { ...asked, ...change }).more;

  it('asks for the press at once if a press closes the hand', () => {
    expect(more({})).toBe(fill(en['hint.again'], { x: en['hint.pressOnce'] }));
    expect(more({ press: 'Space' })).toBe('Space: your hand squeezes');
    expect(more({ closing: true })).toBe(en['game.closing']);
    expect(more({ help: 'some' })).toBe('of the thing');
  });

  it('explains squeezing after a tap without effect, and only then', () => {
    expect(more({ now: 'free', inVain: input.hold.mouse })).toBe(input.hold.mouse);
    expect(more({ now: 'free' })).toBe('of the thing');
    expect(more({ inVain: input.hold.mouse })).toBe(fill(en['hint.again'], { x: en['hint.pressOnce'] }));
  });

  it('explains letting go, or that nothing is to be done', () => {
    expect(more({ now: 'letgo', help: 'none', closing: true })).toBe(input.letGo.keys);
    expect(more({ now: 'letgo', help: 'none' })).toBe('of the thing');
    for (const now of ['hold', 'ease', 'letgo'] as const) expect(more({ now, closing: true })).toBe(en['game.letsGo']);
  });

  it('announces the next action for a spent bottle, and explains letting go if the person does not', () => {
    for (const help of ['some', 'none'] as const) {
      expect(more({ now: 'ease', help, closing: true })).toBe('of the thing');
      expect(more({ now: 'ease', help, closing: true, hint: 1 })).toBe(input.letGo.keys);
    }
  });
});

describe('a reloaded page', () => {
  const kept = new Map<string, string>();
  beforeEach(() => {
    const storage = { getItem: (key: string) => kept.get(key) ?? null, setItem: (key: string, value: string) => { kept.set(key, value); } };
    vi.stubGlobal('sessionStorage', storage);
    vi.stubGlobal('location', { search: '' });
    vi.stubGlobal('matchMedia', () => ({ matches: false }));
  });
  afterEach(() => { kept.clear(); vi.unstubAllGlobals(); });
  const OWNER_SILENT = 1 << 20;
  const state = (session: number, faults = OWNER_SILENT): WorldStateT =>
    ({ session, faults, runState: RunState.Rendering, steering: Steering.Person, qM: [0], intention: [0], values: [], rested: false, help: 0 }) as unknown as WorldStateT;
  /** The action of Start in a page that has received this state. */
  function after(seen: WorldStateT): { isTheirs: boolean; level: number } {
    const memory = new Memory();
    memory.takeScene({ level: 2, levels: 4, capsules: [], bodies: [], valueNames: [], exerciseJson: '' } as unknown as SceneT);
    memory.takeState(seen);
    return { isTheirs: memory.isTheirs, level: memory.level };
  }

  it('continues the drink of this tab, as long as nobody else has played', () => {
    kept.set('wholehand.level', '1');
    new Memory().remember(state(7));
    expect(after(state(7))).toEqual({ isTheirs: false, level: 2 });
    expect(after(state(7, 0)).isTheirs).toBe(true);
    expect(after(state(8)).isTheirs).toBe(true);
  });
});
