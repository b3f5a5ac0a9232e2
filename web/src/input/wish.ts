/** The request of an input method at one moment: the only interface between input methods and aiming. */

export type Way = 'keys' | 'mouse' | 'touch' | 'gamepad' | 'webcam';

export const WAYS: readonly Way[] = ['keys', 'mouse', 'touch', 'gamepad', 'webcam'];

/** Degree of help: with reaching, gripping and letting go; with the last part of it; or none. */
export type Help = 'full' | 'some' | 'none';

export const HELPS: readonly Help[] = ['full', 'some', 'none'];

/** World axes of a translation: x away from the person, y left, z up [m or m/s]. */
export interface Triple {
  x: number;
  y: number;
  z: number;
}

export interface Wish {
  /** Requested velocity of the aim [m/s]; 0: none. */
  velocity: Triple;
  /** Requested place of the aim, relative to each axis's range, -1 .. 1; undefined: stay. */
  place: Partial<Triple>;
  /** true: close further while held; a number 0 .. 1: close to this degree. */
  squeeze: boolean | number;
  /** The target under the cursor, an index of the grips; undefined: none, or no cursor. */
  pointed?: number;
  /** Thumb flexion of its own, 0 .. 1 (webcam); undefined: it follows the squeeze. */
  thumb?: number;
}

/** Whether a squeeze is requested; noise of a camera does not count. */
export const asksToSqueeze = (squeeze: Wish['squeeze']): boolean => typeof squeeze === 'number' ? squeeze > 0.05 : squeeze;

export function restingWish(): Wish {
  return { velocity: { x: 0, y: 0, z: 0 }, place: {}, squeeze: false };
}

/** An input method: it listens while enabled, and returns its wish. */
export interface InputWay {
  readonly way: Way;
  /** Time of the person's last deliberate use [s, performance.now() / 1000]; -Infinity: never. */
  readonly claimed_s: number;
  enable(): void;
  disable(): void;
  /** Another input method is used now: cancels the requests of this one. */
  yield(): void;
  wish(now_s: number): Wish;
  /**
   * The help moved the hand to these parts of the ranges. Methods that accumulate differences continue
   * from there; a cursor is an absolute place, and ignores this.
   */
  overruled?(places: Readonly<Partial<Triple>>): void;
}

export function now_s(): number {
  return performance.now() / 1000;
}
