// The room: counter, fluted wall, brass rail, light. In its own frame y is up from the counter's top, the row is at
// z = 0, and the person's side of the counter is at +z.

import {
  BoxGeometry, Color, CylinderGeometry, DirectionalLight, DoubleSide, Group, HemisphereLight, InstancedMesh, Matrix4,
  Mesh, MeshBasicMaterial, type Object3D, PCFShadowMap, PlaneGeometry, PMREMGenerator, RepeatWrapping, Scene, SphereGeometry, SpotLight,
  type WebGLRenderer, type WebGLRenderTarget,
} from 'three';
import { disposeTree, surface } from './materials';
import { graded, picture, woodTexture } from './textures';
import type { Quality } from './quality';

/** Colour of the background. */
export const ROOM = '#142726';

/** Colours of the light. */
export interface Mood {
  readonly key: string;
  readonly rim: string;
  readonly lamps: string | undefined;   // on the wall; undefined: none
  readonly sky: string;
  readonly ground: string;
  readonly groundLow: string;           // in low quality, which has only this light and the key light
}

/** The surroundings of the exercise, in the stage's frame. */
export interface Setting {
  readonly mood: Mood;
  /** The wall with everything on it. It does not move. */
  wall(quality: Quality): Object3D;
  /** Tint of the counter's wood; undefined: no counter. */
  readonly counter: Color | undefined;
}

const EVENING: Mood = { key: '#fff0dc', rim: '#cfe6ea', lamps: '#ffd9a6', sky: '#fff3e2', ground: '#5a4334', groundLow: '#7a6354' };
const WALL_Z = -0.62;
const FLUTE = 0.05;
/** Size of wall and counter, which extend beyond every picture, upright and very wide ones too (camera.test.ts) [m]. */
const WIDTH = 8.4;
const HEIGHT = 4.2;
/** Size of the painted middle of the wall. */
const PAINTED = { width_m: 4.2, height_m: 2.1 } as const;
export const WALL = { width_m: WIDTH, height_m: HEIGHT, front_z: WALL_Z + FLUTE * 0.8 } as const;
/** The counter's near edge, and the height of its front [m]. */
export const COUNTER = { edge_z: 0.232, front_m: 0.64 } as const;
const RAIL_M = 0.01;

export interface Stage {
  readonly room: Group;                       // wall and counter
  readonly rail: Group;
  readonly light: Group;
  readonly target: SpotLight | undefined;     // the soft spot light on the current target
  /** @param turn_rad turn of wall and counter about the vertical, so that they face the camera */
  place(counter_y: number, row_z: number, turn_rad: number): void;
  dispose(): void;
}

export function brass(quality: Quality) {
  return surface(quality, { color: new Color('#D0A869'), metalness: 1, roughness: 0.32, envMapIntensity: 1.5 });
}

/** The environment that shiny objects reflect: a wide warm window on the left, a low cool one on the right. */
function softbox(renderer: WebGLRenderer): WebGLRenderTarget {
  const studio = new Scene(), generator = new PMREMGenerator(renderer);
  const window = (color: string, light: number, at: [number, number, number], w: number, h: number) => {
    const pane = new Mesh(new PlaneGeometry(w, h), new MeshBasicMaterial({ color: new Color(color).multiplyScalar(light), side: DoubleSide }));
    pane.position.set(...at);
    pane.lookAt(0, 0, 0);
    studio.add(pane);
  };
  studio.add(new Mesh(new SphereGeometry(8, 24, 12), new MeshBasicMaterial({ color: '#3c3a34', side: DoubleSide })));
  window('#fff0d8', 5.5, [-4, 2.6, 2.2], 2.6, 3.4);
  window('#dbe9ea', 2.2, [4.2, 1.6, 1.6], 1.6, 3.6);
  window('#ffe2b8', 3.2, [0, 5, 0.5], 4, 1.6);
  window('#8a5a38', 0.8, [0, -4, 2], 8, 4);
  const target = generator.fromScene(studio, 0.03);
  generator.dispose();
  disposeTree(studio);
  return target;
}

