/** What a way of playing asks for at one moment. All ways speak this, and only this. */

export type Way = 'keys' | 'mouse' | 'touch' | 'gamepad' | 'webcam';

export const WAYS: readonly Way[] = ['keys', 'mouse', 'touch', 'gamepad', 'webcam'];

/** How much the page does for a person: reaching, gripping and letting go, the last bit of it, or nothing. */
export type Help = 'full' | 'some' | 'none';

export const HELPS: readonly Help[] = ['full', 'some', 'none'];

/** World axes of a translation: x away from the person, y left, z up [m or m/s]. */
export interface Triple {
  x: number;
  y: number;
  z: number;
}

export interface Wish {
  /** How fast the aim is to move [m/s]; 0 where nothing is asked. */
  velocity: Triple;
  /** Where the aim is to go, as a part of each axis's range, -1 .. 1; undefined: stay. */
  place: Partial<Triple>;
  /** true: close more and more while held; a number 0 .. 1: close this far. */
  squeeze: boolean | number;
  /** The target that the cursor is on, in the order of the grips; undefined: none, or no cursor. */
  pointed?: number;
  /** Thumb flexion on its own, 0 .. 1 (webcam); undefined: it goes with the squeeze. */
  thumb?: number;
}

/** Whether a squeeze is asked for. A camera's noise is not. */
export const asksToSqueeze = (squeeze: Wish['squeeze']): boolean => typeof squeeze === 'number' ? squeeze > 0.05 : squeeze;

export function restingWish(): Wish {
  return { velocity: { x: 0, y: 0, z: 0 }, place: {}, squeeze: false };
}

/** A way of playing: it listens while enabled, and says what is asked. */
export interface InputWay {
  readonly way: Way;
  /** When the person last used it on purpose [s, performance.now() / 1000]; -Infinity: never. */
  readonly claimed_s: number;
  enable(): void;
  disable(): void;
  /** Another way is used now: what was asked here is no longer meant. */
  yield(): void;
  wish(now_s: number): Wish;
  /**
   * The help took the hand elsewhere, to these parts of the ranges. Ways that add up differences go on
   * from there; a cursor, which is a place, does not care.
   */
  overruled?(places: Readonly<Partial<Triple>>): void;
}

export function now_s(): number {
  return performance.now() / 1000;
}
