// What shows a first-timer the next step: a ring at the handle, an arrow along or about its joint, the body as it is to be,
// a hand that closes or opens.
import { DoubleSide, Group, Mesh, PlaneGeometry, Quaternion, Vector3, type BufferGeometry } from 'three';
import { ShapeType, type BodyT, type ShapeT } from '../../protocol';
import { toThree } from '../../scene/frames';
import { flat } from '../../scene/materials';
import { picture } from '../../scene/textures';
import type { Position } from '../exercise';
import { moved, pointOf, type Placed } from './joint';
import { HANDS, PASSES } from './pictures';
import { Ribbon, type HalfWidth } from './ribbon';
import type { Handle, Joint, KitchenStep } from './task';

const ARROW = { points: 25, half_m: 0.006, head_m: 0.03, head_half_m: 0.017, over_m: 0.028, least_m: 0.1 } as const;
const RING = { points: 73, half_m: 0.0035, round_m: 0.02 } as const;
/** A goal nearer than this needs no arrow [m or rad]. */
const NEAR = 0.006;
/** Of the frame round a front that is to be there, and its dark edge [m]. */
const FRAME_M = 0.005;
const EDGE_M = 0.003;
const INK = '#1c1410';
const SIGN = { wide_m: 0.055, over_m: 0.045 } as const;

const even: HalfWidth = (_, edge_m) => RING.half_m + edge_m;
/** A shaft, and a head at its end. */
const pointed: HalfWidth = (left_m, edge_m) =>
  left_m <= ARROW.head_m ? ARROW.head_half_m * left_m / ARROW.head_m + edge_m * (left_m > 0 ? 1.6 : 0) : ARROW.half_m + edge_m;

/** To the goal, along the way of a point of the body, three.js's frame. A short way begins behind the point, so that its direction is seen. */
export function wayOf(now: Placed, joint: Joint, dq: number, point: Position): Vector3[] {
  const far_m = pointOf(moved(now, joint, dq), point).distanceTo(pointOf(now, point)), long = Math.max(1, ARROW.least_m / Math.max(far_m, 1e-6));
  return Array.from({ length: ARROW.points }, (_, i) => toThree(pointOf(moved(now, joint, dq * (1 - long * (1 - i / (ARROW.points - 1)))), point)));
}

/** A long round around a bar. */
function around(middle: Vector3, along: Vector3, half_m: number, eye: Vector3): Vector3[] {
  const aside = along.clone().cross(middle.clone().sub(eye)).normalize(), straight = Math.max(0, half_m - RING.round_m);
  return Array.from({ length: RING.points }, (_, i) => {
    const a = Math.PI / 2 - 2 * Math.PI * i / (RING.points - 1), up = RING.round_m * Math.sin(a) * 1.5 + Math.sign(Math.round(1e6 * Math.sin(a))) * straight;
    return middle.clone().addScaledVector(along, up).addScaledVector(aside, -1.9 * RING.round_m * Math.cos(a));
  });
}

function handSign(kind: keyof typeof HANDS): Mesh {
  const map = picture(256, 256, (pen) => {
    pen.scale(2.56, 2.56);
    pen.lineCap = pen.lineJoin = 'round';
    pen.beginPath();
    pen.arc(50, 50, 46, 0, 2 * Math.PI);
    pen.fillStyle = '#FFF4DC';
    pen.strokeStyle = '#FFB938';
    pen.lineWidth = 6;
    pen.fill();
    pen.stroke();
    for (const [color, more] of PASSES) {
      pen.strokeStyle = color;
      for (const [d, wide] of HANDS[kind]) {
        pen.lineWidth = wide + more;
        pen.stroke(new Path2D(d));
      }
    }
  });
  return new Mesh(new PlaneGeometry(SIGN.wide_m, SIGN.wide_m), flat('#ffffff', { map, transparent: true }));
}

