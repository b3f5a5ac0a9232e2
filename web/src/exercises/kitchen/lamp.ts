// The lamp above a switch on the wall: it lights when the switch is pushed on. The program's frame, z up.
import { AdditiveBlending, Color, Group, LatheGeometry, Mesh, MeshBasicMaterial, PlaneGeometry, SphereGeometry, Vector2, Vector3, type Material } from 'three';
import { surface } from '../../scene/materials';
import { glowTexture } from '../../scene/textures';
import type { Workshop } from './furniture';

/** Height of the lamp above the middle of the switch, its distance from the wall, and the radius of its shade [m]. */
const ABOVE_M = 0.13;
const BEFORE_M = 0.05;
const SHADE_M = 0.04;
/** Width of the light on the wall [m]. */
const GLOW_M = 0.75;
const DARK = new Color('#cfc4ae'), WARM = new Color('#ffd27a');

export class Lamp {
  readonly root = new Group();
  private readonly bulb: Mesh<SphereGeometry, MeshBasicMaterial>;
  private readonly glow: Mesh<PlaneGeometry, MeshBasicMaterial>;

  /** @param at the middle of the switch @param wall_x x of the wall */
  constructor(at: Vector3, wall_x: number, shop: Workshop) {
    const x = wall_x - BEFORE_M, z = at.z + ABOVE_M;
    const add = (mesh: Mesh, dx: number, dz: number): void => {
      mesh.position.set(x + dx, at.y, z + dz);
      this.root.add(mesh);
    };
    const arm = shop.bar(0.006, BEFORE_M, shop.metal), plate = shop.bar(0.024, 0.01, shop.metal);
    arm.rotation.y = plate.rotation.y = Math.PI / 2;
    add(arm, BEFORE_M / 2, 0.034);
    add(plate, BEFORE_M - 0.006, 0.034);
    const outline = [[0.012, 0.04], [SHADE_M, -0.012], [SHADE_M - 0.003, -0.012], [0.01, 0.037]] as const;
    const cloth: Material = surface(shop.quality, { color: new Color('#2f6f74'), roughness: 0.6, side: 2 });
    const shade = new Mesh(new LatheGeometry(outline.map(([r, y]) => new Vector2(r, y)), shop.quality === 'high' ? 48 : 24).rotateX(Math.PI / 2), cloth);
    shade.castShadow = true;
    add(shade, 0, 0);
    this.bulb = new Mesh(new SphereGeometry(0.019, 24, 16), new MeshBasicMaterial({ color: DARK.clone() }));
    add(this.bulb, 0, -0.008);
    this.glow = new Mesh(new PlaneGeometry(GLOW_M, GLOW_M), new MeshBasicMaterial({ map: glowTexture(), color: WARM.clone(), blending: AdditiveBlending, transparent: true, depthWrite: false, opacity: 0 }));
    // On the tiles, facing the person.
    this.glow.rotation.set(0, -Math.PI / 2, 0);
    add(this.glow, BEFORE_M - 0.002, -0.05);
    this.glow.name = 'light';
    this.glow.visible = false;
  }

  set lit(on: boolean) {
    if (this.glow.visible === on) return;
    this.glow.visible = on;
    this.glow.material.opacity = on ? 0.5 : 0;
    this.bulb.material.color.copy(on ? WARM : DARK);
  }
  get lit(): boolean { return this.glow.visible; }
}
