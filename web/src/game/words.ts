// The text of the strip during play: the exercise's instruction, and the current hint.
import type { GraspTargets, Play, Prompt } from '../exercises/exercise';
import { GRIP_FROM_PALM } from '../input/perceiver';
import type { Help } from '../input/wish';
import type { WorldStateT } from '../protocol';
import { text, type TextKey } from '../shared/i18n';
import type { HintLevel } from './hints';
import { targetAndPalm } from './cues';
import type { PageState } from './page_state';

/** The palm's offset from the place where it would hold the target [m, world]. */
export interface PalmOffset {
  /** Remaining distance away from the person. */
  readonly ahead_m: number;
  /** Offset to the left of the target, as seen by the person; negative: to its right. */
  readonly left_m: number;
  /** The side of a target on which this hand enters: +1 its right (a right hand), -1 its left. */
  readonly goesIn: 1 | -1;
}

/** The hand is in the row when the target's axis is nearer than this ahead of it [m]. */
const IN_ROW_M = 0.115;
/** The hand is at the target within this [m]. */
const AT_M = 0.012;
/** Stretched fingers pass beside a target's axis between these distances [m], on the side of the hand. */
const LANE_M = [-0.004, 0.035] as const;

export function palmOffsetOf(targets: GraspTargets, right: boolean, state: WorldStateT, palmLink: number): PalmOffset | null {
  const both = targetAndPalm(targets, state, palmLink);
  if (!both) return null;
  const { target, palm } = both;
  const goesIn = right ? 1 : -1;
  return { ahead_m: target.x - palm.x - GRIP_FROM_PALM.x, left_m: palm.y + goesIn * GRIP_FROM_PALM.y - target.y, goesIn };
}

/** The next direction of movement, for a person without help. */
export function wayTo({ ahead_m, left_m, goesIn }: PalmOffset): TextKey {
  const aside_m = -goesIn * left_m;
  const there = ahead_m <= AT_M;
  const inLane = aside_m >= LANE_M[0] && aside_m <= (there ? AT_M : LANE_M[1]);
  if (inLane) return 'hint.forward';
  // Inside the row the hand would hit the target's side.
  if (ahead_m < IN_ROW_M && aside_m < -AT_M) return 'hint.back';
  return (aside_m < LANE_M[0]) === (goesIn > 0) ? 'hint.right' : 'hint.left';
}

/** The text of a hint beside the instruction. */
function hintOf(now: PageState): TextKey {
  if (now === 'reach') return 'hint.forward';
  if (now === 'squeeze') return 'hint.hold';
  return now === 'letgo' || now === 'ease' ? 'hint.open' : 'hint.back';
}

/** What the page does for the person in a phase, with full help: an instruction would ask for what is done already. */
function doneForYou(now: PageState, steady = false): TextKey | undefined {
  if (now === 'reach' || now === 'drawback') return 'game.onItsWay';
  if (now === 'squeeze') return 'game.closing';
  if (now === 'hold' && steady) return 'game.doesIt';
  return now === 'hold' || now === 'ease' || now === 'letgo' ? 'game.letsGo' : undefined;
}

/** What a press does in a phase in which full help waits for one. */
function askedPress(now: PageState): TextKey | undefined {
  return now === 'reach' ? 'hint.press' : now === 'squeeze' ? 'hint.again' : now === 'hold' || now === 'ease' ? 'hint.goOn' : undefined;
}

export interface PlayWordsInput {
  readonly now: PageState;
  readonly help: Help;
  readonly hint: HintLevel;
  readonly oneButton: boolean;    // plays with a press, not with a camera or a robot
  readonly onItsWay: boolean;
  readonly outOfReach: boolean;
  readonly closing: boolean;      // the hand is asked to close, by a held or an earlier press
  readonly acts?: boolean;        // with full help the page does the step
  readonly press?: string;        // the name of the press that is enough: "Space"
  readonly letGo?: string;        // how the person ends a squeeze
  readonly inVain?: string;       // how to squeeze, after a tap that had no effect
  readonly beside: PalmOffset | null;
}

/** Title and sentence, one instruction at a time. */
export function playWords(play: Play, state: WorldStateT, asked: PlayWordsInput): Prompt {
  const { now, help, hint, oneButton, onItsWay, outOfReach, closing, letGo, beside } = asked;
  const prompt = play.prompt(state, outOfReach);
  const hinted = (more: TextKey): Prompt => ({ ...prompt, more: text(more) });
  if (now === 'free' && asked.inVain) return { ...prompt, more: asked.inVain };
  if (outOfReach || now === 'free') return prompt;
  if (onItsWay) return hinted('game.onItsWay');
  if (prompt.urgent) return prompt;
  if (hint === 3) return hinted('hint.shows');
  if (help === 'full' && oneButton) {
    const key = asked.acts || (closing && now !== 'reach') ? doneForYou(now, prompt.steady) : askedPress(now);
    if (key) return { ...prompt, more: text(key, { x: asked.press || text('hint.pressOnce') }) };
  }
  if (prompt.steady) return prompt;
  if (now === 'reach' && help === 'none' && beside) return hinted(wayTo(beside));
  if ((now === 'letgo' || (now === 'ease' && hint > 0)) && closing && letGo) return { ...prompt, more: letGo };
  if (hint > 0) return hinted(hintOf(now));
  return prompt;
}
