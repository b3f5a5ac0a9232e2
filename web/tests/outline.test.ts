// Scenes that no exercise draws: the hand and the graspable bodies are inside the picture, on every screen.
import { PerspectiveCamera } from 'three';
import { describe, expect, it } from 'vitest';
import { DEFAULT_PLACE, placeCamera } from '../src/scene/camera';
import { toThree } from '../src/scene/frames';
import { outlineOfScene } from '../src/scene/outline';

const at = (x: number, y: number, z: number) => ({ positionM: { x, y, z } });
const shape = (more: object) => ({ radiusM: 0, lengthM: 0, halfExtentsM: null, inBody: null, pointsM: [], ...more });

/** config/scenes/free-grasping.toml with a table under it. */
const SCENE = {
  capsules: [{ link: 0 }, { link: 1 }, { link: 1 }],
  bodies: [
    { shapes: [shape({ halfExtentsM: { x: 0.025, y: 0.025, z: 0.025 } })] },
    { shapes: [shape({ radiusM: 0.03 })] },
    { shapes: [shape({ halfExtentsM: { x: 0.5, y: 0.8, z: 0.02 } })] },
  ],
} as never;
const STATE = { links: [at(0, -0.02, 0), at(0.1, 0, 0)], bodies: [at(0.12, -0.05, 0.19), at(0.12, 0.02, 0.19), at(0.2, 0, -1)] } as never;

describe('a scene that no exercise draws', () => {
  for (const view of ['game', 'console'] as const) {
    for (const [width, height] of [[1280, 800], [390, 844], [315, 140], [2560, 1080]]) {
      it(`is in the picture, ${view}, ${width} × ${height}`, () => {
        const camera = new PerspectiveCamera(), seen = outlineOfScene(SCENE, STATE);
        placeCamera(camera, view, DEFAULT_PLACE, seen, width, height);
        camera.updateMatrixWorld(true);
        // A box's corner, a ball's top, a finger: computed by hand from the scene.
        for (const p of [{ x: 0.145, y: -0.075, z: 0.215 }, { x: 0.12, y: 0.02, z: 0.22 }, { x: 0.14, y: 0.04, z: 0.04 }]) {
          const v = toThree(p).project(camera);
          expect(Math.abs(v.x)).toBeLessThan(1);
          expect(Math.abs(v.y)).toBeLessThan(1);
        }
      });
    }
  }

  it('does not shrink for a table, and is empty before its first state', () => {
    expect(outlineOfScene(SCENE, undefined)).toEqual([]);
    expect(Math.max(...outlineOfScene(SCENE, STATE).map((p) => Math.abs(p.y)))).toBeLessThan(0.25);
  });
});
