// What a page credits: only a part that the person moved from its begin to its end. Scripted visits with take-overs are
// compared with the record, which has a mover for every state.
import { expect, it } from 'vitest';
import { Stage } from '../src/exercises/cocktail_bar/bar';
import { Credit } from '../src/game/credit';
import { pageState, type Situation } from '../src/game/page_state';
import { RunState, Steering } from '../src/protocol';
import { moment, playOfSunset } from './sunset';

/** Mulberry32: the same numbers for the same seed. */
function random(seed: number): () => number {
  let a = seed;
  return () => {
    a = (a + 0x6d2b79f5) >>> 0;
    let t = Math.imul(a ^ (a >>> 15), 1 | a);
    t = (t + Math.imul(t ^ (t >>> 7), 61 | t)) ^ t;
    return ((t ^ (t >>> 14)) >>> 0) / 4294967296;
  };
}

const POURS = [0.004, 0.012, 0.02, 0.03, 0.04].map((poured_l) => ({ stage: Stage.Pour, step: 0, poured_l }));

it('of 100 visits with take-overs is what the record says', () => {
  const next = random(60);
  let own = 0, theirs = 0;
  for (let visit = 0; visit < 100; visit++) {
    const credit = new Credit(), play = playOfSunset();
    for (let drink = 0; drink < 3; drink++) {
      const movers = POURS.map(() => (next() < 0.75 ? Steering.Person : Steering.VirtualPatient));
      // Before anything is poured, it does not matter who reaches.
      credit.follow(moment({ stage: Stage.Reach, drink, step: 0, poured_l: 0 }, { steering: next() < 0.5 ? Steering.Person : Steering.VirtualPatient }), play);
      POURS.forEach((pour, i) => credit.follow(moment({ ...pour, drink }, { steering: movers[i] }), play));
      const recorded = movers.every((mover) => mover === Steering.Person);
      expect(credit.own).toBe(recorded);
      own += Number(recorded);
      theirs += Number(!recorded);
    }
  }
  expect(own).toBeGreaterThan(30);
  expect(theirs).toBeGreaterThan(100);
});

it('is nothing of a part that the page has not seen from its begin', () => {
  const credit = new Credit();
  credit.follow(moment({ stage: Stage.Pour, step: 0, poured_l: 0.02 }), playOfSunset());
  expect(credit.own).toBe(false);
});

it('of a real device is the person’s', () => {
  const credit = new Credit(), play = playOfSunset();
  credit.follow(moment({ stage: Stage.Reach, step: 0, poured_l: 0 }, { intention: [] }), play);
  credit.follow(moment({ stage: Stage.Pour, step: 0, poured_l: 0.02 }, { intention: [], steering: Steering.VirtualPatient }), play);
  expect(credit.own).toBe(true);
});

it('the end of an exercise of a visit is no emergency; an emergency stop and a fault are', () => {
  const s: Situation = { status: 'open', problem: null, everOpen: true, attempts: 0, wish: 'play', loading: false, resting: 'no', framing: false, unseen: 'no', loss: '', held: { heldByYou: true, held: true }, visit: 'open' };
  const play = playOfSunset(), GENTLE = 1 << 10 | 1 << 27, EMERGENCY = 1 << 10 | 1 << 11;
  const seen = (runState: RunState, latchedFaults: number, change: Partial<Situation> = {}) => pageState({ ...s, ...change }, play, moment({ stage: Stage.Pour }, { runState, latchedFaults }));
  for (const run of [RunState.Stopping, RunState.Stopped]) {
    expect(seen(run, GENTLE)).toBe('ended');
    expect(seen(run, EMERGENCY)).toBe('stopped');
    expect(seen(run, GENTLE, { visit: 'none' })).toBe('stopped');
  }
  expect(seen(RunState.Faulted, GENTLE)).toBe('stopped');
  expect(seen(RunState.Disarmed, 0, { visit: 'over', wish: 'watch' })).toBe('ended');
  expect(seen(RunState.Rendering, 0, { visit: 'over' })).toBe('hold');
});
