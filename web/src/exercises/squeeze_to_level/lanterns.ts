// Lanterns on the sill, one for each band: lit after it was held.
import { AdditiveBlending, Color, ConeGeometry, CylinderGeometry, Group, Mesh, Sprite, SpriteMaterial, TorusGeometry, type MeshLambertMaterial } from 'three';
import { surface } from '../../scene/materials';
import type { Quality } from '../../scene/quality';
import { brass } from '../../scene/stage';
import { glowTexture } from '../../scene/textures';

const DARK = new Color('#5f6f74');
const LIT = new Color('#ffd777');
/** Time from dark to lit [s]. */
const FADE_S = 0.4;

export class Lantern {
  readonly root = new Group();
  private readonly pane: MeshLambertMaterial;
  private readonly glow: Sprite;
  private light = 0;

  constructor(quality: Quality) {
    const metal = brass(quality), part = (geometry: CylinderGeometry | ConeGeometry | TorusGeometry, y_m: number, material: Mesh['material'] = metal) => {
      const mesh = new Mesh(geometry, material);
      mesh.position.y = y_m;
      mesh.castShadow = true;
      this.root.add(mesh);
      return mesh;
    };
    this.pane = surface(quality, { color: DARK.clone(), roughness: 0.3, emissive: new Color('#ffb84a'), emissiveIntensity: 0 }) as MeshLambertMaterial;
    part(new CylinderGeometry(0.017, 0.019, 0.006, 6), 0.003);
    part(new CylinderGeometry(0.0125, 0.0125, 0.03, 6), 0.021, this.pane);
    part(new ConeGeometry(0.019, 0.014, 6), 0.043);
    part(new TorusGeometry(0.006, 0.0013, 6, 20), 0.055);
    for (let i = 0; i < 6; i++) {
      const bar = part(new CylinderGeometry(0.0012, 0.0012, 0.03, 6), 0.021), turn = i * Math.PI / 3;
      bar.position.x = 0.0135 * Math.sin(turn);
      bar.position.z = 0.0135 * Math.cos(turn);
    }
    this.glow = new Sprite(new SpriteMaterial({ map: glowTexture(), blending: AdditiveBlending, transparent: true, opacity: 0, depthWrite: false }));
    this.glow.position.set(0, 0.022, 0.016);
    this.glow.scale.setScalar(0.1);
    this.root.add(this.glow);
  }

  /** @param light target brightness, 0 .. 1 */
  update(light: number, dt_s: number): void {
    const step = dt_s / FADE_S;
    this.light += Math.min(step, Math.max(-step, light - this.light));
    this.pane.color.copy(DARK).lerp(LIT, this.light);
    this.pane.emissiveIntensity = 0.9 * this.light;
    this.glow.material.opacity = 0.85 * this.light;
    this.glow.visible = this.light > 0.01;
  }
}
