// A simulated person who plays the program's hand through the pages' aim, on the simulated clock.
import { expect } from 'vitest';
import { AimModel } from '../src/input/aim_model';
import type { Help, Wish } from '../src/input/wish';
import { LOOK_S, type SteeredHand } from './steered_hand';

/** A hand at the bar that follows aims, step by step. */
export type PlayedHand = Pick<SteeredHand, 'axes' | 'scene' | 'state' | 'perceiver' | 'now' | 'aim' | 'value' | 'bodyOf'>;

/** An open hand that presses with more than this counts as held; a longer time than this is a failure. */
export const HELD_N = 1.5;
export const HELD_S = 3;
/** A hand is open, and the meter's low-pass has settled, this long after the last squeeze. */
const OPENED_S = 1.5;

/** Plays for a time; the force on an open hand, and its duration, are checked all the time. */
export class Player<H extends PlayedHand = PlayedHand> {
  longest_s = 0;
  private held_s = 0;
  private open_s = 0;
  readonly model: AimModel;

  constructor(readonly hand: H, help: Help) {
    this.model = new AimModel(hand.axes, { help });
    this.model.begin(hand.now.q_m);
  }

  async look(wish: Wish, restart = false): Promise<void> {
    const { hand, model } = this;
    await hand.aim([...model.step(wish, hand.perceiver.onState(hand.state), LOOK_S)], restart);
    expect(hand.now.faults, 'faults that stopped the loop').toBe(0);
    this.open_s = model.squeeze === 0 ? this.open_s + LOOK_S : 0;
    if (this.open_s > OPENED_S) expect(hand.value('flow_l_s'), 'an open hand pours').toBe(0);
    const sum_n = hand.now.contacts.reduce((sum, [, , f]) => sum.map((v, i) => v + f[i]!), [0, 0, 0]);
    const held = model.squeeze === 0 && Math.hypot(...sum_n) > HELD_N;
    this.held_s = held ? this.held_s + LOOK_S : 0;
    this.longest_s = Math.max(this.longest_s, this.held_s);
  }
}
