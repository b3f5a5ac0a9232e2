import { clamp } from './posture';

/** A point of a tracked hand. Image: x right, y down, 0 .. 1; world: metres. */
export interface Landmark {
  x: number;
  y: number;
  z: number;
}

/** Measures of a hand in a picture, in the picture's coordinates. */
export interface HandReading {
  /** Middle of the palm in the picture, 0 .. 1, x to the picture's right, y down. */
  palmX: number;
  palmY: number;
  /** Length of the palm relative to the picture's height: larger is nearer to the camera. */
  palmSize: number;
  /** Mean over four fingers of the sum of the three joint angles [rad]: about 0 flat, 4 a fist. */
  fingers_rad: number;
  /** Sum of the thumb's two outer joint angles [rad]. */
  thumb_rad: number;
}

const WRIST = 0;
const PALM = [0, 5, 9, 13, 17];
const FINGERS = [5, 9, 13, 17];
const MIDDLE_KNUCKLE = 9;

/** Angle between two directions of a chain of points, 0 for a straight chain [rad]. */
export function bend(a: Landmark, b: Landmark, c: Landmark): number {
  const u = [b.x - a.x, b.y - a.y, b.z - a.z] as const;
  const v = [c.x - b.x, c.y - b.y, c.z - b.z] as const;
  const lengths = Math.hypot(...u) * Math.hypot(...v);
  if (!(lengths > 0)) return 0;
  return Math.acos(clamp((u[0] * v[0] + u[1] * v[1] + u[2] * v[2]) / lengths, -1, 1));
}

/**
 * Reads the 21 landmarks of a hand (wrist; thumb, index, middle, ring, little: four each, from the
 * palm outwards). `world` in metres gives angles that do not depend on the view.
 */
export function readHand(
  image: readonly Landmark[], world: readonly Landmark[], aspect: number,
): HandReading | undefined {
  if (image.length < 21 || world.length < 21) return undefined;
  const at = (points: readonly Landmark[], i: number): Landmark => points[i]!;
  const mean = (key: 'x' | 'y'): number =>
    PALM.reduce((sum, i) => sum + at(image, i)[key], 0) / PALM.length;
  const wrist = at(image, WRIST);
  const knuckle = at(image, MIDDLE_KNUCKLE);
  const finger = (base: number): number => {
    const chain = [WRIST, base, base + 1, base + 2, base + 3].map((i) => at(world, i));
    return [0, 1, 2].reduce((s, k) => s + bend(chain[k]!, chain[k + 1]!, chain[k + 2]!), 0);
  };
  return {
    palmX: mean('x'),
    palmY: mean('y'),
    palmSize: Math.hypot((knuckle.x - wrist.x) * aspect, knuckle.y - wrist.y),
    fingers_rad: FINGERS.reduce((sum, base) => sum + finger(base), 0) / FINGERS.length,
    thumb_rad:
      bend(at(world, 1), at(world, 2), at(world, 3)) +
      bend(at(world, 2), at(world, 3), at(world, 4)),
  };
}

/** Typical measures of a relaxed open hand and of a firm fist in a camera's picture [rad]. */
const OPEN_RAD = 0.9;
const FIST_RAD = 3.4;
const THUMB_OPEN_RAD = 0.25;
const THUMB_BENT_RAD = 1.2;

/** Degree to which the fingers are closed, 0 .. 1. */
export function curl(reading: HandReading): number {
  return clamp((reading.fingers_rad - OPEN_RAD) / (FIST_RAD - OPEN_RAD), 0, 1);
}

/** Degree to which the thumb is bent, 0 .. 1. */
export function thumbCurl(reading: HandReading): number {
  return clamp((reading.thumb_rad - THUMB_OPEN_RAD) / (THUMB_BENT_RAD - THUMB_OPEN_RAD), 0, 1);
}

/** The part of the picture that corresponds to the workspace. */
const PLAY_PART = 0.6;

/**
 * Position of the hand in the workspace, each -1 .. 1: x away from the person, y left, z up. The
 * camera faces the person: a hand that moves to the person's left moves to the picture's right, and
 * one that moves away from the person comes nearer to the camera and grows from `restSize`.
 */
export function place(reading: HandReading, restSize: number): { x: number; y: number; z: number } {
  const nearer = restSize > 0 ? Math.log(reading.palmSize / restSize) : 0;
  return {
    x: clamp(nearer / Math.log(1.6), -1, 1),
    y: clamp((reading.palmX - 0.5) / (PLAY_PART / 2), -1, 1),
    z: clamp((0.5 - reading.palmY) / (PLAY_PART / 2), -1, 1),
  };
}
