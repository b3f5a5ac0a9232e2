// Reads the positions of the skin's vertices back from the graphics card, and compares them with the colliders:
// the shader's own source, run with transform feedback. Part of scene_page (?check).

import { capsuleDistance } from '../src/hand/field';
import { handShape, linkPoses } from '../src/hand/shape';
import { placeSource } from '../src/hand/skin_shader';
import { skinMesh } from '../src/hand/skin_mesh';
import { POSE_STRIDE, toWorld, type Vec } from '../src/hand/vector';
import type { SceneT, WorldStateT } from '../src/protocol';

function program(gl: WebGL2RenderingContext, vertex: string): WebGLProgram {
  const out = gl.createProgram()!;
  for (const [type, source] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, '#version 300 es\nvoid main() {}']] as const) {
    const shader = gl.createShader(type)!;
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader) ?? '');
    gl.attachShader(out, shader);
  }
  gl.transformFeedbackVaryings(out, ['placed'], gl.SEPARATE_ATTRIBS);
  gl.linkProgram(out);
  if (!gl.getProgramParameter(out, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(out) ?? '');
  return out;
}

/** @returns largest difference to the processor's own sum, largest distance outside the colliders [m] */
export function checkOnCard(scene: SceneT, state: WorldStateT, step: number): { difference_m: number; outside_m: number; vertices: number } {
  const poses = linkPoses(state.links), shape = handShape(scene, poses), mesh = skinMesh(shape, poses, step);
  const gl = document.createElement('canvas').getContext('webgl2')!;
  const { declarations, point } = placeSource(shape);
  const run = program(gl, `#version 300 es
precision highp float;
#define attribute in
in vec3 position;
out vec3 placed;
${declarations}
void main() { ${point} placed = skinPoint; gl_Position = vec4(0.0); }`);
  gl.useProgram(run);
  shape.links.forEach((link, slot) => {
    const o = link * POSE_STRIDE;
    gl.uniform3f(gl.getUniformLocation(run, `linkAt[${slot}]`), poses[o], poses[o + 1], poses[o + 2]);
    gl.uniform4f(gl.getUniformLocation(run, `linkTurn[${slot}]`), poses[o + 3], poses[o + 4], poses[o + 5], poses[o + 6]);
  });
  const feed = (name: string, data: Float32Array, size: number) => {
    const at = gl.getAttribLocation(run, name);
    gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ARRAY_BUFFER, data, gl.STATIC_DRAW);
    gl.enableVertexAttribArray(at);
    gl.vertexAttribPointer(at, size, gl.FLOAT, false, 0, 0);
  };
  feed('position', mesh.positions, 3);
  feed('skinLink', Float32Array.from(mesh.links), 1);
  gl.bindBuffer(gl.ARRAY_BUFFER, null);
  const result = gl.createBuffer();
  gl.bindBuffer(gl.TRANSFORM_FEEDBACK_BUFFER, result);
  gl.bufferData(gl.TRANSFORM_FEEDBACK_BUFFER, mesh.positions.byteLength, gl.STREAM_READ);
  gl.bindBufferBase(gl.TRANSFORM_FEEDBACK_BUFFER, 0, result);
  gl.enable(gl.RASTERIZER_DISCARD);
  gl.beginTransformFeedback(gl.POINTS);
  gl.drawArrays(gl.POINTS, 0, mesh.links.length);
  gl.endTransformFeedback();
  const placed = new Float32Array(mesh.positions.length);
  gl.getBufferSubData(gl.TRANSFORM_FEEDBACK_BUFFER, 0, placed);

  const colliders = shape.capsules.map((c) => ({ ...c, a: toWorld(poses, c.link, c.a), b: toWorld(poses, c.link, c.b) }));
  let difference_m = 0, outside_m = 0;
  mesh.links.forEach((slot, v) => {
    const own: Vec = toWorld(poses, shape.links[slot], [mesh.positions[3 * v], mesh.positions[3 * v + 1], mesh.positions[3 * v + 2]]);
    const card: Vec = [placed[3 * v], placed[3 * v + 1], placed[3 * v + 2]];
    difference_m = Math.max(difference_m, Math.hypot(own[0] - card[0], own[1] - card[1], own[2] - card[2]));
    outside_m = Math.max(outside_m, Math.min(...colliders.map((c) => capsuleDistance(c, ...card))));
  });
  return { difference_m, outside_m, vertices: mesh.links.length };
}
