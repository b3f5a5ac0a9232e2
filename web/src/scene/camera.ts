// Places the camera. It does not move, so that seen and felt directions agree.
//
// The camera stands beside the hand, on the thumb's side of its palm, and somewhat above, where thumb,
// fingers and the grasped object are visible together; a left hand has the mirror image. It is level, and turned
// only part of the way back; the rest is a shift of the picture in its plane, as in architectural
// photography. So verticals stay vertical, the row of targets is nearly level and of one size, and the
// hand's left and right are the picture's.

import { PerspectiveCamera, Vector3 } from 'three';
import { textZoom } from '../shared/zoom';

export type View = 'game' | 'console';

/** Size and field of the designed picture, with the exercise's card on its left and the strip at its bottom. */
const WIDTH_PX = 1280;
const HEIGHT_PX = 800;
const FIELD_RAD = 24.5 * Math.PI / 180;
const FOCAL_PX = HEIGHT_PX / 2 / Math.tan(FIELD_RAD / 2);
/** The position of the view's centre in the designed picture; in the game it is to the right of the card. */
const LOOK_PX = { game: { x: 762, y: 400 }, console: { x: 640, y: 400 } };
/** The console's picture has no cards: it is magnified as far as the objects stay inside. */
const CONSOLE_ZOOM = 1.35;
/** Margin between objects and the edge of the free part [designed px]. */
const MARGIN_PX = 14;

/** Direction of the camera as seen from the view's centre: sideways and up. */
const AZIMUTH_RAD = -26 * Math.PI / 180;
const ELEVATION_RAD = 14 * Math.PI / 180;
/** The camera's turn. A full turn would make the row slope, no turn would tilt verticals. The room turns with it: the counter's far edge is the picture's horizon. */
const YAW_RAD = -17 * Math.PI / 180;
/** Distance of the camera from the row [m]. */
const DEPTH_M = 1.12;
/** The view's centre: over the counter, and beside the device's middle, where grasps happen [m]. */
const LOOK_HEIGHT_M = 0.177;
const LOOK_ASIDE_M = 0.03;

/** The hand's side, the height of the counter's top, and the position of the row, in three.js's frame [m]. */
export interface CameraPlace { readonly right: boolean; readonly counter_y: number; readonly row_z: number }

/** The place if no exercise defines one [m]. */
export const DEFAULT_PLACE: CameraPlace = { right: true, counter_y: -0.253, row_z: -0.119 };

/** Turn of the camera, and of the room behind the row, about the vertical [rad]. */
export function turnOf(right: boolean): number { return right ? YAW_RAD : -YAW_RAD; }

interface FreeArea { readonly x: number; readonly y: number; readonly width: number; readonly height: number; readonly scale: number }

/** Least size of 1u, and of 1t on upright screens [px]. */
const LEAST_U_PX = 0.65;
const LEAST_T_PX = 0.6;
const isUpright = (width: number, height: number): boolean => width / height <= 1.1;

/** 1u of game.css by the window alone. */
const scaleOf = (width: number, height: number): number => isUpright(width, height) ? width / 740 : Math.min(width / WIDTH_PX, height / HEIGHT_PX);

/** 1u of game.css. */
export function unitOf(width: number, height: number): number {
  return isUpright(width, height) ? scaleOf(width, height) : Math.max(LEAST_U_PX, scaleOf(width, height));
}

/** 1t of game.css where the page is zoomed by `zoom`; undefined: it is not zoomed [px]. */
export function zoomedTextOf(width: number, height: number, zoom: number): number | undefined {
  const scale_px = scaleOf(width, height), grown = textZoom(scale_px, zoom, isUpright(width, height));
  return grown === 1 ? undefined : Math.max(unitOf(width, height), grown * scale_px);
}

/** Part of the picture that no card covers (game.css), and its scale relative to the designed one [px]. */
function freeOf(view: View, width: number, height: number, text_px: number | undefined): FreeArea {
  if (view === 'console') return { x: 0, y: 0, width, height, scale: CONSOLE_ZOOM * Math.min(width / WIDTH_PX, height / HEIGHT_PX) };
  const upright = isUpright(width, height), u = unitOf(width, height), zoomed = text_px !== undefined;
  const strip = zoomed ? 92 * text_px + 82 : upright ? Math.max(190 * u, 112 * Math.max(u, LEAST_T_PX) + 78) : Math.max(104 * u, 80);
  const [left, top] = zoomed ? [0, 66 * text_px] : upright ? [0, 256 * u] : [336 * u, 0];
  const free = { x: left, y: top, width: Math.max(40, width - left), height: Math.max(40, height - top - strip) };
  return { ...free, scale: Math.min(free.width / (WIDTH_PX - 336), free.height / (HEIGHT_PX - 104)) };
}

