// What the pages ask of an exercise. An exercise that only has a panel answers with panel_play.ts; one that is shown
// with pictures and words of its own is a folder beside this file, which index.ts names.
import type { WorldStateT } from '../protocol';
import type { ExercisePanel } from './panel';

/** World axes: x away from the person, y left, z up [m]. */
export interface Position { readonly x: number; readonly y: number; readonly z: number }

/** What may be grasped, for the help that steers the hand. */
export interface GraspTargets {
  /** Index of the body in the scene, and the middle of the grip in the body's frame. */
  readonly grips: readonly { readonly body: number; readonly at_m: Position }[];
  /** Height of what the targets stand on or hang over [m]; undefined where the exercise does not say. */
  readonly counter_z_m: number | undefined;
  /** The target that is asked for, an index of `grips`; -1: none. */
  wanted(state: WorldStateT): number;
  /** How far a target that is carried is from where it is squeezed [m]; undefined: it is squeezed where it is. */
  awayFromUse?(state: WorldStateT, grip: number): Position | undefined;
  /** They are on joints: one is led straight to its use while it is held, not lifted. */
  readonly onJoint?: boolean;
  /** How one is met where the hand does not just close around it: the point, in the body's frame, and the hand's device coordinates less it. */
  met?(state: WorldStateT, grip: number): { readonly at_m: Position; readonly base_m: Position; readonly pushes?: Position } | undefined;
  /** Whether there is more to do once it was let go of. */
  goesOn?(state: WorldStateT): boolean;
  /** Whether nothing is to be held now. */
  letGo(state: WorldStateT): boolean;
  /** Whether what is held is to be eased, and squeezed again after it; undefined: never. */
  easesOff?(state: WorldStateT): boolean;
  /** Between which forces the target is held well [N]; undefined: the values squeeze_low_n and squeeze_high_n say so. */
  zone?(state: WorldStateT): { readonly low_n: number; readonly high_n: number };
}

/** Where the person is in the task. */
export type Phase = 'reach' | 'squeeze' | 'hold' | 'ease' | 'letgo' | 'drawback' | 'free' | 'success';

/** What the strip says. */
export interface Prompt {
  readonly title: string;
  readonly more: string;
  /** It comes before every hint. */
  readonly urgent?: boolean;
}

export interface TaskStep {
  /** Names the picture. */
  readonly key: string;
  readonly name: string;
  readonly is: 'done' | 'now' | 'later';
  readonly done: number;         // of `asked`, in the same unit
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
  readonly low: number;     // where "just right" begins and ends
  readonly high: number;
  readonly zone: Zone;
  readonly label?: string;  // another one than "Your squeeze"
}

/** The words beside the mark of the goal in the picture. */
export interface GoalWords { readonly amount: string; readonly more: string }

/** What is said when a part of the exercise, or all of it, is done. */
export interface Praise {
  readonly lead: string;
  /** 0 .. 3; undefined where the exercise gives none. */
  readonly stars: number | undefined;
  readonly effort: string;
  readonly figures: readonly { readonly key: string; readonly label: string; readonly shown: string }[];
  readonly levelDone: boolean;
  /** The button for the next part, where one follows. */
  readonly next: string;
}

/** What is said of an exercise before it is played. */
export interface ExerciseWords {
  title(): string;
  lead(): string;
  /** Pictures and words of what to do. @param skin colour of the hand */
  steps(skin: string): readonly { readonly picture: SVGElement; readonly title: string; readonly more: string }[];
  /** Empty where levels have no names. */
  levelName(level: number): string;
  /** What one press does with full help, and what pointing at a target does; undefined: nothing of the kind. */
  oneButton(): { readonly press: string; readonly point: string } | undefined;
}

/** Tones one after the other [Hz], and how far apart [s]. */
export interface Bells { readonly tones_hz: readonly number[]; readonly apart_s: number }

/** One of the game's own, or the exercise's. */
export type Chime = 'line' | 'step' | 'done' | Bells;

/** What a flow sounds like: a thin stream, warm air, a soft tone, wood that slides on wood. */
export type FlowSound = 'stream' | 'air' | 'tone' | 'slide';

/** What the page remembers of things that the person is to hold: which is proposed (-1: none), and which were held. */
export interface Marks { readonly proposed: number; readonly held: readonly boolean[] }

/** An exercise in the game. Made for a scene; follows the states. */
export interface Play {
  readonly words: ExerciseWords;
  /** Shown where the exercise has no card of its own. */
  readonly panel: ExercisePanel | null;
  /** What events sound like, by their names. */
  readonly chimes: Readonly<Record<string, Chime>>;
  /** Takes a state; true where a part of the exercise begins. */
  follow(state: WorldStateT): boolean;
  phase(state: WorldStateT): Phase;
  isPaused(state: WorldStateT): boolean;
  /** @param outOfReach what is asked for cannot be reached */
  prompt(state: WorldStateT, outOfReach: boolean): Prompt;
  /** What is said when a part is done. */
  donePrompt(state: WorldStateT): Prompt;
  /** The title while the program plays; empty: the page has its own. */
  watchedTitle(state: WorldStateT): string;
  /** Names what the person has to do; hints rise while it stays. Empty: nothing, or it is being done. */
  todo(state: WorldStateT): string;
  card(state: WorldStateT): TaskCard | null;
  meter(state: WorldStateT): Meter | null;
  goal(state: WorldStateT): GoalWords | null;
  /** @param ownGrip the person's own hand squeezed, not the page's help */
  praise(state: WorldStateT, ownGrip: boolean): Praise | null;
  /** What flows, how full it makes what it flows into, and the air that flows back, each 0 .. 1. */
  flow(state: WorldStateT): { readonly rate: number; readonly level: number; readonly air?: number; readonly sound?: FlowSound };
  /** What is to be heard though the program reports no event; once. */
  heard?(): Chime | undefined;
  /** What the picture is to show beside the program's values. */
  marks?(): Marks;
}
