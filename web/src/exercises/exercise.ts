// The interface between the pages and an exercise. An exercise that only has a panel uses panel_play.ts; one with its own
// pictures and texts is a folder beside this file, listed in index.ts.
import type { WorldStateT } from '../protocol';
import type { ExercisePanel } from './panel';

/** World axes: x away from the person, y left, z up [m]. */
export interface Position { readonly x: number; readonly y: number; readonly z: number }

/** The grasp targets of an exercise, for the help that steers the hand. */
export interface GraspTargets {
  /** Index of the body in the scene, and the middle of the grip in the body's frame. */
  readonly grips: readonly { readonly body: number; readonly at_m: Position }[];
  /** Height of the surface that the targets stand on or hang over [m]; undefined where the exercise does not state it. */
  readonly counter_z_m: number | undefined;
  /** The current target, an index of `grips`; -1: none. */
  wanted(state: WorldStateT): number;
  /** Vector from a carried target to the place where it is squeezed [m]; undefined: it is squeezed where it is. */
  awayFromUse?(state: WorldStateT, grip: number): Position | undefined;
  /** The targets are on joints: one is moved straight along its joint while it is held, not lifted. */
  readonly onJoint?: boolean;
  /** Contact point of a target that the hand does not close around, in the body's frame, and the hand's device coordinates minus that point. */
  met?(state: WorldStateT, grip: number): { readonly at_m: Position; readonly base_m: Position; readonly pushes?: Position } | undefined;
  /** Whether another action follows after the release. */
  goesOn?(state: WorldStateT): boolean;
  /** Whether the hand must hold nothing now. */
  letGo(state: WorldStateT): boolean;
  /** Whether the grip must be eased and squeezed again later; undefined: never. */
  easesOff?(state: WorldStateT): boolean;
  /** The squeeze, and its range in which the target is held well; undefined: the grip force squeeze_n, squeeze_low_n and squeeze_high_n [N]. */
  zone?(state: WorldStateT): { readonly squeeze: number; readonly low: number; readonly high: number };
}

/** The phase of the person's task. */
export type Phase = 'reach' | 'squeeze' | 'hold' | 'ease' | 'letgo' | 'drawback' | 'free' | 'success';

/** The text of the strip. */
export interface Prompt {
  readonly title: string;
  readonly more: string;
  /** It takes precedence over every hint. */
  readonly urgent?: boolean;
  /** It takes precedence over every hint while the person moves; with full help the page may do the step. */
  readonly steady?: boolean;
}

export interface TaskStep {
  /** Key of the picture. */
  readonly key: string;
  readonly name: string;
  readonly is: 'done' | 'now' | 'later';
  readonly done: number;         // in the unit of `asked`
  readonly asked: number;
  readonly askedWords: string;   // "20 ml"
  readonly doneWords: string;    // "12 of 20 ml"
  picture(): SVGElement;
}

/** The card of a task with steps. */
export interface TaskCard { readonly label: string; readonly count: string; readonly title: string; readonly steps: readonly TaskStep[] }

export type Zone = 'none' | 'soft' | 'right' | 'strong' | 'stop' | 'wrong' | 'low' | 'high';

/** The meter of the squeeze. */
export interface Meter {
  readonly shown: boolean;
  readonly value: number;   // 0 .. 1 of the meter's length
  readonly low: number;     // begin and end of the zone "just right"
  readonly high: number;
  readonly zone: Zone;
  readonly label?: string;  // replaces "Your squeeze"
}

/** The text beside the goal's mark in the picture. */
export interface GoalWords { readonly amount: string; readonly more: string }

/** The praise after a part of the exercise, or all of it. */
export interface Praise {
  readonly lead: string;
  /** 0 .. 3; undefined where the exercise awards none. */
  readonly stars: number | undefined;
  readonly effort: string;
  readonly figures: readonly { readonly key: string; readonly label: string; readonly shown: string }[];
  readonly levelDone: boolean;
  /** Label of the button for the next part; empty where none follows. */
  readonly next: string;
}

/** The description of an exercise before it is played. */
export interface ExerciseWords {
  title(): string;
  lead(): string;
  /** Steps of the task as pictures and texts. @param skin colour of the hand */
  steps(skin: string): readonly { readonly picture: SVGElement; readonly title: string; readonly more: string }[];
  /** The name of a level; empty where levels have none. */
  levelName(level: number): string;
  /** The effect of one press with full help, and of pointing at a target; undefined: neither has one. */
  oneButton(): { readonly press: string; readonly point: string } | undefined;
}

/** A sequence of tones [Hz], and the time between them [s]. */
export interface Bells { readonly tones_hz: readonly number[]; readonly apart_s: number }

/** A sound of the game, or of the exercise. */
export type Chime = 'line' | 'step' | 'done' | Bells;

/** The sound of a flow: a thin stream, warm air, a soft tone, or wood that slides on wood. */
export type FlowSound = 'stream' | 'air' | 'tone' | 'slide';

/** Objects to hold that the page remembers: the proposed one (-1: none), and those that were held. */
export interface Marks { readonly proposed: number; readonly held: readonly boolean[] }

/** An exercise in the game. It is made for a scene and follows the states. */
export interface Play {
  readonly words: ExerciseWords;
  /** The panel, for an exercise without a card of its own. */
  readonly panel: ExercisePanel | null;
  /** Sounds of events, by the events' names. */
  readonly chimes: Readonly<Record<string, Chime>>;
  /** Processes a state; true when a part of the exercise begins. */
  follow(state: WorldStateT): boolean;
  phase(state: WorldStateT): Phase;
  /** Nothing of the present part is done yet. */
  atStart(state: WorldStateT): boolean;
  isPaused(state: WorldStateT): boolean;
  /** @param outOfReach the current target cannot be reached */
  prompt(state: WorldStateT, outOfReach: boolean): Prompt;
  /** The text after a part is done. */
  donePrompt(state: WorldStateT): Prompt;
  /** The title while the program plays; empty: the page uses its own. */
  watchedTitle(state: WorldStateT): string;
  /** Name of the current task; hints become stronger while it stays the same. Empty: there is none, or it is under way. */
  todo(state: WorldStateT): string;
  card(state: WorldStateT): TaskCard | null;
  meter(state: WorldStateT): Meter | null;
  goal(state: WorldStateT): GoalWords | null;
  /** @param ownGrip the person's own hand squeezed, not the page's help */
  praise(state: WorldStateT, ownGrip: boolean): Praise | null;
  /** The flow rate, the fill level of the vessel and the air that flows back, each 0 .. 1. */
  flow(state: WorldStateT): { readonly rate: number; readonly level: number; readonly air?: number; readonly sound?: FlowSound };
  /** A sound that no event of the program triggers; each is returned once. */
  takeChime?(): Chime | undefined;
  /** Marks that the picture shows in addition to the program's values. */
  marks?(): Marks;
}
