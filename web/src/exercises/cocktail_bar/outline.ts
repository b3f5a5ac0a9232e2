// The region of the bar that must be visible: every dispenser with its sign, wherever the row slides, the
// counter below it, and the glass.

import { Vector3 } from 'three';
import type { SceneT, WorldStateT } from '../../protocol';
import type { Bar } from './bar';
import { toThree, type Triple } from '../../scene/frames';

/** Margin beside and above a dispenser's place on the rail for its sign [m]. */
const SIGN_ASIDE_M = 0.05;
const SIGN_OVER_M = 0.04;

/** Where the bottles hang or stand before anything moves [m]; in old recordings, where they are. */
function homesOf(bar: Bar, scene: Pick<SceneT, 'bodies'>, state: Pick<WorldStateT, 'bodies'>): Triple[] {
  return bar.dispensers.flatMap(({ body, home_m }) => {
    const at = home_m ? { x: home_m[0], y: home_m[1], z: home_m[2] } : state.bodies[scene.bodies.findIndex((b) => String(b.name) === body)]?.positionM;
    return at ? [at] : [];
  });
}

/** The same, in three.js's frame. */
export const bottlesOf = (bar: Bar, scene: Pick<SceneT, 'bodies'>, state: Pick<WorldStateT, 'bodies'>): Vector3[] => homesOf(bar, scene, state).map((at) => toThree(at));

/** Corners of the region, in three.js's frame [m]. */
export function outlineOf(bar: Bar, scene: Pick<SceneT, 'bodies'>, state: Pick<WorldStateT, 'bodies'>): Vector3[] {
  const places = homesOf(bar, scene, state);
  const first_y = places[0]?.y ?? 0, slides = (bar.row_y_m ?? [first_y]).map((y) => y - first_y);
  const glass = state.bodies[scene.bodies.findIndex((b) => String(b.name) === bar.glass.body)]?.positionM;
  const foot = glass ? [toThree({ x: glass.x - bar.glass.radius_m, y: glass.y, z: bar.counter_z_m })] : [];
  return [...foot, ...places.flatMap((at) => slides.flatMap((by) => [by - SIGN_ASIDE_M, by + SIGN_ASIDE_M]).flatMap((aside) => [
    toThree({ x: at.x, y: at.y + aside, z: bar.rail_z_m + SIGN_OVER_M }),
    toThree({ x: at.x - bar.glass.radius_m, y: at.y + aside, z: bar.counter_z_m }),
  ]))];
}
