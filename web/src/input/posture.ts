/**
 * What a squeeze means for the hand's axes. The numbers are those of the power grasp that the
 * physics holds (docs of the exercise): open while approaching, closed beyond the contact at about
 * 131° so that the virtual arm presses.
 */
const DEGREE = Math.PI / 180;

/** Where a hand axis goes while a squeeze grows from 0 to 1. */
interface HandAxisPosture {
  open_rad: number;
  closed_rad: number;
  /** Part of the squeeze in which this axis moves: the thumb comes round before it bends. */
  from: number;
  to: number;
}

const POSTURES: Readonly<Record<string, HandAxisPosture>> = {
  finger_flexion: { open_rad: 65 * DEGREE, closed_rad: 165 * DEGREE, from: 0, to: 1 },
  thumb_circumduction: { open_rad: 5 * DEGREE, closed_rad: 20 * DEGREE, from: 0, to: 0.3 },
  thumb_flexion: { open_rad: 0, closed_rad: 62 * DEGREE, from: 0.25, to: 1 },
};

/** True for axes that a squeeze moves. */
export function isHandAxis(name: string): boolean {
  return name in POSTURES;
}

/** Position of a hand axis [rad] at a squeeze of 0 (open) to 1 (as closed as can be asked). */
export function postureOf(name: string, squeeze: number): number {
  const posture = POSTURES[name];
  if (!posture) return 0;
  const part = clamp((squeeze - posture.from) / (posture.to - posture.from), 0, 1);
  return posture.open_rad + part * (posture.closed_rad - posture.open_rad);
}

/** The squeeze at which the fingers stand at `rad`; beyond the ends it is held. */
export function squeezeOfFingers(rad: number): number {
  const { open_rad, closed_rad } = POSTURES.finger_flexion!;
  return clamp((rad - open_rad) / (closed_rad - open_rad), 0, 1);
}

export function clamp(value: number, lower: number, upper: number): number {
  return Math.min(Math.max(value, lower), upper);
}

/** `value` moved towards `target` by no more than `step`. */
export function approach(value: number, target: number, step: number): number {
  return value + clamp(target - value, -step, step);
}
