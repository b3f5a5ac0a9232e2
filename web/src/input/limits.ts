import type { SceneT, WorldStateT } from '../protocol';

/** Allowed range of an axis of the device, by its name [m or rad]. */
export type Limits = Readonly<Record<string, readonly [lower: number, upper: number]>>;

interface Bound { axis: string; upper: boolean; of: (value: number) => number }

/** Live parameters that limit a person's arm and fingers (docs/profiles.md). */
const BOUNDS: Readonly<Record<string, Bound>> = {
  reach_left_m: { axis: 'y', upper: true, of: (v) => v },
  reach_right_m: { axis: 'y', upper: false, of: (v) => -v },
  reach_forward_m: { axis: 'x', upper: true, of: (v) => v },
  fingers_open_rad: { axis: 'finger_flexion', upper: false, of: (v) => v },
  fingers_close_rad: { axis: 'finger_flexion', upper: true, of: (v) => v },
};

/** The present limits; without an entry for an axis that the exercise does not limit. */
export function limitsOf(scene: SceneT, state: WorldStateT): Limits {
  const limits: Record<string, [number, number]> = {};
  scene.parameters.forEach(({ name }, i) => {
    const bound = BOUNDS[String(name)];
    const value = state.parameters[i];
    if (!bound || value === undefined) return;
    const range = (limits[bound.axis] ??= [-Infinity, Infinity]);
    range[bound.upper ? 1 : 0] = bound.of(value);
  });
  return limits;
}
