// Every kind of material that a picture shows was prepared before the first picture: a program of the graphics card that is
// made while it draws blocks the page for seconds on a busy machine, and a page that is blocked is not heard.
// @vitest-environment happy-dom
import type { BufferGeometry, InstancedMesh, Material, Mesh, MeshLambertMaterial, Object3D, WebGLRenderer } from 'three';
import { afterEach, beforeEach, expect, it, vi } from 'vitest';
import { readMessage } from '../src/net/read_message';
import { SceneView } from '../src/scene/scene_view';
import { toldExercises } from './told_exercises';

/** What of a material and a shape chooses the program. */
function kindOf(material: Material, { attributes }: BufferGeometry, instanced: boolean): string {
  const { type, transparent, blending, side, vertexColors, alphaTest, toneMapped, defines, map, flatShading } = material as MeshLambertMaterial;
  return JSON.stringify([type, transparent, blending, side, alphaTest, toneMapped, defines, !!map, vertexColors && !!attributes.color, flatShading || !attributes.normal, instanced, material.customProgramCacheKey().length]);
}

function kindsOf(object: Object3D, shownOnly: boolean, found = new Set<string>()): Set<string> {
  if (shownOnly && !object.visible) return found;
  const { material, geometry } = object as Mesh;
  for (const each of [material ?? []].flat()) found.add(kindOf(each, geometry, (object as InstancedMesh).isInstancedMesh));
  for (const child of object.children) kindsOf(child, shownOnly, found);
  return found;
}

beforeEach(() => { vi.useFakeTimers(); vi.stubGlobal('matchMedia', () => ({ matches: false, addEventListener: () => {} })); });
afterEach(() => { vi.useRealTimers(); vi.unstubAllGlobals(); });

it.each(toldExercises().filter(({ right }) => right))('$name', async ({ messages }) => {
  const ready = new Set<string>(), nothing = (): void => {};
  let scene: SceneView;
  const renderer = {
    setClearColor: nothing, setPixelRatio: nothing, setSize: nothing, render: nothing, clear: nothing, dispose: nothing, copyFramebufferToTexture: nothing, initTexture: nothing, getContext: () => undefined,
    getDrawingBufferSize: (size: { set(x: number, y: number): unknown }) => size.set(4, 4),
    compileAsync: async (object: Object3D) => { kindsOf(object, false, ready); }, extensions: { has: () => true }, shadowMap: {}, info: { programs: [], memory: {}, render: {} },
  } as unknown as WebGLRenderer;
  scene = new SceneView(document.createElement('canvas'), { quality: 'low', tone: 'honey', view: 'game', renderer });
  const late = new Set<string>();
  for (const bytes of messages) {
    const message = readMessage(bytes);
    if (message.is === 'scene') scene.setScene(message.value);
    if (message.is === 'state') scene.setState(message.value);
    for (let i = 0; i < 20; i += 1) {
      await vi.advanceTimersByTimeAsync(50);
      scene.render(performance.now());
      if (scene.whole) for (const kind of kindsOf(scene.drawnTree, true)) if (!ready.has(kind)) late.add(kind);
    }
  }
  expect(ready.size).toBeGreaterThan(3);
  expect([...late]).toEqual([]);
});
