// Where the picture is taken from: fixed, so that seen and felt directions agree.
//
// The camera stands to the left of the hand and somewhat above, where thumb, fingers, bottle and
// glass are seen at once. It is level, and turned only part of the way back; the rest is a shift of
// the picture in its plane, as architects photograph houses. So verticals stand upright, the row of
// dispensers is nearly level and of one size, and the hand's left and right are the picture's.

import { PerspectiveCamera, Vector3 } from 'three';

export type View = 'game' | 'console';

/** Of the designed picture, with the recipe card on its left and the strip at its bottom. */
const WIDTH_PX = 1280;
const HEIGHT_PX = 800;
const FIELD_RAD = 24.5 * Math.PI / 180;
/** Middle of the picture moved to the right, so that the card hides nothing [px of the designed picture]. */
const CARD_SHIFT_PX = 122;

/** Of the camera, left of the straight line through what it looks at, and above it. */
const AZIMUTH_RAD = -26 * Math.PI / 180;
const ELEVATION_RAD = 14 * Math.PI / 180;
/** How far it turns back. All of it would make the row slope, nothing of it would tilt the glass. */
const YAW_RAD = -17 * Math.PI / 180;
/** Away from the row of dispensers [m]. */
const DEPTH_M = 1.12;
/** What is in the middle: over the counter, and left of the device's middle, as grasps are [m]. */
const LOOK_HEIGHT_M = 0.177;
const LOOK_LEFT_M = 0.03;

/** Where the row of dispensers stands over the counter's top, three.js's frame [m]. */
export interface CameraPlace { readonly counter_y: number; readonly row_z: number }

export function placeCamera(camera: PerspectiveCamera, view: View, at: CameraPlace, width_px: number, height_px: number): void {
  const look = new Vector3(-LOOK_LEFT_M, at.counter_y + LOOK_HEIGHT_M, at.row_z);
  camera.position.set(look.x + DEPTH_M * Math.tan(AZIMUTH_RAD), look.y + DEPTH_M * Math.tan(ELEVATION_RAD), look.z + DEPTH_M);
  camera.rotation.set(0, YAW_RAD, 0);
  camera.aspect = width_px / Math.max(1, height_px);
  // A narrower picture than the designed one keeps the width, and with it the row.
  const half = Math.tan(FIELD_RAD / 2) * Math.max(1, WIDTH_PX / HEIGHT_PX / camera.aspect);
  camera.fov = 2 * Math.atan(half) * 180 / Math.PI;
  camera.near = 0.1;
  camera.far = 8;
  const card_px = view === 'game' ? CARD_SHIFT_PX * Math.min(width_px / WIDTH_PX, height_px / HEIGHT_PX) : 0;
  // Where it would see what it looks at, without the shift.
  camera.updateMatrixWorld(true);
  const seen = look.applyMatrix4(camera.matrixWorldInverse), focal_px = height_px / 2 / half;
  camera.setViewOffset(width_px, height_px, focal_px * seen.x / -seen.z - card_px, focal_px * -seen.y / -seen.z, width_px, height_px);
  camera.updateProjectionMatrix();
}
