// Where the picture is taken from: fixed, so that seen and felt directions agree.

import { PerspectiveCamera, Vector3 } from 'three';

export type View = 'game' | 'console';

/** Of the designed picture: 1280 × 800, with the recipe card on the left. */
const ASPECT = 1.6;
const HEIGHT_PX = 800;
const FIELD_DEG = 26.5;
/** Picture moved to the right by this, so that the card hides nothing [units of height / 800]. */
const CARD_SHIFT = 122;

/** From the palm's side, so that thumb, fingers, bottle and glass are seen at once; left of the hand. */
export const AZIMUTH_RAD = -25 * Math.PI / 180;
const DISTANCE_M = 1.06;
const RISE_M = 0.33;
/** Looked at: over the counter, under the row of dispensers, towards the guest from it [m]. */
const LOOK_HEIGHT_M = 0.185;
const LOOK_NEARER_M = 0.03;
/** Middle of what the hand reaches with its grasp [m], to the left. */
const LOOK_LEFT_M = 0.03;

/** Where the row of dispensers stands in three.js's frame: over the counter's top. */
export interface CameraPlace { readonly counter_y: number; readonly row_z: number }

export function placeCamera(camera: PerspectiveCamera, view: View, at: CameraPlace, width_px: number, height_px: number): void {
  const aspect = width_px / Math.max(1, height_px);
  const look = new Vector3(-LOOK_LEFT_M, at.counter_y + LOOK_HEIGHT_M, at.row_z + LOOK_NEARER_M);
  camera.position.set(look.x + Math.sin(AZIMUTH_RAD) * DISTANCE_M, look.y + RISE_M, look.z + Math.cos(AZIMUTH_RAD) * DISTANCE_M);
  camera.lookAt(look);
  camera.aspect = aspect;
  // A narrower picture than the designed one keeps the width, and with it the whole row.
  const half = Math.tan(FIELD_DEG / 2 * Math.PI / 180) * Math.max(1, ASPECT / aspect);
  camera.fov = 2 * Math.atan(half) * 180 / Math.PI;
  camera.near = 0.1;
  camera.far = 8;
  if (view === 'game') camera.setViewOffset(width_px, height_px, -CARD_SHIFT * Math.min(height_px / HEIGHT_PX, width_px / 1280), 0, width_px, height_px);
  else camera.clearViewOffset();
  camera.updateProjectionMatrix();
  camera.updateMatrixWorld(true);
}
