// The hand in the picture: skin, nails, sleeve, and optionally the colliders.

import {
  BufferAttribute, BufferGeometry, CapsuleGeometry, Color, Group, Mesh, MeshBasicMaterial, MeshDepthMaterial,
  Quaternion, RGBADepthPacking, Vector3, type Material,
} from 'three';
import { HandPart } from '../protocol';
import { intoProgramFrame } from '../scene/frames';
import { disposeTree, surface } from '../scene/materials';
import type { Quality } from '../scene/quality';
import { fingertips, nailGeometry } from './nails';
import type { HandShape } from './shape';
import { MAX_GLOWS, makeSkin, poseSkin, setTone, skinUniforms, type SkinDetail, type SkinUniforms } from './skin_shader';
import type { SkinMesh } from './skin_mesh';
import { cuffGeometry, sleeveGeometry, type ClothResolution } from './sleeve';
import { toneOf } from './tones';
import { POSE_STRIDE } from './vector';

/** Grid spacing of the skin [m]. */
export const SKIN_STEP_M: Readonly<Record<Quality, number>> = { high: 1.5e-3, low: 3.0e-3 };
const DETAIL: Readonly<Record<Quality, SkinDetail>> = { high: 'fine', low: 'plain' };
const WEAVE: Readonly<Record<Quality, ClothResolution>> = { high: { around: 64, row_m: 0.007 }, low: { around: 24, row_m: 0.03 } };
/** Radius of the wrist's middle capsule in the median hand [m]; the cuff is sized for it. */
const MEDIAN_WRIST_M = 0.014;
const PART_COLOR: Readonly<Record<HandPart, string>> = {
  [HandPart.Palm]: '#CBBFAE', [HandPart.Index]: '#F6C636', [HandPart.Middle]: '#3B6FD1',
  [HandPart.Ring]: '#74D7BA', [HandPart.Little]: '#E8638A', [HandPart.Thumb]: '#FFB938',
};

export interface HandLook { readonly ghost: boolean; readonly colliders: boolean; readonly tone: string }

function skinGeometry(mesh: SkinMesh): BufferGeometry {
  const geometry = new BufferGeometry(), n = mesh.links.length;
  const near = (first: number) => {
    const out = new Uint8Array(n * 4);
    for (let v = 0; v < n; v++) for (let i = 0; i < 4; i++) out[4 * v + i] = mesh.neighbours[8 * v + first + i];
    return new BufferAttribute(out, 4);
  };
  geometry.setAttribute('position', new BufferAttribute(mesh.positions, 3));
  // three.js shades geometry without normals flat; the shader replaces these.
  geometry.setAttribute('normal', new BufferAttribute(new Float32Array(n * 3), 3));
  geometry.setAttribute('skinShading', new BufferAttribute(mesh.shading, 4));
  geometry.setAttribute('skinLink', new BufferAttribute(Float32Array.from(mesh.links), 1));
  geometry.setAttribute('skinNear0', near(0));
  geometry.setAttribute('skinNear1', near(4));
  geometry.setAttribute('skinPalmar', new BufferAttribute(mesh.palmar, 1));
  geometry.setIndex(new BufferAttribute(mesh.triangles, 1));
  return geometry;
}

export class HandView {
  readonly root = new Group();
  /** Poses of the hand, for other shaders too. */
  readonly uniforms: SkinUniforms;
  private readonly skin: Mesh;
  private readonly veil: Mesh;          // depth prepass of a ghost: surfaces behind its own front are not drawn
  private readonly links = new Map<number, Group>();
  private readonly colliders: Mesh[] = [];
  private readonly cloth: { mesh: Mesh; color: string }[] = [];
  private readonly solid: Material;
  private readonly ghost: Material;
  private readonly nail: Material & { color: Color };

  /** @param mesh the skin of `shape`, at SKIN_STEP_M */
  constructor(private readonly shape: HandShape, mesh: SkinMesh, private readonly quality: Quality) {
    this.uniforms = skinUniforms(shape);
    this.solid = makeSkin(surface(quality, { roughness: 0.62, sheen: 0.35, sheenRoughness: 0.5, sheenColor: new Color('#ffb59a'), specularIntensity: 0.42 }), shape, this.uniforms, DETAIL[quality]);
    this.ghost = makeSkin(surface(quality, { color: new Color('#f2ffff'), roughness: 0.9, transparent: true, opacity: 0.34 }), shape, this.uniforms, DETAIL[quality]);
    this.nail = surface(quality, { roughness: 0.3, clearcoat: 0.5, clearcoatRoughness: 0.3 }) as Material & { color: Color };
    const geometry = skinGeometry(mesh);
    this.skin = new Mesh(geometry, this.solid);
    this.skin.customDepthMaterial = makeSkin(new MeshDepthMaterial({ depthPacking: RGBADepthPacking }), shape, this.uniforms, 'place');
    this.skin.castShadow = this.skin.receiveShadow = true;
    this.veil = new Mesh(geometry, makeSkin(new MeshBasicMaterial({ colorWrite: false }), shape, this.uniforms, 'place'));
    this.veil.renderOrder = -1;
    // Vertices are in the frames of their links, so three.js cannot compute the bounds.
    this.skin.frustumCulled = this.veil.frustumCulled = false;
    intoProgramFrame(this.root);
    this.root.add(this.skin, this.veil);
    this.addNails();
    this.addSleeve();
  }

