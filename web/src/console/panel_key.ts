import type { SceneT } from '../protocol';

/** A string that changes when a part of the scene changes that panels are built from. It is compared only. */
export function panelKey(scene: SceneT | null): string {
  if (!scene) return '';
  const { axes, parameters, exercises, hands, levels, level, exerciseName, exerciseJson, handName, rightHand, valueNames, eventNames } = scene;
  return JSON.stringify([axes, parameters, exercises, hands, levels, level, exerciseName, exerciseJson, handName, rightHand, valueNames, eventNames]);
}
