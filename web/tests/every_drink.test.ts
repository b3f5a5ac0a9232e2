// A drink by every input method with full help, by a person who does only what the screen says, on the simulated
// clock. WHOLEHAND_FULL=1: both hands, every level of both bars, and four screens for pointing methods.
import { afterEach, expect, it, vi } from 'vitest';
import { Stage } from '../src/exercises/cocktail_bar/bar';
import { Player } from './player';
import { LOOK_S, SteeredHand } from './steered_hand';
import { DESKTOP, Picture, waysOf, type PlayingWay, type Screen } from './ways';

const FULL = process.env.WHOLEHAND_FULL === '1';
/** Time limit of a drink with full help. */
const DRINK_S = 60;
/** A person presses after the instruction was shown for this long, and releases the button again. */
const PRESS_FROM_S = 1;
const PRESS_TO_S = 1.2;

const SCREENS: readonly Screen[] = [DESKTOP, { width: 1920, height: 1080 }, { width: 820, height: 1180 }, { width: 390, height: 844 }];
interface Place { readonly side: string; readonly exercise: string; readonly level: number; readonly screen: Screen }
const LEVELS: readonly [string, number][] = [1, 2, 3, 4].map((level) => ['cocktail-bar', level] as [string, number]);
const FREE_LEVELS: readonly [string, number][] = [['cocktail-bar-free', 1], ['cocktail-bar-free', 2]];
const PLACES: readonly Place[] = !FULL ? [{ side: 'right', exercise: 'cocktail-bar', level: 1, screen: DESKTOP }]
  : ['right', 'left'].flatMap((side) => [...LEVELS, ...FREE_LEVELS].flatMap(([exercise, level]) => SCREENS.map((screen) => ({ side, exercise, level, screen }))));

/** Plays from the beginning until a drink is done; returns its duration [s]. */
async function drink(hand: SteeredHand, picture: Picture, way: PlayingWay): Promise<number> {
  const player = new Player(hand, 'full');
  way.enable?.();
  let t = 0, reaching_s = 0, down = false;
  const done = (): boolean => t > 0.1 && (hand.value('stage') === Stage.DrinkDone || hand.value('stage') === Stage.LevelDone);
  for (; t < DRINK_S && !done(); t += LOOK_S) {
    reaching_s = hand.value('stage') === Stage.Reach ? reaching_s + LOOK_S : 0;
    const presses = reaching_s > PRESS_FROM_S && reaching_s < PRESS_TO_S;
    if (presses !== down) way.press(presses, picture.wanted());
    down = presses;
    await player.look(way.wish(t), t === 0);
    way.overruled?.(player.model.overruled);
  }
  way.disable?.();
  return t;
}

const open: SteeredHand[] = [];
afterEach(() => { for (const hand of open.splice(0)) hand.stop(); vi.unstubAllGlobals(); });

it.each(PLACES)('every input method mixes a drink: $side hand, $exercise level $level, $screen.width × $screen.height', async ({ side, exercise, level, screen }) => {
  const hand = await SteeredHand.start(level, exercise, `adult-median-${side}`);
  open.push(hand);
  const picture = new Picture(hand, screen), took: string[] = [], failed: string[] = [];
  for (const way of waysOf(picture)) {
    if (screen !== DESKTOP && !way.points) continue;
    const t = await drink(hand, picture, way);
    const words = `${way.name} ${t.toFixed(1)} s`;
    took.push(words);
    if (t >= DRINK_S || hand.value('stars') < 3) failed.push(`${words}, stage ${hand.value('stage')}, ${hand.value('stars')} stars, spilt ${hand.value('spilt_l')} l`);
  }
  console.log(`figure: a drink, ${side}, ${exercise} ${level}, ${screen.width} × ${screen.height}: ${took.join(', ')}`);
  expect(failed).toEqual([]);
}, 600_000);