  get triangles(): number { return (this.skin.geometry.index?.count ?? 0) / 3; }

  pose(poses: ArrayLike<number>): void {
    poseSkin(this.uniforms, this.shape, poses);
    for (const [link, group] of this.links) {
      const o = link * POSE_STRIDE;
      group.position.set(poses[o], poses[o + 1], poses[o + 2]);
      group.quaternion.set(poses[o + 3], poses[o + 4], poses[o + 5], poses[o + 6]);
    }
  }

  /** Tints the skin around contacts. @param spots in the program's frame */
  tint(spots: readonly { point: { x: number; y: number; z: number }; radius_m: number }[]): void {
    for (let i = 0; i < MAX_GLOWS; i++) {
      const s = spots[i];
      this.uniforms.glow.value[i].set(s?.point.x ?? 0, s?.point.y ?? 0, s?.point.z ?? 0, s?.radius_m ?? 0);
    }
  }

  look({ ghost, colliders, tone }: HandLook): void {
    const skin = ghost ? toneOf('glove') : toneOf(tone);
    setTone(this.uniforms, skin);
    this.nail.color.set(skin.nail);
    this.nail.transparent = ghost;
    this.nail.opacity = ghost ? 0.2 : 1;
    this.skin.material = ghost ? this.ghost : this.solid;
    this.skin.visible = !colliders;
    this.skin.castShadow = !ghost;
    this.veil.visible = ghost && !colliders;
    for (const { mesh, color } of this.cloth) {
      const material = mesh.material as Material & { color: Color };
      material.color.set(ghost ? '#8fa3a3' : color);
      material.transparent = ghost;
      material.opacity = ghost ? 0.3 : 1;
      mesh.castShadow = !ghost;
    }
    if (colliders && this.colliders.length === 0) this.addColliders();
    for (const mesh of this.colliders) mesh.visible = colliders;
  }

  dispose(): void {
    disposeTree(this.root);
    for (const material of [this.solid, this.ghost, this.nail]) material.dispose();
  }

  private link(index: number): Group {
    const known = this.links.get(index);
    if (known) return known;
    const group = new Group();
    this.links.set(index, group);
    this.root.add(group);
    return group;
  }

  private addNails(): void {
    for (const tip of fingertips(this.shape)) {
      const mesh = new Mesh(nailGeometry(this.shape, tip), this.nail);
      mesh.receiveShadow = true;
      this.link(tip.link).add(mesh);
    }
  }

  private addSleeve(): void {
    const wrist = this.shape.capsules.find((c) => c.name === 'wrist_middle');
    const size = (wrist?.radius ?? MEDIAN_WRIST_M) / MEDIAN_WRIST_M;
    const sew = (geometry: BufferGeometry, color: string) => {
      const mesh = new Mesh(geometry, surface(this.quality, { color: new Color(color), roughness: 0.95, sheen: 0.45, sheenColor: new Color('#dfe6ea'), sheenRoughness: 0.6 }));
      mesh.castShadow = mesh.receiveShadow = true;
      mesh.scale.y = this.shape.right ? 1 : -1;   // radial is -y in a left palm
      this.link(this.shape.palmLink).add(mesh);
      this.cloth.push({ mesh, color });
    };
    sew(sleeveGeometry(size, WEAVE[this.quality]), '#3A4A57');
    sew(cuffGeometry(size, WEAVE[this.quality]), '#EFE7D8');
  }

  private addColliders(): void {
    for (const c of this.shape.capsules) {
      const a = new Vector3(...c.a), b = new Vector3(...c.b), axis = b.clone().sub(a);
      const mesh = new Mesh(new CapsuleGeometry(c.radius, axis.length(), 12, 28), surface(this.quality, { color: new Color(PART_COLOR[c.part]), roughness: 0.6 }));
      mesh.position.copy(a).lerp(b, 0.5);
      mesh.quaternion.copy(new Quaternion().setFromUnitVectors(new Vector3(0, 1, 0), axis.normalize()));
      mesh.castShadow = true;
      this.link(c.link).add(mesh);
      this.colliders.push(mesh);
    }
  }
}
