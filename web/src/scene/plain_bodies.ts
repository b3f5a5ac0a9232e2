// Draws bodies by their shapes and colours, where no exercise draws them.

import {
  BoxGeometry, BufferAttribute, BufferGeometry, CapsuleGeometry, Color, CylinderGeometry, Group, Mesh, SphereGeometry,
} from 'three';
import { ShapeType, type BodyT, type ShapeT } from '../protocol';
import { surface } from './materials';
import type { Quality } from './quality';

/** Geometry in the body's own frame, which is the program's: cylinders and capsules stand along z. */
function geometryOf(shape: ShapeT): BufferGeometry {
  const upright = (g: BufferGeometry) => g.rotateX(Math.PI / 2);
  switch (shape.type) {
    case ShapeType.Box: {
      const h = shape.halfExtentsM;
      return new BoxGeometry(2 * (h?.x ?? 0), 2 * (h?.y ?? 0), 2 * (h?.z ?? 0));
    }
    case ShapeType.Sphere: return new SphereGeometry(shape.radiusM, 48, 32);
    case ShapeType.Cylinder: return upright(new CylinderGeometry(shape.radiusM, shape.radiusM, shape.lengthM, 64));
    case ShapeType.Capsule: return upright(new CapsuleGeometry(shape.radiusM, shape.lengthM, 16, 40));
    default: {
      const points = new Float32Array(shape.pointsM.flatMap((p) => [p.x, p.y, p.z]));
      const geometry = new BufferGeometry();
      geometry.setAttribute('position', new BufferAttribute(points, 3));
      geometry.setIndex([...shape.triangles]);
      const facets = geometry.toNonIndexed();
      facets.computeVertexNormals();
      return facets;
    }
  }
}

/** One group per body, for a parent in the program's frame. */
export function makeBody(body: BodyT, quality: Quality): Group {
  const root = new Group();
  const material = surface(quality, { color: new Color(String(body.color ?? '') || '#b9a98f'), roughness: 0.5, clearcoat: 0.3, clearcoatRoughness: 0.3 });
  for (const shape of body.shapes) {
    const mesh = new Mesh(geometryOf(shape), material);
    const at = shape.inBody?.positionM, turn = shape.inBody?.orientationXyzw;
    if (at) mesh.position.set(at.x, at.y, at.z);
    if (turn) mesh.quaternion.set(turn.x, turn.y, turn.z, turn.w);
    mesh.castShadow = mesh.receiveShadow = true;
    root.add(mesh);
  }
  return root;
}
