// The skin on the graphics card: each vertex moves with its link; its normal, folds and glow are computed from
// the posed capsules around it. addShading() in field.ts is the same sum in TypeScript.

import { Color, Vector3, Vector4, type IUniform, type Material } from 'three';
import { HandPart } from '../protocol';
import type { HandShape } from './shape';
import { NEIGHBOURS } from './skin_mesh';
import { POSE_STRIDE, toWorld } from './vector';

/** Maximum number of contacts that tint the skin at the same time. */
export const MAX_GLOWS = 10;

export interface SkinTone {
  readonly base: string; readonly palm: string; readonly fold: string; readonly nail: string;
}

export interface SkinUniforms {
  readonly [name: string]: IUniform;
  readonly linkTurn: IUniform<Vector4[]>;    // quaternion x, y, z, w of each link with capsules
  readonly linkAt: IUniform<Vector3[]>;      // [m]
  readonly capsuleA: IUniform<Vector4[]>;    // world [m]; w: radius of the skin, negative on the palm
  readonly capsuleB: IUniform<Vector4[]>;
  readonly glow: IUniform<Vector4[]>;        // world [m]; w: radius of the tint, 0: none
  readonly toneBase: IUniform<Color>;
  readonly tonePalm: IUniform<Color>;
  readonly toneFold: IUniform<Color>;
  readonly toneGlow: IUniform<Color>;
}

const list = <T>(n: number, make: () => T): T[] => Array.from({ length: n }, make);

export function skinUniforms(shape: HandShape): SkinUniforms {
  return {
    linkTurn: { value: list(shape.links.length, () => new Vector4(0, 0, 0, 1)) },
    linkAt: { value: list(shape.links.length, () => new Vector3()) },
    capsuleA: { value: list(shape.capsules.length, () => new Vector4()) },
    capsuleB: { value: list(shape.capsules.length, () => new Vector4()) },
    glow: { value: list(MAX_GLOWS, () => new Vector4()) },
    toneBase: { value: new Color() }, tonePalm: { value: new Color() },
    toneFold: { value: new Color() }, toneGlow: { value: new Color('#FFE9A8') },
  };
}

export function setTone(uniforms: SkinUniforms, tone: SkinTone): void {
  uniforms.toneBase.value.set(tone.base);
  uniforms.tonePalm.value.set(tone.palm);
  uniforms.toneFold.value.set(tone.fold);
}

/** Moves links and capsules to a posture. */
export function poseSkin(uniforms: SkinUniforms, shape: HandShape, poses: ArrayLike<number>): void {
  shape.links.forEach((link, slot) => {
    const o = link * POSE_STRIDE;
    uniforms.linkAt.value[slot].set(poses[o], poses[o + 1], poses[o + 2]);
    uniforms.linkTurn.value[slot].set(poses[o + 3], poses[o + 4], poses[o + 5], poses[o + 6]);
  });
  shape.capsules.forEach((c, i) => {
    const a = toWorld(poses, c.link, c.a), b = toWorld(poses, c.link, c.b);
    uniforms.capsuleA.value[i].set(a[0], a[1], a[2], c.part === HandPart.Palm ? -c.skinA : c.skinA);
    uniforms.capsuleB.value[i].set(b[0], b[1], b[2], c.skinB);
  });
}