/** The body as it is to be: what is taken of it pale, and a frame around its front. @param piece one child for each shape */
export function makeGhost(piece: Group, { shapes }: BodyT, front: ShapeT | undefined): Group {
  const ghost = new Group(), pale = flat('#fff6df', { transparent: true, opacity: 0.22, depthWrite: false });
  piece.children.forEach((child, i) => {
    if (!(child instanceof Mesh) || (shapes[i]!.type === ShapeType.Box && shapes[i] !== front)) return;
    const mesh = new Mesh(child.geometry as BufferGeometry, pale);
    mesh.position.copy(child.position);
    mesh.quaternion.copy(child.quaternion);
    ghost.add(mesh);
  });
  const at = front?.inBody?.positionM, half = front?.halfExtentsM;
  if (!at || !half) return ghost;
  const bar = (y: number, z: number, wide: number, tall: number): void => {
    for (const [more, color, x] of [[EDGE_M, INK, 0], [0, '#fff4dc', -0.0006]] as const) {
      const mesh = new Mesh(new PlaneGeometry(tall + more, wide + more), flat(color, { side: DoubleSide }));
      mesh.rotation.y = -Math.PI / 2;
      mesh.position.set(at.x - half.x + x, at.y + y, at.z + z);
      ghost.add(mesh);
    }
  };
  for (const side of [-1, 1]) {
    bar(side * half.y, 0, FRAME_M, 2 * half.z + FRAME_M);
    bar(0, side * half.z, 2 * half.y + FRAME_M, FRAME_M);
  }
  return ghost;
}

export interface Shown { readonly step: KitchenStep; readonly now: Placed; readonly handle: Handle; readonly joint: Joint | undefined; readonly q: number; readonly held_s: number }

export class Cues {
  readonly root = new Group();
  private readonly ring = new Ribbon(RING.points);
  private readonly track = new Ribbon(RING.points, { color: '#fff4dc' });
  private readonly arrow = new Ribbon(ARROW.points, { above: true });
  private readonly signs = { open: handSign('open'), closed: handSign('closed') } as const;

  /** @param ghosts of the bodies by their index; they stand in the program's frame */
  constructor(private readonly ghosts: ReadonlyMap<number, Group>) {
    this.root.add(this.track.root, this.ring.root, this.arrow.root, this.signs.open, this.signs.closed);
  }

  /** @param shown undefined: nothing is asked for */
  update(shown: Shown | undefined, eye: Vector3): void {
    const verb = shown?.step.verb;
    this.signs.open.visible = verb === 'let_go';
    this.signs.closed.visible = verb === 'take';
    this.ring.root.visible = verb !== undefined && verb !== 'move' && verb !== 'let_go';
    this.track.root.visible = verb === 'hold';
    const dq = shown?.step.verb === 'move' && shown.step.to !== undefined ? shown.step.to - shown.q : 0;
    const goes = shown?.joint !== undefined && Math.abs(dq) > NEAR;
    this.arrow.root.visible = goes;
    this.ghosts.forEach((ghost, body) => { ghost.visible = goes && body === shown?.step.body; });
    if (!shown) return;
    const { now, handle, joint, step } = shown, half_m = handle.length_m / 2;
    const up = new Vector3(0, 0, 1).applyQuaternion(new Quaternion(...[handle.turn?.x ?? 0, handle.turn?.y ?? 0, handle.turn?.z ?? 0, handle.turn?.w ?? 1]));
    const middle = toThree(pointOf(now, handle.at_m)), along = toThree(up.clone().applyQuaternion(now.turn));
    if (this.ring.root.visible) {
      const path = around(middle, along, half_m, eye);
      this.ring.lay(path, eye, even, step.verb === 'hold' ? shown.held_s / (step.for_s ?? 1) : 1);
      if (this.track.root.visible) this.track.lay(path.map((p) => p.clone().addScaledVector(p.clone().sub(eye).normalize(), 0.002)), eye, even);
    }
    if (goes) {
      const top = up.multiplyScalar(half_m + ARROW.over_m).add(handle.at_m);
      this.arrow.lay(wayOf(now, joint!, dq, top), eye, pointed);
      const ghost = this.ghosts.get(step.body), goal = moved(now, joint!, dq);
      ghost?.position.copy(goal.at);
      ghost?.quaternion.copy(goal.turn);
    }
    for (const sign of Object.values(this.signs)) {
      sign.position.copy(middle).addScaledVector(along, half_m + SIGN.over_m);
      sign.lookAt(eye);
    }
  }
}
