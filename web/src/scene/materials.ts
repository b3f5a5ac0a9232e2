// Makes materials: physically based in high quality, plain in low.

import {
  Color, LinearMipmapNearestFilter, MeshBasicMaterial, MeshLambertMaterial, MeshPhysicalMaterial, type Material,
  type MeshPhysicalMaterialParameters,
} from 'three';
import type { Quality } from './quality';

export type Finish = Pick<MeshPhysicalMaterialParameters,
  'color' | 'map' | 'roughness' | 'metalness' | 'clearcoat' | 'clearcoatRoughness' | 'sheen' | 'sheenRoughness'
  | 'sheenColor' | 'specularIntensity' | 'envMapIntensity' | 'side' | 'transparent' | 'opacity' | 'depthWrite'
  | 'emissive' | 'emissiveIntensity'>;

export function surface(quality: Quality, finish: Finish): Material {
  if (quality === 'high') {
    if (finish.map) finish.map.anisotropy = 8;
    return new MeshPhysicalMaterial(finish);
  }
  if (finish.map) finish.map.minFilter = LinearMipmapNearestFilter;
  const { color, map, side, transparent, opacity, depthWrite, emissive, emissiveIntensity } = finish;
  const plain = { color, map, side, transparent, opacity, depthWrite, emissive, emissiveIntensity };
  return new MeshLambertMaterial(Object.fromEntries(Object.entries(plain).filter(([, value]) => value !== undefined)));
}

/** A surface without shading: signs, lines. */
export function flat(color: string, more: ConstructorParameters<typeof MeshBasicMaterial>[0] = {}): MeshBasicMaterial {
  return new MeshBasicMaterial({ color: new Color(color), toneMapped: false, ...more });
}

/** Frees geometry, materials, textures, instances and shadow maps of everything below. */
export function disposeTree(root: { traverse(visit: (o: object) => void): void }): void {
  root.traverse((object) => {
    const { geometry, material } = object as { geometry?: { dispose(): void }; material?: Material | Material[] };
    geometry?.dispose();
    const { isLight, isInstancedMesh, dispose } = object as { isLight?: boolean; isInstancedMesh?: boolean; dispose?(): void };
    if (isLight || isInstancedMesh) dispose?.call(object);
    for (const m of material ? [material].flat() : []) {
      for (const value of Object.values(m)) if (value?.isTexture) value.dispose();
      m.dispose();
    }
  });
}
