// A squeeze bottle gives a few millilitres per stroke; then the hand opens, air returns, and it squeezes again.
import { afterEach, describe, expect, it, vi } from 'vitest';
import { targetsOf } from '../src/exercises';
import type { GraspTargets } from '../src/exercises/exercise';
import { barOf, Stage } from '../src/exercises/cocktail_bar/bar';
import { laneOf } from '../src/input/guide';
import { restingWish, type Help, type Wish } from '../src/input/wish';
import { Player } from './player';
import { StandInHand } from './stand_in_hand';
import { LOOK_S } from './steered_hand';
import { moment, sceneOfSunset } from './sunset';
import { DESKTOP, Picture, waysOf, type PlayingWay } from './ways';

/** Time limits for the return of air, and for a step of several strokes [s]. */
const AIR_S = 1.5;
const STEP_S = 25;

/** The result of a step. */
interface FillResult { poured_ml: number; spilt_ml: number; strokes: number; lost: number; longest_s: number; done: boolean }

/** Plays the first step of a level until it is done. @param wish the person's wish @param after called after every look */
async function fill(hand: StandInHand, help: Help, wish: (t_s: number) => Wish, after: (player: Player) => void = () => {}): Promise<FillResult> {
  const player = new Player(hand, help), begun: number[] = [];
  let t = 0, poured_l = 0, was = -1, lost = 0, longest_s = 0, since_s = 0;
  const isDone = (): boolean => t > 0.1 && (hand.value('step') > 0 || hand.value('stage') === Stage.DrinkDone || hand.value('stage') === Stage.LevelDone);
  for (; t < STEP_S && !isDone(); t += LOOK_S) {
    await player.look(wish(t), t === 0);
    after(player);
    const stage = hand.value('stage');
    if (stage === Stage.Pour && was !== Stage.Pour) begun.push(t);
    if (stage === Stage.Reach && was > Stage.Reach && was !== Stage.DrawBack) lost += 1;
    since_s = stage === Stage.Breathe ? since_s + LOOK_S : 0;
    longest_s = Math.max(longest_s, since_s);
    was = stage;
    poured_l = Math.max(poured_l, hand.value('layer_l/0'));
  }
  return { poured_ml: 1000 * poured_l, spilt_ml: 1000 * hand.value('spilt_l'), strokes: begun.length, lost, longest_s, done: isDone() };
}

const step_ml = (hand: StandInHand): { asked: number; tolerance: number } => {
  const { amount_l, tolerance_l } = barOf(hand.scene)!.drinks[0]!.steps[0]!;
  return { asked: 1000 * amount_l, tolerance: 1000 * tolerance_l };
};

/** A person who presses once, when "reach" is shown, and releases. */
function onePress(way: PlayingWay, picture: Picture): (t_s: number) => Wish {
  let down = false;
  return (t_s) => {
    const presses = t_s > 1 && t_s < 1.2;
    if (presses !== down) way.press(presses, picture.wanted());
    down = presses;
    return way.wish(t_s);
  };
}

/** A person who steers with keys: into the lane, in, around the bottle; squeezes, lets go and leaves as the screen says. */
function byHand(hand: StandInHand, squeeze: () => Wish['squeeze']): () => Wish {
  const towards = (gap_m: number): number => Math.max(-0.1, Math.min(0.1, 4 * gap_m));
  return () => {
    const [x = 0, y = 0, z = 0] = hand.now.q_m, { grips, beside, target } = hand.perceiver.onState(hand.state), grip = grips[target]!, lane_y = laneOf(grip, beside);
    const stage = hand.value('stage');
    if (stage === Stage.LetGo || stage >= Stage.DrinkDone && stage !== Stage.Breathe) {
      const open = hand.value('squeeze_n') === 0;
      return { ...restingWish(), velocity: { x: open && Math.abs(y - lane_y) < 0.006 ? -0.1 : 0, y: open ? towards(lane_y - y) : 0, z: 0 } };
    }
    const there = Math.abs(x - grip.x) < 0.01;
    const velocity = { x: there || Math.abs(y - lane_y) < 0.006 ? towards(grip.x - x) : 0, y: towards((there ? grip.y : lane_y) - y), z: towards(grip.z - z) };
    return { ...restingWish(), velocity, squeeze: there && Math.abs(y - grip.y) < 0.004 && squeeze() };
  };
}

