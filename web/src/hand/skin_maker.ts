// Skins are made beside the page's thread: one takes a second, and the page goes on meanwhile.

import type { HandShape } from './shape';
import { skinMesh, type SkinMesh } from './skin_mesh';
import { startSkinWorker } from './start_skin_worker';

/** What skin_worker.ts is asked for; see skinMesh. */
export interface SkinOrder { readonly shape: HandShape; readonly poses: ArrayLike<number>; readonly step: number }

/** Skins made already, by hand and spacing: a new level or session brings the same hand again. */
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

/** As skinMesh, beside the page's thread where there is another; the same again for the same hand. */
export function madeSkin(shape: HandShape, poses: ArrayLike<number>, step: number): Promise<SkinMesh> {
  const key = JSON.stringify([shape.right, step, shape.capsules]);
  const mesh = made.get(key) ?? inWorker({ shape, poses, step }).catch(() => skinMesh(shape, poses, step));
  made.delete(key);
  made.set(key, mesh);
  if (made.size > MOST_KEPT) made.delete(made.keys().next().value ?? '');
  return mesh;
}
