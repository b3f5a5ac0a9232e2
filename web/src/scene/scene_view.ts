// The 3D view: room, the exercise's objects, hand. It receives scenes and states of the program, and is drawn when
// the page calls render().

import { Group, NeutralToneMapping, NoToneMapping, PerspectiveCamera, Scene, Vector3, WebGLRenderer } from 'three';
import { handShape, linkPoses } from '../hand/shape';
import { HandView, SKIN_STEP_M } from '../hand/hand_view';
import { madeSkin } from '../hand/skin_maker';
import type { ExerciseView } from '../exercises/exercise_view';
import { viewOf } from '../exercises/views';
import type { GameBodyShown } from '../net/game_bodies';
import type { Marks } from '../exercises/exercise';
import type { SceneT, WorldStateT } from '../protocol';
import { Backdrop } from './backdrop';
import { zoomedText_px } from './zoomed_text';
import { DEFAULT_PLACE, placeCamera, pointInRow, turnOf, type CameraPlace, type View } from './camera';
import { ContactGlow } from './contacts';
import { compiled } from './compile';
import { ForceArrows } from './force_arrows';
import { FrameClock } from './frame_clock';
import { intoProgramFrame, toThree, type Triple } from './frames';
import { disposeTree } from './materials';
import { GameBodiesView } from './game_bodies_view';
import { makeBody } from './plain_bodies';
import type { FrameStats, Quality } from './quality';
import { outlineOfScene } from './outline';
import { makeStage, ROOM, type Stage } from './stage';

export interface SceneViewOptions {
  quality: Quality; tone: string; view: View;
  /** Each contact's force is drawn as an arrow. */
  forces?: boolean;
  /** Draws instead of the canvas's own renderer, for tests. */
  renderer?: WebGLRenderer;
}

export interface Look {
  dimmed: boolean;          // behind a card
  grey: boolean;            // stopped, or the connection is lost
  ghostHand: boolean;       // the hand is not the person's at present
  showColliders: boolean;
  tone: string;
}

export interface Pixel { x_px: number; y_px: number }
/** Points of the canvas at which the page places texts. */
export interface Labels {
  goal: Pixel | null;     // the mark of the current step's goal
  target: Pixel | null;   // the grip of the current target
}

/** Largest number of pixels of a picture in low quality; largest pixel ratio in high quality. */
const LOW_PIXELS = 450_000;
const MOST_PIXELS = 2;
/** Height of the rail in the empty room, before a scene has come [m]. */
const EMPTY_RAIL_M = 0.381;

export class SceneView {
  private readonly renderer: WebGLRenderer;
  private readonly scene = new Scene();
  private readonly camera = new PerspectiveCamera();
  private readonly clock = new FrameClock();
  private readonly contacts = new ContactGlow();
  private readonly forces: ForceArrows | undefined;
  private quality: Quality;
  private look: Look;
  private reported: SceneT | undefined;
  private state: WorldStateT | undefined;
  private exercise: ExerciseView | undefined;
  private marks: Marks | undefined;
  private place: CameraPlace = DEFAULT_PLACE;
  private outline: Vector3[] = [];   // of the region that must be visible
  private stage: Stage | undefined;
  private backdrop: Backdrop | undefined;
  private hand: HandView | undefined;
  private handBegun = false;
  private builds = 0;           // number of builds; results of an earlier one are dropped
  private compiled = false;     // nothing is drawn before: the page would wait for the shader programs
  private bodies: (Group | undefined)[] = [];
  private ofGame: readonly GameBodyShown[] = [];
  private gameBodies: GameBodiesView | undefined;
  private readonly plain = new Group();
  private poses = new Float64Array(0);
  private fresh = false;
  private last_ms: number | undefined;
  private stateScript_ms = 0;

  constructor(private readonly canvas: HTMLCanvasElement, private readonly options: SceneViewOptions) {
    this.quality = options.quality;
    this.forces = options.forces ? new ForceArrows() : undefined;
    this.look = { dimmed: false, grey: false, ghostHand: false, showColliders: false, tone: options.tone };
    this.renderer = options.renderer ?? rendererOf(canvas, options.quality);
    this.renderer.setClearColor(ROOM);
    intoProgramFrame(this.plain);
    canvas.addEventListener('webglcontextrestored', () => this.resize());
  }

  /** Sets a scene: hand, exercise, level. The hand is made when the first state comes. */
  setScene(scene: SceneT): void {
    const same = this.reported !== undefined && drawn(scene) === drawn(this.reported);
    this.reported = scene;
    if (same) return;
    this.state = undefined;
    this.build();
  }

