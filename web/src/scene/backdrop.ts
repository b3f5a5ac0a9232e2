// The room as one picture. Camera and room do not move, so that software rendering draws wall and counter once
// and copies them for every frame.

import {
  FramebufferTexture, GLSL3, Mesh, NearestFilter, PlaneGeometry, RGBFormat, ShaderMaterial, Vector2, type Camera, type Object3D,
  type Scene, type WebGLRenderer,
} from 'three';

export class Backdrop {
  readonly mesh: Mesh;
  private readonly material: ShaderMaterial;
  private texture: FramebufferTexture | undefined;

  constructor() {
    this.material = new ShaderMaterial({
      glslVersion: GLSL3, depthTest: false, depthWrite: false, toneMapped: false,
      uniforms: { room: { value: null } },
      vertexShader: 'void main() { gl_Position = vec4(position.xy, 0.0, 1.0); }',
      fragmentShader: 'uniform sampler2D room; out vec4 color; void main() { color = texelFetch(room, ivec2(gl_FragCoord.xy), 0); }',
    });
    this.mesh = new Mesh(new PlaneGeometry(2, 2), this.material);
    this.mesh.frustumCulled = false;
    this.mesh.renderOrder = -100;
    this.mesh.visible = false;
  }

  /** Draws the room, stores the picture, and hides the room. */
  take(renderer: WebGLRenderer, scene: Scene, camera: Camera, room: Object3D, light: Object3D): void {
    const shown = scene.children.filter((child) => child.visible && child !== light);
    for (const child of shown) child.visible = false;
    room.visible = true;
    renderer.render(scene, camera);
    const size = renderer.getDrawingBufferSize(new Vector2());
    this.texture?.dispose();
    this.texture = new FramebufferTexture(size.x, size.y);
    this.texture.format = RGBFormat;   // the format of the canvas, which has no alpha
    this.texture.internalFormat = 'RGB8';
    this.texture.minFilter = this.texture.magFilter = NearestFilter;
    renderer.copyFramebufferToTexture(this.texture);
    this.material.uniforms.room.value = this.texture;
    for (const child of shown) child.visible = true;
    room.visible = false;
    this.mesh.visible = true;
  }

  dispose(): void {
    this.texture?.dispose();
    this.mesh.geometry.dispose();
    this.material.dispose();
  }
}
