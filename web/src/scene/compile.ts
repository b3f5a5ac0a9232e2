// Compiles shader programs without blocking the page. Compiling may take seconds, and drawing with a program
// that is not compiled yet would block.

import type { Camera, Object3D, Scene, WebGLRenderer } from 'three';

const EVERY_MS = 10;

const later = (wait_ms: number): Promise<void> => new Promise((go) => { setTimeout(go, wait_ms); });

/** Resolves when the graphics card has finished all commands so far. */
async function cardIsDone(gl: WebGL2RenderingContext): Promise<void> {
  const fence = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
  if (!fence) return;
  gl.flush();
  do await later(EVERY_MS);
  while (!gl.isContextLost() && gl.getSyncParameter(fence, gl.SYNC_STATUS) !== gl.SIGNALED);
  gl.deleteSync(fence);
}

/** Prepares what `object` needs in the light of `scene`; resolves when it can be drawn at once. */
export async function compiled(renderer: WebGLRenderer, object: Object3D, camera: Camera, scene: Scene): Promise<void> {
  await later(0);   // building was enough work for one turn
  if (renderer.extensions.has('KHR_parallel_shader_compile')) await renderer.compileAsync(object, camera, scene);
  else {
    renderer.compile(object, camera, scene);
    await cardIsDone(renderer.getContext() as WebGL2RenderingContext);
  }
  // Reading a program's uniforms back blocks: one program at a time.
  for (const program of [...renderer.info.programs ?? []]) {
    if (program.program === undefined) continue;   // freed in the meantime
    program.getUniforms();
    program.getAttributes();
    await later(0);
  }
}
