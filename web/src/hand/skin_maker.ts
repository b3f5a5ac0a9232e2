// Makes skins in a worker: one takes a second, and the page stays responsive.

import type { HandShape } from './shape';
import { skinMesh, type SkinMesh } from './skin_mesh';
import { startSkinWorker } from './start_skin_worker';

/** A request to skin_worker.ts; see skinMesh. */
export interface SkinOrder { readonly shape: HandShape; readonly poses: ArrayLike<number>; readonly step: number }

/** Finished skins by hand and spacing: a new level or session usually has the same hand. */
const made = new Map<string, Promise<SkinMesh>>();
const MOST_KEPT = 4;

function inWorker(order: SkinOrder): Promise<SkinMesh> {
  return new Promise((done, failed) => {
    const worker = startSkinWorker();
    worker.onmessage = ({ data }: MessageEvent<SkinMesh>) => {
      worker.terminate();
      done(data);
    };
    worker.onerror = (problem) => {
      worker.terminate();
      failed(new Error(problem.message));
    };
    worker.postMessage(order);
  });
}

/** The result of skinMesh, computed in a worker where possible; cached for the same hand. */
export function madeSkin(shape: HandShape, poses: ArrayLike<number>, step: number): Promise<SkinMesh> {
  const key = JSON.stringify([shape.right, step, shape.capsules]);
  const mesh = made.get(key) ?? inWorker({ shape, poses, step }).catch(() => skinMesh(shape, poses, step));
  made.delete(key);
  made.set(key, mesh);
  if (made.size > MOST_KEPT) made.delete(made.keys().next().value ?? '');
  return mesh;
}