  setState(state: WorldStateT): void {
    const start = performance.now();
    // A program that is not armed yet reports no poses.
    const first = this.state === undefined || (this.state.links.length === 0 && state.links.length > 0);
    this.state = state;
    this.fresh = true;
    this.poses = linkPoses(state.links, this.poses) as Float64Array<ArrayBuffer>;
    if (state.links.length > 0) void this.makeHand();
    if (first) this.placeRow();
    this.contacts.take(state.contacts);
    this.forces?.take(state.contacts);
    this.stateScript_ms += performance.now() - start;
  }

  /** Sets the bodies that a game has put into the world. */
  setBodies(bodies: readonly GameBodyShown[]): void {
    this.ofGame = bodies;
    this.gameBodies?.take(bodies);
    this.fresh = true;
  }

  /** Sets the marks of the exercise that the page remembers and the program does not report. */
  setMarks(marks: Marks | undefined): void {
    this.marks = marks;
    if (marks) this.exercise?.mark?.(marks);
  }

  setLook(look: Partial<Look>): void {
    this.look = { ...this.look, ...look };
    this.applyLook();
    this.fresh = true;
  }

  setQuality(quality: Quality): void {
    if (quality === this.quality) return;
    this.quality = quality;
    this.build();
  }

  /** Everything that is drawn, for tests. */
  get drawnTree(): Scene { return this.scene; }

  /** Objects of this view in the graphics card's memory. */
  get memory(): { geometries: number; textures: number } {
    const { geometries, textures } = this.renderer.info.memory;
    return { geometries, textures };
  }

  /** Whether the picture is complete. Room, objects and hand are made in the background. */
  get whole(): boolean { return this.compiled && (this.hand !== undefined || !this.handBegun); }

  /** @param now_ms time of requestAnimationFrame */
  render(now_ms: number): void {
    if (!this.stage) this.build();   // no scene has come: only the room
    if (!this.compiled) return;
    const start = performance.now();
    const dt_s = this.last_ms === undefined ? 0 : Math.min(0.25, Math.max(0, (now_ms - this.last_ms) / 1000));
    this.last_ms = now_ms;
    if (this.state) this.update(this.state, dt_s);
    this.renderer.render(this.scene, this.camera);
    this.clock.add(now_ms, performance.now() - start + this.stateScript_ms);
    this.stateScript_ms = 0;
  }

  resize(): void {
    const width = Math.max(1, this.canvas.clientWidth), height = Math.max(1, this.canvas.clientHeight);
    const device = Math.min(MOST_PIXELS, window.devicePixelRatio || 1);
    this.renderer.setPixelRatio(this.quality === 'high' ? device : Math.min(1, Math.sqrt(LOW_PIXELS / (width * height))));
    this.renderer.setSize(width, height, false);
    placeCamera(this.camera, this.options.view, this.place, this.outline, width, height, zoomedText_px());
    this.exercise?.placeBehind(this.camera, this.place);
    if (this.compiled) this.takeBackdrop();
    else this.renderer.clear();
  }

  /** Position of a point of the program's world in the canvas. */
  project(world_m: Triple): Pixel { return this.pixel(toThree(world_m)); }

  /** The point in the row's plane at a point of the page [m, program's world]; null: outside the picture. */
  rowPoint(x_px: number, y_px: number): { y_m: number; z_m: number } | null {
    const box = this.canvas.getBoundingClientRect();
    return pointInRow(this.camera, this.place.row_z, (x_px - box.left) / box.width, (y_px - box.top) / box.height);
  }

  labels(): Labels {
    if (this.fresh && this.state) this.update(this.state, 0);   // current poses, not those of the last drawing
    const anchors = this.exercise?.anchors(this.camera);
    return { goal: anchors?.goal ? this.pixel(anchors.goal) : null, target: anchors?.target ? this.pixel(anchors.target) : null };
  }

  stats(): FrameStats {
    return { frame_ms: this.clock.frame_ms, script_ms: this.clock.script_ms, triangles: this.renderer.info.render.triangles };
  }

  dispose(): void {
    this.clear();
    this.contacts.root.clear();
    this.renderer.dispose();
  }

  private pixel(p: Vector3): Pixel {
    const v = p.clone().project(this.camera);
    return { x_px: (v.x * 0.5 + 0.5) * this.canvas.clientWidth, y_px: (0.5 - v.y * 0.5) * this.canvas.clientHeight };
  }

  private clear(): void {
    this.hand?.dispose();
    this.stage?.dispose();
    this.backdrop?.dispose();
    disposeTree(this.scene);
    this.scene.clear();
    this.plain.clear();
    this.hand = this.exercise = this.stage = this.backdrop = undefined;
    this.bodies = [];
    this.builds += 1;
    this.compiled = this.handBegun = false;
  }

