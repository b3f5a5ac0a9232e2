// The 3D views of the exercises that have a folder here.
import type { ViewOf } from './exercise_view';

const VIEWS = Object.values(import.meta.glob<ViewOf>('./*/*_view.ts', { eager: true, import: 'viewOf' }));

/** The view of a scene's exercise; undefined where the bodies are drawn plainly. */
export const viewOf: ViewOf = (scene, quality) => {
  for (const of of VIEWS) {
    const view = of(scene, quality);
    if (view) return view;
  }
  return undefined;
};
