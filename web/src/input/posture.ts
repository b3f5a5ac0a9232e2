/**
 * Turns a squeeze into positions of the hand's axes. The values are those of the power grasp that the
 * simulation holds: open while approaching, closed beyond the contact at about 131°, so that the virtual
 * arm presses.
 */
const DEGREE = Math.PI / 180;

/** Positions of a hand axis while a squeeze grows from 0 to 1. */
interface HandAxisPosture {
  /** In front of the row, beside a target, and fully closed. */
  open_rad: number;
  stretched_rad: number;
  closed_rad: number;
}

/** The stretch for fingers that point sideways, at 100°, to pass behind a bar in front of a door. */
export const HOOKED = -35 / 57;

const POSTURES: Readonly<Record<string, HandAxisPosture>> = {
  finger_flexion: { open_rad: 65 * DEGREE, stretched_rad: 8 * DEGREE, closed_rad: 165 * DEGREE },
  thumb_circumduction: { open_rad: 20 * DEGREE, stretched_rad: 5 * DEGREE, closed_rad: 20 * DEGREE },
  thumb_flexion: { open_rad: 0, stretched_rad: 0, closed_rad: 61 * DEGREE },
};
/** The first part of a squeeze moves the hand around the target, the rest closes it. */
export const ROUND = 0.15;

/** Fingers and thumb may be aimed this far beyond the closed end of their range, because a firm grip closes beyond the object's compliance. The program accepts no more. */
const PAST_RANGE_RAD = 30 * DEGREE;
/** The firmest squeeze, for carried targets. */
export const FIRMEST = 1.38;

/** The closed end of an axis [rad]. */
export function closedEnd(name: string, upper: number): number {
  return name === 'finger_flexion' || name === 'thumb_flexion' ? upper + PAST_RANGE_RAD : upper;
}

/** Whether a squeeze moves this axis. */
export function isHandAxis(name: string): boolean {
  return name in POSTURES;
}

/**
 * Position of a hand axis [rad] at a squeeze of 0 (open) to 1 (fully closed).
 * @param stretch stretch of an open hand: 1 stretched, to enter beside a target, 0 half bent, HOOKED
 */
export function postureOf(name: string, squeeze: number, stretch = 0): number {
  const posture = POSTURES[name];
  if (!posture) return 0;
  const { open_rad, stretched_rad, closed_rad } = posture;
  const turns = name === 'thumb_circumduction';
  const open = turns ? stretched_rad : open_rad + clamp(stretch, HOOKED, 1) * (stretched_rad - open_rad);
  if (stretch < 0 && !turns) return Math.max(open, postureOf(name, squeeze));   // hooked fingers do not open before they close
  if (squeeze <= ROUND) return open + (clamp(squeeze, 0, ROUND) / ROUND) * (open_rad - open);
  return open_rad + ((clamp(squeeze, ROUND, FIRMEST) - ROUND) / (1 - ROUND)) * (closed_rad - open_rad);
}

/** The squeeze at which the fingers are at `rad`; constant beyond the ends. */
export function squeezeOfFingers(rad: number): number {
  const { open_rad, closed_rad } = POSTURES.finger_flexion;
  if (rad <= open_rad) return 0;
  return clamp(ROUND + ((1 - ROUND) * (rad - open_rad)) / (closed_rad - open_rad), 0, 1);
}

export function clamp(value: number, lower: number, upper: number): number {
  return Math.min(Math.max(value, lower), upper);
}

/** `value` moved towards `target` by no more than `step`. */
export function approach(value: number, target: number, step: number): number {
  return value + clamp(target - value, -step, step);
}
