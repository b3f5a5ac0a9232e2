// Kitchen tasks with some help and without, by keys, on the simulated clock: a person who moves to the ring and the
// arrow, and closes and opens the hand where the cues ask for it.
import { expect, it } from 'vitest';
import { targetsOf } from '../src/exercises';
import { taskOf } from '../src/exercises/kitchen/task';
import { AimModel } from '../src/input/aim_model';
import { Perceiver, type Perception } from '../src/input/perceiver';
import { Push } from '../src/input/push';
import { restingWish, type Help, type Triple, type Wish } from '../src/input/wish';
import { LOOK_S, SteeredHand } from './steered_hand';

const WITHIN_S = 120;
const LEVEL = 2;
/** Speed of the hand by keys [m/s], and position tolerance [m]. */
const KEYS_M_S = 0.12;
const THERE_M = 0.01;
/** Lateral distance beside a handle, and x of a hand drawn back [m]. */
const BESIDE_M = 0.09;

/** A person with keys: each axis moves or does not; a person who taps waits for the hand, which follows the request. */
function keysTo(goal: Triple, at: Triple): Triple {
  const key = (axis: keyof Triple): number => (Math.abs(goal[axis] - at[axis]) < THERE_M / 2 ? 0 : KEYS_M_S * Math.sign(goal[axis] - at[axis]));
  return { x: key('x'), y: key('y'), z: key('z') };
}
const isAt = (goal: Triple, at: Triple): boolean => Math.hypot(goal.x - at.x, goal.y - at.y, goal.z - at.z) < 2 * THERE_M;

class Person {
  private push: Push | undefined;
  private beside = false;
  private there = false;
  private lets = false;

  constructor(private readonly back_m: number) {}

  wish(seen: Perception, aim: Triple): Wish {
    const hand = { x: seen.device[0]!, y: seen.device[1]!, z: seen.device[2]! }, grip = seen.grips[0]!, wish = restingWish();
    if (this.lets && !seen.letGo) this.beside = this.there = false;   // and moves there again
    this.lets = seen.letGo;
    if (seen.letGo || seen.target < 0) {
      this.push = undefined;
      // Hooked fingers pass a handle sideways.
      const aside = this.there ? { ...aim, y: grip.y - seen.beside * BESIDE_M } : { ...aim, x: this.back_m };
      if (this.there && isAt(aside, aim)) this.beside = this.there = false;
      return { ...wish, velocity: seen.squeeze_n > 0.1 ? wish.velocity : keysTo(aside, aim) };
    }
    const away = seen.awayFromUse?.[0];
    if (seen.pushes) {
      this.push ??= new Push();
      return { ...wish, velocity: this.push.step({ hand, aim, grip, back_m: this.back_m, toward: seen.pushes, away }) };
    }
    if (this.there) {
      const slow = away && Math.hypot(away.x, away.y, away.z) > 0.004 ? 0.5 * KEYS_M_S / Math.hypot(away.x, away.y, away.z) : 0;
      return { ...wish, squeeze: true, velocity: away ? { x: slow * away.x, y: slow * away.y, z: slow * away.z } : wish.velocity };
    }
    const lane = { ...grip, y: grip.y - seen.beside * BESIDE_M };
    if (!this.beside) {
      const before = { ...lane, x: Math.min(this.back_m, lane.x) };
      if (Math.abs(aim.y - lane.y) > THERE_M || Math.abs(aim.z - lane.z) > THERE_M) return { ...wish, velocity: keysTo(before, aim) };
      this.beside = isAt(lane, hand);
      return { ...wish, velocity: keysTo(lane, aim) };
    }
    this.there = isAt(grip, hand);
    return { ...wish, velocity: keysTo(grip, aim) };
  }
}

const TASKS = ['drawer', 'cupboard-door', 'light-switch', 'coffee-mill', 'flip-top-lid', 'press-lever'] as const;
const HELPS: readonly Help[] = ['some', 'none'];

it.each(TASKS.flatMap((task) => HELPS.map((help) => ({ task, help }))))('$task is done by hand with help "$help"', async ({ task, help }) => {
  const hand = await SteeredHand.start(LEVEL, task);
  try {
    const steps = taskOf(hand.scene)!.steps.length, seer = new Perceiver(hand.scene, targetsOf(hand.scene)), model = new AimModel(hand.axes, { help });
    model.begin(hand.now.q_m);
    const person = new Person(hand.axes.find(({ name }) => name === 'x')!.lower + 0.01);
    let t = 0;
    for (; t < WITHIN_S && hand.value('done') !== 1; t += LOOK_S) {
      const seen = seer.onState(hand.state), [x, y, z] = model.aim as [number, number, number];
      const aims = model.step(t < 1 ? restingWish() : person.wish(seen, { x, y, z }), seen, LOOK_S);
      await hand.aim([...aims], t === 0);
      expect(hand.now.faults, 'faults that stopped the loop').toBe(0);
    }
    console.log(`figure: ${task} by keys, help ${help}: ${t.toFixed(1)} s, score ${hand.value('score').toFixed(0)}, step ${hand.value('instruction')}`);
    expect(hand.value('instruction')).toBe(steps);
  } finally {
    hand.stop();
  }
}, 600_000);
