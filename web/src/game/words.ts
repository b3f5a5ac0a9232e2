// What the strip says in the play, and where the hand is beside the bottle that is asked for.
import { GRIP_FROM_PALM } from '../input/perception';
import type { Help } from '../input/wish';
import type { SceneT, WorldStateT } from '../protocol';
import type { HintLevel } from './hints';
import { figure, type Script } from './script';
import { hintOf, instructionOf, type Instruction, type PageState } from './view';
import type { TextKey } from '../shared/i18n';

/** Where the palm is from where it holds the bottle that is asked for [m, world]. */
export interface Beside {
  /** How far it still is, away from the person. */
  readonly ahead_m: number;
  /** To the left of the bottle, as seen by the person; negative: to its right. */
  readonly left_m: number;
  /** The side of a bottle on which this hand goes in: +1 its right (a right hand), -1 its left. */
  readonly goesIn: 1 | -1;
}

/** Beside a bottle whose axis is farther away than this the hand is in the row [m]. */
const IN_ROW_M = 0.115;
/** At the bottle [m]. */
const AT_M = 0.012;
/** Stretched fingers go in from here to there beside a bottle's axis [m], on the side of the hand. */
const LANE_M = [-0.004, 0.035] as const;

export function besideOf(script: Script, scene: SceneT, state: WorldStateT, palmLink: number): Beside | null {
  const wanted = script.dispensers[figure(script, state, 'target_dispenser', -1)]?.body;
  const bottle = state.bodies[scene.bodies.findIndex((body) => String(body.name) === wanted)]?.positionM;
  const palm = state.links[palmLink]?.positionM;
  if (!bottle || !palm) return null;
  const goesIn = scene.rightHand ? 1 : -1;
  return { ahead_m: bottle.x - palm.x - GRIP_FROM_PALM.x, left_m: palm.y + goesIn * GRIP_FROM_PALM.y - bottle.y, goesIn };
}

/** Without help nothing brings the hand to its bottle: which way to go next. */
export function wayTo({ ahead_m, left_m, goesIn }: Beside): TextKey {
  const aside_m = -goesIn * left_m;
  const there = ahead_m <= AT_M;
  const inLane = aside_m >= LANE_M[0] && aside_m <= (there ? AT_M : LANE_M[1]);
  if (inLane) return 'hint.forward';
  // In the row the hand would meet the bottle's side.
  if (ahead_m < IN_ROW_M && aside_m < -AT_M) return 'hint.back';
  return (aside_m < LANE_M[0]) === (goesIn > 0) ? 'hint.right' : 'hint.left';
}

export interface Asked {
  readonly now: PageState;
  readonly help: Help;
  readonly hint: HintLevel;
  readonly wrong: number;         // of wrongBottle()
  readonly oneButton: boolean;    // plays with a press, not with a camera or a robot
  readonly onItsWay: boolean;
  readonly outOfReach: boolean;
  readonly closing: boolean;      // the hand is asked to close, by a press that is held or one before
  readonly beside: Beside | null;
}

/** Title and sentence, one thing at a time. */
export function playWords(script: Script, state: WorldStateT, asked: Asked): Instruction {
  const { now, help, hint, wrong, oneButton, onItsWay, outOfReach, closing, beside } = asked;
  const said = instructionOf(script, state, wrong);
  if (outOfReach) return { ...said, title: 'game.tooFar', more: 'game.reachMore' };
  if (onItsWay) return { ...said, more: 'game.onItsWay' };
  if (said.title === 'game.wrong') return said;
  if (hint === 3) return { ...said, more: 'hint.shows' };
  if (now === 'reach' && help === 'none' && beside) return { ...said, more: wayTo(beside) };
  // Who is told to close the hand would press again, and end what one press began.
  if (now === 'squeeze' && help === 'full' && closing) return { ...said, more: 'game.closing' };
  if (hint > 0) return { ...said, more: hintOf(now, help) };
  return { ...said, more: said.title === 'game.reach' && help === 'full' && oneButton ? 'hint.press' : said.more };
}