afterEach(() => { vi.unstubAllGlobals(); });

function expectFilled(hand: StandInHand, { done, poured_ml, spilt_ml, strokes, lost, longest_s }: FillResult, who: string): void {
  const { asked, tolerance } = step_ml(hand);
  expect(done, `${who}: the step is done`).toBe(true);
  expect(Math.abs(poured_ml - asked), `${who}: ${poured_ml} ml`).toBeLessThanOrEqual(tolerance);
  expect(spilt_ml, who).toBe(0);
  expect([2, 3], `${who}: strokes`).toContain(strokes);
  expect(lost, `${who}: how often the hand left the bottle`).toBe(0);
  expect(longest_s, `${who}: waits for air`).toBeGreaterThan(0.3);
  expect(longest_s, `${who}: waits for air`).toBeLessThan(AIR_S);
}

describe('a step that needs more than one stroke', () => {
  it.each([1, 2, 3, 4])('is filled by one press with full help, by every input method: level %i', async (level) => {
    const hand = new StandInHand(level), picture = new Picture(hand, DESKTOP);
    for (const way of waysOf(picture)) {
      way.enable?.();
      expectFilled(hand, await fill(hand, 'full', onePress(way, picture), (player) => way.overruled?.(player.model.overruled)), way.name);
      way.disable?.();
    }
  });

  it('is filled with full help although the person presses long and often while air returns', async () => {
    const hand = new StandInHand(1);
    const presses = (t_s: number): boolean => (t_s > 1 && t_s < 1.2) || hand.value('stage') === Stage.Breathe;
    expectFilled(hand, await fill(hand, 'full', (t_s) => ({ ...restingWish(), squeeze: presses(t_s) })), 'presses');
  });

  it('is filled with some help while the button is held, without releasing it', async () => {
    const hand = new StandInHand(1);
    expectFilled(hand, await fill(hand, 'some', byHand(hand, () => true)), 'holds');
  });

  it.each(['some', 'none'] as const)('is filled with %s help by a person who lets go and squeezes again as the screen says', async (help) => {
    const hand = new StandInHand(1);
    expectFilled(hand, await fill(hand, help, byHand(hand, () => (hand.value('stage') === Stage.Breathe ? false : 0.45))), help);
  });

  it('is not filled without help by a person who only holds the button: the person must let go', async () => {
    const hand = new StandInHand(1), { done, strokes, poured_ml } = await fill(hand, 'none', byHand(hand, () => 0.45));
    expect([done, strokes]).toEqual([false, 1]);
    expect(poured_ml).toBeGreaterThan(3);
  });
});

describe('the help', () => {
  const targets = (free: boolean): GraspTargets => {
    const scene = sceneOfSunset(), json = JSON.parse(String(scene.exerciseJson)) as { dispensers: object[] };
    scene.exerciseJson = JSON.stringify({ ...json, dispensers: json.dispensers.map((dispenser) => ({ ...dispenser, free })) });
    return targetsOf(scene);
  };

  it('eases the grip on a hanging bottle, and never on a carried one, which would fall', () => {
    const eases = (free: boolean, stage: number) => targets(free).easesOff!(moment({ stage }));
    expect([eases(false, Stage.Breathe), eases(true, Stage.Breathe), eases(false, Stage.Pour)]).toEqual([true, false, false]);
  });

  it('does not draw the hand back while air returns, and stops at the line or when only drips come', () => {
    const letsGo = (values: Record<string, number>, free = false) => targets(free).letGo(moment({ asked_l: 0.02, ...values }));
    expect(letsGo({ stage: Stage.Breathe })).toBe(false);
    expect(letsGo({ stage: Stage.LetGo, flow_l_s: 0.004, poured_l: 0.016 })).toBe(false);
    // The flow after the hand opens: 50 ms of 4 ml/s are 0.2 ml, the 500 ms of an eased grip 2 ml.
    expect([0.0197, 0.0199].map((poured_l) => letsGo({ stage: Stage.LetGo, flow_l_s: 0.004, poured_l }))).toEqual([false, true]);
    expect([0.0179, 0.0181].map((poured_l) => letsGo({ stage: Stage.LetGo, flow_l_s: 0.004, poured_l }, true))).toEqual([false, true]);
    expect(letsGo({ stage: Stage.LetGo, flow_l_s: 0.0003, poured_l: 0.016 })).toBe(true);
  });
});
