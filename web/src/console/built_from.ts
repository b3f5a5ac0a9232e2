import type { SceneT } from '../protocol';

/** The parts of a scene that panels are built from. */
export function builtFrom(scene: SceneT | null): string {
  if (!scene) return '';
  const { axes, parameters, exercises, hands, levels, level, exerciseName, exerciseJson, handName, rightHand, valueNames, eventNames } = scene;
  return JSON.stringify([axes, parameters, exercises, hands, levels, level, exerciseName, exerciseJson, handName, rightHand, valueNames, eventNames]);
}