  /** Builds everything except the hand, from the scene and in the present quality. */
  private build(): void {
    this.clear();
    this.renderer.toneMapping = this.quality === 'high' ? NeutralToneMapping : NoToneMapping;
    this.exercise = this.reported && viewOf(this.reported, this.quality);
    // If no exercise draws the scene, only tangible bodies are shown.
    const counter = !this.reported || this.exercise !== undefined;
    this.stage = makeStage(this.renderer, this.scene, this.quality, { counter, rail_m: this.reported ? this.exercise?.rail_m : EMPTY_RAIL_M, setting: this.exercise?.setting });
    if (this.quality === 'low') this.scene.add((this.backdrop = new Backdrop()).mesh);
    if (this.exercise) this.scene.add(this.exercise.root);
    this.setMarks(this.marks);
    this.bodies = this.reported?.bodies.map((body) => {
      if (this.exercise?.owns(String(body.name))) return undefined;
      const group = makeBody(body, this.quality);
      this.plain.add(group);
      return group;
    }) ?? [];
    this.gameBodies = new GameBodiesView(this.quality);
    this.gameBodies.take(this.ofGame);
    this.plain.add(this.gameBodies.root);
    if (this.forces) this.plain.add(this.forces.root);
    this.scene.add(this.plain, this.contacts.root);
    this.placeRow();
    void this.compile();
    if (this.state) void this.makeHand();
    this.fresh = true;
  }

  /** Places room and camera at the row. */
  private placeRow(): void {
    const placed = this.exercise?.placement(this.state);
    this.place = placed?.place ?? { ...DEFAULT_PLACE, right: this.reported?.rightHand ?? true };
    this.outline = placed?.outline ?? (this.reported ? outlineOfScene(this.reported, this.state) : []);
    this.stage?.place(this.place.counter_y, this.place.row_z, turnOf(this.place.right));
    this.resize();
  }

  private async compile(): Promise<void> {
    const { builds } = this;
    await compiled(this.renderer, this.scene, this.camera, this.scene);
    if (builds !== this.builds) return;
    this.compiled = true;
    this.takeBackdrop();
  }

  private takeBackdrop(): void {
    if (this.stage) this.backdrop?.take(this.renderer, this.scene, this.camera, this.stage.room, this.stage.light);
  }

  private async makeHand(): Promise<void> {
    const { reported, poses, quality, builds } = this;
    if (this.handBegun || !reported || reported.capsules.length === 0) return;
    this.handBegun = true;
    const shape = handShape(reported, poses);
    const mesh = await madeSkin(shape, poses, SKIN_STEP_M[quality]);
    if (builds !== this.builds) return;
    const hand = new HandView(shape, mesh, quality);
    this.applyLook(hand);
    await compiled(this.renderer, hand.root, this.camera, this.scene);
    if (builds !== this.builds) {
      hand.dispose();
      return;
    }
    this.hand = hand;
    this.scene.add(hand.root);
    this.applyLook();
    this.fresh = true;
  }

  private applyLook(hand = this.hand): void {
    const { dimmed, grey, ghostHand, showColliders, tone } = this.look;
    hand?.look({ ghost: ghostHand, colliders: showColliders, tone });
    const filters = [grey ? 'saturate(.22) brightness(.82)' : '', dimmed ? 'brightness(.85)' : ''].filter(Boolean);
    this.canvas.style.filter = filters.join(' ');
  }

  private update(state: WorldStateT, dt_s: number): void {
    if (this.fresh) this.hand?.pose(this.poses);
    this.fresh = false;
    this.exercise?.update(state, this.camera.position, dt_s);
    if (this.hand) this.exercise?.yieldTo(this.hand.uniforms);
    if (this.stage) this.stage.rail.position.z = this.exercise?.railZ(state) ?? this.place.row_z;
    if (this.stage?.target) this.exercise?.lightTarget(this.stage.target, dt_s);
    state.bodies.forEach((pose, i) => {
      const p = pose.positionM, q = pose.orientationXyzw;
      if (!p || !q || !this.bodies[i]) return;
      this.bodies[i].position.set(p.x, p.y, p.z);
      this.bodies[i].quaternion.set(q.x, q.y, q.z, q.w);
    });
    this.gameBodies?.place(state.bodies, this.bodies.length);
    const spots = this.contacts.update(this.camera, dt_s);
    this.contacts.root.visible = !this.look.ghostHand;
    this.hand?.tint(this.look.ghostHand ? [] : spots);
  }
}

function rendererOf(canvas: HTMLCanvasElement, quality: Quality): WebGLRenderer {
  // The picture is opaque, so that the browser need not blend it with the page.
  const context = canvas.getContext('webgl2', { alpha: false, antialias: quality === 'high', powerPreference: 'high-performance' });
  if (!context) throw new Error('WebGL 2 is not there');
  return new WebGLRenderer({ canvas, context });
}

/** A key of the scene's drawn parts. A new session or recording changes none of them. */
function drawn({ exerciseJson, valueNames, capsules, bodies, rightHand, linkNames }: SceneT): string {
  return JSON.stringify([exerciseJson, valueNames, capsules, bodies, rightHand, linkNames]);
}
