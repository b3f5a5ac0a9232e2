// A worker that makes one skin and ends. See skin_maker.ts.

import { skinMesh } from './skin_mesh';
import type { SkinOrder } from './skin_maker';

addEventListener('message', ({ data }: MessageEvent<SkinOrder>) => {
  const mesh = skinMesh(data.shape, data.poses, data.step);
  postMessage(mesh, { transfer: Object.values(mesh).map((array: Float32Array) => array.buffer) });
});
