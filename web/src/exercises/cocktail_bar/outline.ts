// The region of the bar that must be visible: every dispenser with its sign, wherever the row slides, the
// counter below it, and the glass.

import { Vector3 } from 'three';
import type { SceneT, WorldStateT } from '../../protocol';
import type { Bar } from './bar';
import { toThree } from '../../scene/frames';

/** Margin beside and above a dispenser's place on the rail for its sign [m]. */
const SIGN_ASIDE_M = 0.05;
const SIGN_OVER_M = 0.04;

/** Positions of the bottles, in three.js's frame [m]. */
export function bottlesOf(bar: Bar, scene: Pick<SceneT, 'bodies'>, state: Pick<WorldStateT, 'bodies'>): Vector3[] {
  const places = bar.dispensers.map(({ body }) => state.bodies[scene.bodies.findIndex((b) => String(b.name) === body)]?.positionM);
  return places.flatMap((at) => at ? [toThree(at)] : []);
}

/** Corners of the region, in three.js's frame [m]. */
export function outlineOf(bar: Bar, scene: Pick<SceneT, 'bodies'>, state: Pick<WorldStateT, 'bodies'>): Vector3[] {
  const places = bar.dispensers.map(({ body }) => state.bodies[scene.bodies.findIndex((b) => String(b.name) === body)]?.positionM);
  const first_y = places[0]?.y ?? 0, slides = (bar.row_y_m ?? [first_y]).map((y) => y - first_y);
  const glass = state.bodies[scene.bodies.findIndex((b) => String(b.name) === bar.glass.body)]?.positionM;
  const foot = glass ? [toThree({ x: glass.x - bar.glass.radius_m, y: glass.y, z: bar.counter_z_m })] : [];
  return [...foot, ...places.flatMap((at) => !at ? [] : slides.flatMap((by) => [by - SIGN_ASIDE_M, by + SIGN_ASIDE_M]).flatMap((aside) => [
    toThree({ x: at.x, y: at.y + aside, z: bar.rail_z_m + SIGN_OVER_M }),
    toThree({ x: at.x - bar.glass.radius_m, y: at.y + aside, z: bar.counter_z_m }),
  ]))];
}