function spot(color: string, candela: number, half: number, soft: number, from: [number, number, number], to: [number, number, number]): SpotLight {
  const light = new SpotLight(color, candela, 0, half, soft, 2);
  light.position.set(...from);
  light.target.position.set(...to);
  return light;
}

function highLights(root: Group, mood: Mood): SpotLight {
  const key = spot(mood.key, 11.5, 0.46, 0.9, [-0.42, 1.42, 1.0], [0.05, 0.16, 0]);
  key.castShadow = true;
  key.shadow.mapSize.set(4096, 4096);
  key.shadow.radius = 9;
  key.shadow.bias = -0.0016;
  key.shadow.normalBias = 0.01;
  key.shadow.intensity = 0.62;
  key.shadow.camera.near = 0.4;
  key.shadow.camera.far = 3;
  const rim = spot(mood.rim, 5, 0.6, 1, [1.1, 0.9, -0.35], [0.1, 0.25, 0.05]);
  const target = spot('#fff2d6', 2.6, 0.13, 0.9, [0, 1.05, 0.75], [0, 0.2, 0]);
  for (const light of [key, rim, target]) root.add(light, light.target);
  for (const x of mood.lamps === undefined ? [] : [-0.42, 0.42]) {   // a soft pool of lamp light on the wall
    const lamp = spot(mood.lamps!, 5.5, 0.8, 1, [x, 1.0, -0.12], [x, 0.22, WALL_Z]);
    root.add(lamp, lamp.target);
  }
  root.add(new HemisphereLight(mood.sky, mood.ground, 0.55));
  return target;
}

function lowLights(root: Group, mood: Mood): void {
  const key = new DirectionalLight(mood.key, 2.4);
  key.position.set(-0.42, 1.26, 1.0);
  root.add(key, new HemisphereLight(mood.sky, mood.groundLow, 1.7));
}

function flutedWall(): Mesh {
  const material = surface('high', { color: new Color('#27495C'), roughness: 0.82 });
  const count = Math.round(WIDTH / FLUTE);
  const wall = new InstancedMesh(new CylinderGeometry(FLUTE * 0.86, FLUTE * 0.86, HEIGHT, 16, 1, true, -Math.PI / 2, Math.PI), material, count);
  for (let i = 0; i < count; i++) wall.setMatrixAt(i, new Matrix4().makeTranslation((i - count / 2 + 0.5) * FLUTE, HEIGHT / 2, WALL_Z));
  wall.receiveShadow = true;
  return wall;
}

/** The same wall as a texture: flutes and the two pools of light. */
function paintedWall(): Mesh {
  const texture = picture(2048, 1024, (pen) => {
    const flute = 2048 / (PAINTED.width_m / FLUTE);
    for (let x = 0; x < 2048; x += flute) {
      pen.fillStyle = graded(pen.createLinearGradient(x, 0, x + flute, 0),
        [[0, '#1d3638'], [0.3, '#345154'], [0.7, '#2f4a4d'], [1, '#1d3638']]);
      pen.fillRect(x, 0, flute + 1, 1024);
    }
    for (const x of [0.4, 0.6]) {
      pen.fillStyle = graded(pen.createRadialGradient(x * 2048, 812, 20, x * 2048, 812, 330),
        [[0, 'rgba(255,230,190,.20)'], [1, 'rgba(0,10,14,0)']]);
      pen.fillRect(0, 0, 2048, 1024);
    }
  });
  // The flutes are repeated beside the painting and continue above it.
  texture.wrapS = RepeatWrapping;
  const geometry = new PlaneGeometry(WIDTH, HEIGHT), uv = geometry.attributes.uv;
  for (let i = 0; i < uv.count; i++) uv.setXY(i, 0.5 + (uv.getX(i) - 0.5) * WIDTH / PAINTED.width_m, uv.getY(i) * HEIGHT / PAINTED.height_m);
  const wall = new Mesh(geometry, new MeshBasicMaterial({ map: texture }));
  wall.position.set(0, HEIGHT / 2, WALL_Z + FLUTE * 0.8);
  return wall;
}