function declarations(shape: HandShape): string {
  const width = (part: boolean) =>
    (shape.capsules.find((c) => (c.part === HandPart.Palm) === part)?.shading ?? 1e-3).toFixed(6);
  return `
attribute float skinLink;
uniform vec4 linkTurn[${shape.links.length}];
uniform vec3 linkAt[${shape.links.length}];
vec3 turnBy(vec4 q, vec3 v) { return v + 2.0 * cross(q.xyz, cross(q.xyz, v) + q.w * v); }
#ifdef SKIN_SHADED
attribute vec4 skinShading;
attribute vec4 skinNear0;
#ifdef SKIN_FINE
attribute vec4 skinNear1;
#endif
attribute float skinPalmar;
uniform vec4 capsuleA[${shape.capsules.length}];
uniform vec4 capsuleB[${shape.capsules.length}];
uniform vec4 glow[${MAX_GLOWS}];
uniform vec3 toneBase, tonePalm, toneFold, toneGlow;
varying vec3 skinTint;
void addShading(inout vec4 sum, float which, vec3 p) {
  int i = int(which + 0.5);
  if (i >= ${shape.capsules.length}) return;
  vec4 a = capsuleA[i], b = capsuleB[i];
  vec3 ab = b.xyz - a.xyz, ap = p - a.xyz;
  float h = clamp(dot(ap, ab) / max(dot(ab, ab), 1e-12), 0.0, 1.0);
  vec3 d = ap - ab * h;
  float l = max(length(d), 1e-9);
  float wide = a.w < 0.0 ? ${width(true)} : ${width(false)};
  float w = exp(-(l - mix(abs(a.w), b.w, h)) / wide);
  sum += vec4(d * (w / l), w);
}
#endif
`;
}

const POINT = `
int skinSlot = int(skinLink + 0.5);
vec3 skinPoint = turnBy(linkTurn[skinSlot], position) + linkAt[skinSlot];
`;

const NORMAL = `
vec4 skinSum = vec4(turnBy(linkTurn[skinSlot], skinShading.xyz), skinShading.w);
for (int i = 0; i < 4; i++) addShading(skinSum, skinNear0[i], skinPoint);
#ifdef SKIN_FINE
for (int i = 0; i < 4; i++) addShading(skinSum, skinNear1[i], skinPoint);
#endif
vec3 objectNormal = normalize(skinSum.xyz);
`;

// Warmer where the capsules' directions differ (folds); lighter on the palm's side.
const TINT = `
float skinFold = smoothstep(0.12, 0.6, 1.0 - length(skinSum.xyz) / skinSum.w);
vec3 skinColor = mix(toneBase, tonePalm, clamp(skinPalmar * 0.8 + 0.15, 0.0, 1.0) * 0.7);
skinColor = mix(skinColor, toneFold, skinFold * 0.72);
for (int i = 0; i < ${MAX_GLOWS}; i++) {
  float near = glow[i].w > 0.0 ? max(0.0, 1.0 - distance(skinPoint, glow[i].xyz) / glow[i].w) : 0.0;
  skinColor = mix(skinColor, toneGlow, near * near * 0.95);
}
skinTint = skinColor;
`;

/** The shader source of the skin's position, for a test that reads positions back from the graphics card. */
export function placeSource(shape: HandShape): { declarations: string; point: string } {
  return { declarations: declarations(shape), point: POINT };
}

/** The part of the skin that a material draws: its position only (shadows), or shading with four or all neighbours. */
export type SkinDetail = 'place' | 'plain' | 'fine';

/** Makes a three.js material draw the skin. */
export function makeSkin<M extends Material>(material: M, shape: HandShape, uniforms: SkinUniforms, detail: SkinDetail): M {
  if (NEIGHBOURS !== 8) throw new Error('the shader reads eight neighbours');
  material.onBeforeCompile = (shader) => {
    Object.assign(shader.uniforms, uniforms);
    const defines = { place: '', plain: '#define SKIN_SHADED\n', fine: '#define SKIN_SHADED\n#define SKIN_FINE\n' };
    shader.vertexShader = defines[detail] + shader.vertexShader
      .replace('#include <common>', `#include <common>\n${declarations(shape)}`)
      .replace('void main() {', `void main() {\n${POINT}`)
      .replace('#include <begin_vertex>', 'vec3 transformed = skinPoint;');
    if (detail === 'place') return;
    shader.vertexShader = shader.vertexShader.replace('#include <beginnormal_vertex>', NORMAL + TINT);
    shader.fragmentShader = shader.fragmentShader
      .replace('#include <common>', '#include <common>\nvarying vec3 skinTint;')
      .replace('#include <color_fragment>', 'diffuseColor.rgb *= skinTint;');
  };
  material.customProgramCacheKey = () => `skin ${detail} ${shape.links.length} ${shape.capsules.length}`;
  return material;
}