/** Position of the view's centre in this picture. */
function lookIn(view: View, free: FreeArea): { x: number; y: number } {
  const designed = freeOf(view, WIDTH_PX, HEIGHT_PX, undefined), at = LOOK_PX[view];
  return {
    x: free.x + free.width / 2 + (at.x - designed.x - designed.width / 2) * free.scale,
    y: free.y + free.height / 2 + (at.y - designed.y - designed.height / 2) * free.scale,
  };
}

/** Shift that moves a range into [from, to], as far as it fits. */
function into(low: number, high: number, from: number, to: number): number {
  return high - low > to - from ? (from + to - low - high) / 2 : Math.max(0, from - low) - Math.max(0, high - to);
}

/**
 * @param seen points that must be in the free part of the picture, three.js's frame [m]
 * @param text_px 1t of game.css where the page is zoomed
 */
export function placeCamera(camera: PerspectiveCamera, view: View, at: CameraPlace, seen: readonly Vector3[], width_px: number, height_px: number, text_px?: number): void {
  const side = at.right ? 1 : -1;
  const look = new Vector3(-side * LOOK_ASIDE_M, at.counter_y + LOOK_HEIGHT_M, at.row_z);
  camera.position.set(look.x + side * DEPTH_M * Math.tan(AZIMUTH_RAD), look.y + DEPTH_M * Math.tan(ELEVATION_RAD), look.z + DEPTH_M);
  camera.rotation.set(0, turnOf(at.right), 0);
  camera.updateMatrixWorld(true);
  const flat = (p: Vector3) => { const c = p.clone().applyMatrix4(camera.matrixWorldInverse); return { x: c.x / -c.z, y: c.y / c.z }; };   // y down
  const all = seen.map(flat), xs = all.map((p) => p.x), ys = all.map((p) => p.y);
  const free = freeOf(view, width_px, height_px, text_px), margin = MARGIN_PX * free.scale;
  const room = { x: free.width - 2 * margin, y: free.height - 2 * margin };
  const focal = all.length === 0 ? FOCAL_PX * free.scale
    : Math.min(FOCAL_PX * free.scale, room.x / (Math.max(...xs) - Math.min(...xs)), room.y / (Math.max(...ys) - Math.min(...ys)));
  const middle = flat(look), wanted = lookIn(view, free);
  const shift = { x: wanted.x - focal * middle.x, y: wanted.y - focal * middle.y };   // position of the camera's own axis in the picture
  if (all.length > 0) {
    shift.x += into(shift.x + focal * Math.min(...xs), shift.x + focal * Math.max(...xs), free.x + margin, free.x + margin + room.x);
    shift.y += into(shift.y + focal * Math.min(...ys), shift.y + focal * Math.max(...ys), free.y + margin, free.y + margin + room.y);
  }
  camera.aspect = width_px / Math.max(1, height_px);
  camera.fov = 2 * Math.atan(height_px / 2 / focal) * 180 / Math.PI;
  camera.near = 0.1;
  camera.far = 8;
  camera.setViewOffset(width_px, height_px, width_px / 2 - shift.x, height_px / 2 - shift.y, width_px, height_px);
  camera.updateProjectionMatrix();
}

/**
 * The point of the row's plane at a point of the picture, in the program's world (y left, z up) [m].
 * @param across, @param down as parts of the picture, 0 .. 1; null: no point there
 */
export function pointInRow(camera: PerspectiveCamera, row_z: number, across: number, down: number): { y_m: number; z_m: number } | null {
  if (!(across >= 0 && across <= 1 && down >= 0 && down <= 1)) return null;
  camera.updateMatrixWorld(true);
  const from = camera.position, way = new Vector3(2 * across - 1, 1 - 2 * down, 0.5).unproject(camera).sub(from);
  const far = (row_z - from.z) / way.z;
  return Number.isFinite(far) && far > 0 ? { y_m: -(from.x + far * way.x), z_m: from.y + far * way.y } : null;
}
