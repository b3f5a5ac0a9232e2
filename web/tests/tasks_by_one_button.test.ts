// Kitchen tasks with full help, by one button, on the simulated clock: a person who presses when the screen asks for the
// first step, and does nothing else.
import { expect, it } from 'vitest';
import { targetsOf } from '../src/exercises';
import { KitchenPlay } from '../src/exercises/kitchen/play';
import { taskOf } from '../src/exercises/kitchen/task';
import type { ExercisePanel } from '../src/exercises/panel';
import { playWords } from '../src/game/words';
import { AimModel } from '../src/input/aim_model';
import { Perceiver } from '../src/input/perceiver';
import { restingWish } from '../src/input/wish';
import { fill } from '../src/shared/i18n';
import { en } from '../src/shared/i18n/en';
import { LOOK_S, SteeredHand } from './steered_hand';

/** Issue 41: a newcomer with a mouse does the first task within a minute; later tasks may have more steps. */
const WITHIN_S = 60;
const SIDES = ['right', 'left'] as const;
/** `most`: minimum opening of the joint [m, rad]: to_m or to_rad minus its tolerance, in config/exercises. */
const TASKS = [
  { task: 'drawer', most: 0.09 }, { task: 'cupboard-door', most: 0.95 }, { task: 'light-switch', most: 0.32 },
  { task: 'coffee-mill', most: 12.31 }, { task: 'flip-top-lid', most: 0.37 }, { task: 'press-lever', most: 0 },   // pressed; its compliance is not tested
] as const;
/** The second level has the file's friction and forces; other levels scale them. WHOLEHAND_FULL=1: every level. */
const LEVELS = process.env.WHOLEHAND_FULL === '1' ? [1, 2, 3] : [2];

const ASKS = (['hint.press', 'hint.again', 'hint.goOn'] as const).map((key) => fill(en[key], { x: 'Space' }));
const DOES = [en['game.onItsWay'], en['game.closing'], en['game.doesIt'], en['game.letsGo']];

/** What the strip says below the step's name. */
function said(hand: SteeredHand, model: AimModel, play: KitchenPlay): string {
  play.follow(hand.state);
  return playWords(play, hand.state, {
    now: play.phase(hand.state), help: 'full', hint: 0, oneButton: true, onItsWay: model.onItsWay, outOfReach: false, closing: model.squeeze > 0, acts: model.acts, press: 'Space', beside: null,
  }).more;
}

it.each(TASKS.flatMap((one) => SIDES.flatMap((side) => LEVELS.map((level) => ({ ...one, side, level })))))('one press does $task, $side hand, level $level', async ({ task, most, side, level }) => {
  const hand = await SteeredHand.start(level, task, `adult-median-${side}`);
  try {
    const steps = taskOf(hand.scene)!.steps.length, seen = new Perceiver(hand.scene, targetsOf(hand.scene)), model = new AimModel(hand.axes, { help: 'full' });
    model.begin(hand.now.q_m);
    const panel = { title: '', done: () => hand.value('done') === 1, instruction: () => '' } as unknown as ExercisePanel, play = new KitchenPlay(taskOf(hand.scene)!, panel, hand.scene);
    let t = 0, presses = 0, asked_s = 0, reached = 0;
    for (; t < WITHIN_S && hand.value('done') !== 1; t += LOOK_S) {
      const waits = presses === 0 && hand.value('instruction') === 0 && model.squeeze === 0;
      asked_s = waits || (asked_s > 0 && asked_s < 1.2) ? asked_s + LOOK_S : 0;
      const down = asked_s > 1 && asked_s < 1.2;
      if (down && asked_s < 1 + 1.5 * LOOK_S) presses += 1;
      await hand.aim([...model.step({ ...restingWish(), squeeze: down }, seen.onState(hand.state), LOOK_S)], t === 0);
      expect(hand.now.faults, 'faults that stopped the loop').toBe(0);
      if (hand.value('done') !== 1) {
        // Who moves: the page, or it waits for a press. Letting go needs none.
        const more = said(hand, model, play), does = model.acts || model.squeeze > 0;
        if (does) expect(DOES, `step ${hand.value('instruction')}`).toContain(more);
        else if (play.phase(hand.state) !== 'letgo') expect(ASKS, `step ${hand.value('instruction')}`).toContain(more);
      }
      reached = Math.max(reached, hand.value('joint_q'));
    }
    console.log(`figure: ${task} by one button, ${side}, level ${level}: ${t.toFixed(1)} s, ${presses} presses, score ${hand.value('score').toFixed(0)}, most ${reached.toFixed(3)}, step ${hand.value('instruction')}`);
    expect(hand.value('instruction')).toBe(steps);
    expect(presses).toBe(1);
    expect(reached).toBeGreaterThanOrEqual(most);
  } finally {
    hand.stop();
  }
}, 600_000);
