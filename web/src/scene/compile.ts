// Prepares what is drawn without blocking the page. Compiling may take seconds, and so may the commands that the graphics
// card has not carried out yet: a call that waits for them blocks the page, which is then not heard by the program.

import { Texture, type Camera, type Material, type Mesh, type Object3D, type Scene, type WebGLRenderer } from 'three';

const EVERY_MS = 10;
/** Pictures that may wait for the card; the browser blocks a page that is further ahead. */
const AHEAD = 2;

const later = (wait_ms: number): Promise<void> => new Promise((go) => { setTimeout(go, wait_ms); });

/** The commands that the card has not carried out yet. */
export class PendingCommands {
  private fences: WebGLSync[] = [];

  /** @param gl undefined: nothing is waited for */
  constructor(private readonly gl: WebGL2RenderingContext | undefined) {}

  /** The commands so far are one picture more. */
  add(): void {
    const { gl } = this, fence = gl?.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    if (!gl || !fence) return;
    this.fences.push(fence);
    gl.flush();
  }

  get count(): number {
    const { gl } = this;
    if (!gl || gl.isContextLost()) this.fences = [];
    else while (this.fences[0] && gl.getSyncParameter(this.fences[0], gl.SYNC_STATUS) === gl.SIGNALED) gl.deleteSync(this.fences.shift()!);
    return this.fences.length;
  }

  /** The card is so far behind that another picture would block the page. */
  get tooMany(): boolean { return this.count >= AHEAD; }
}

/** Resolves when the graphics card has finished all commands so far. */
async function cardIsDone(gl: WebGL2RenderingContext): Promise<void> {
  const pending = new PendingCommands(gl);
  pending.add();
  for (let wait_ms = 0; pending.count > 0; wait_ms = EVERY_MS) await later(wait_ms);
}

/** The pictures on the surfaces of `object`. */
function texturesOf(object: Object3D): Texture[] {
  const found = new Set<Texture>();
  object.traverse((each) => {
    for (const material of [(each as Mesh).material ?? []].flat() as Material[]) for (const value of Object.values(material)) if (value instanceof Texture && !value.isRenderTargetTexture && value.image) found.add(value);
  });
  return [...found];
}

/** Prepares what `object` needs in the light of `scene`; resolves when it can be drawn at once. */
export async function compiled(renderer: WebGLRenderer, object: Object3D, camera: Camera, scene: Scene): Promise<void> {
  await later(0);   // building was enough work for one turn
  const gl = renderer.getContext() as WebGL2RenderingContext;
  if (renderer.extensions.has('KHR_parallel_shader_compile')) await renderer.compileAsync(object, camera, scene);
  else renderer.compile(object, camera, scene);
  // Reading a program's uniforms back waits for all commands before, and pictures fill the card's queue: one at a time.
  for (const program of [...renderer.info.programs ?? []]) {
    await cardIsDone(gl);
    if (program.program === undefined) continue;   // freed in the meantime
    program.getUniforms();
    program.getAttributes();
  }
  for (const texture of texturesOf(object)) {
    await cardIsDone(gl);
    renderer.initTexture(texture);
  }
  await cardIsDone(gl);
}