const WOOD = new Color('#fff');

function counter(quality: Quality, tint: Color): Group {
  const root = new Group(), wood = woodTexture();
  wood.repeat.set(3.2, 0.9);   // the grain's scale is constant over the whole width
  const low = quality === 'low';
  const top = new Mesh(new BoxGeometry(WIDTH, 0.045, 0.86), low
    ? new MeshBasicMaterial({ map: wood, color: new Color(1.9, 1.45, 1.05).multiply(tint) })
    : surface('high', { map: wood, color: tint, roughness: 0.48, clearcoat: 0.35, clearcoatRoughness: 0.35 }));
  top.position.set(0, -0.0225, -0.2);
  const edge = new Mesh(new CylinderGeometry(0.0225, 0.0225, WIDTH, 24), surface(quality, { map: wood, color: tint, roughness: 0.42, clearcoat: 0.4, clearcoatRoughness: 0.3 }));
  edge.rotation.z = Math.PI / 2;
  edge.position.set(0, -0.0225, 0.23);
  const front = new Mesh(new PlaneGeometry(WIDTH, COUNTER.front_m - 0.04), new MeshBasicMaterial({ color: '#15100d' }));
  front.position.set(0, -(COUNTER.front_m + 0.04) / 2, COUNTER.edge_z);
  top.receiveShadow = edge.receiveShadow = true;
  root.add(top, edge, front);
  return root;
}

function rail(quality: Quality, height: number): Mesh {
  const mesh = new Mesh(new CylinderGeometry(RAIL_M, RAIL_M, WIDTH, 20), brass(quality));
  mesh.rotation.z = Math.PI / 2;
  mesh.position.y = height + RAIL_M;
  mesh.castShadow = true;
  return mesh;
}

export interface Furniture {
  readonly counter: boolean;
  /** Height of the rail's underside over the counter's top [m]; undefined: no rail. */
  readonly rail_m: number | undefined;
  /** The exercise's setting, instead of the fluted wall and its counter. */
  readonly setting?: Setting;
}

/** The fluted wall. Without a counter it continues downwards. */
function plainWall(quality: Quality, hasCounter: boolean): Mesh {
  const wall = quality === 'high' ? flutedWall() : paintedWall();
  if (!hasCounter) wall.position.y -= HEIGHT / 2;
  return wall;
}

export function makeStage(renderer: WebGLRenderer, scene: Scene, quality: Quality, furniture: Furniture): Stage {
  const room = new Group(), railing = new Group(), light = new Group(), all = [room, railing, light];
  const { setting } = furniture;
  scene.background = new Color(ROOM);
  renderer.shadowMap.enabled = quality === 'high';
  renderer.shadowMap.type = PCFShadowMap;
  let target: SpotLight | undefined;
  let mirrored: WebGLRenderTarget | undefined;
  if (quality === 'high') {
    mirrored = softbox(renderer);
    scene.environment = mirrored.texture;
    scene.environmentIntensity = 0.62;
    target = highLights(light, setting?.mood ?? EVENING);
  } else lowLights(light, setting?.mood ?? EVENING);
  const wood = setting ? setting.counter : furniture.counter ? WOOD : undefined;
  room.add(setting?.wall(quality) ?? plainWall(quality, wood !== undefined));
  if (wood) room.add(counter(quality, wood));
  if (furniture.rail_m !== undefined) railing.add(rail(quality, furniture.rail_m));
  scene.add(...all);
  return {
    room, rail: railing, light, target,
    place(counter_y, row_z, turn_rad) {
      for (const group of all) group.position.set(0, counter_y, row_z);
      room.rotation.y = turn_rad;
    },
    dispose() {
      mirrored?.dispose();
      scene.environment = null;
      // The groups are removed from the scene's tree, so they are disposed of here.
      for (const group of all) disposeTree(group);
      scene.remove(...all);
    },
  };
}
