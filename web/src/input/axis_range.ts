import { clamp } from './posture';

/** Ends of an axis of the device [m or rad]. */
export interface AxisRange { readonly lower: number; readonly upper: number }

/** Relative position in an axis's range, -1 .. 1. */
export function partOfAxis(axis: AxisRange, q: number): number {
  return (2 * q - axis.lower - axis.upper) / (axis.upper - axis.lower);
}

/** Position at -1 .. 1 of an axis's range. */
export function placeOnAxis(axis: AxisRange, part: number): number {
  const middle = (axis.lower + axis.upper) / 2;
  return middle + (clamp(part, -1, 1) * (axis.upper - axis.lower)) / 2;
}
