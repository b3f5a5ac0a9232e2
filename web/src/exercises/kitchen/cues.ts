// Cues for the next step: a ring at the handle, an arrow along or about its joint or onto the pressed point, a ghost of the
// body in its goal pose or a region to put it in, a gauge for the force, a hand that closes or opens.
import { BoxGeometry, DoubleSide, Group, Mesh, PlaneGeometry, Quaternion, Vector3, type BufferGeometry } from 'three';
import { ShapeType, type BodyT, type ShapeT } from '../../protocol';
import { toThree } from '../../scene/frames';
import { flat } from '../../scene/materials';
import { picture } from '../../scene/textures';
import type { Position } from '../exercise';
import { armOf, moved, pointOf, type Placement } from './joint';
import { HANDS, PASSES } from './pictures';
import { Ribbon, type HalfWidth } from './ribbon';
import { hasBar, type Handle, type Joint, type KitchenStep } from './task';

const ARROW = { points: 49, half_m: 0.006, head_m: 0.03, head_half_m: 0.017, over_m: 0.028, least_m: 0.1 } as const;
/** Most of a turn that is drawn, and how much its circle is larger. */
const TURN = { most_rad: 1.5 * Math.PI, wider: 1 } as const;
const RING = { points: 73, half_m: 0.0035, round_m: 0.02 } as const;
/** A goal nearer than this has no arrow [m or rad]. */
const NEAR = 0.006;
/** Width of the frame around the goal of a front, and of its dark edge [m]. */
const FRAME_M = 0.005;
const EDGE_M = 0.003;
const INK = '#1c1410';
/** Size of the gauge for the asked force. */
const FORCE = { wide_m: 0.1, half_m: 0.007, over_m: 0.06 } as const;
const SIGN = { wide_m: 0.055, over_m: 0.045 } as const;

const even: HalfWidth = (_, edge_m) => RING.half_m + edge_m;
const thick: HalfWidth = (_, edge_m) => FORCE.half_m + edge_m;
/** Outline of an arrow: a shaft, and a head at its end. */
const pointed: HalfWidth = (left_m, edge_m) =>
  left_m <= ARROW.head_m ? ARROW.head_half_m * left_m / ARROW.head_m + edge_m * (left_m > 0 ? 1.6 : 0) : ARROW.half_m + edge_m;

/** The way about a hinge by more than half a turn: three quarters of a turn on a larger circle, since the whole one would cover itself. */
function turnOf(now: Placement, joint: Joint, dq: number, point: Position): Vector3[] {
  const axis = new Vector3(...joint.axis).normalize(), middle = new Vector3(...joint.point_m), turn = Math.sign(dq) * Math.min(Math.abs(dq), TURN.most_rad);
  return Array.from({ length: ARROW.points }, (_, i) => {
    const p = pointOf(moved(now, joint, turn * i / (ARROW.points - 1)), point), out = p.clone().sub(middle);
    return toThree(p.addScaledVector(out.addScaledVector(axis, -out.dot(axis)), TURN.wider));
  });
}

/** Path of a point of the body to the goal, in three.js's frame. A short path begins straight behind the point, so that its direction is visible. */
export function wayOf(now: Placement, joint: Joint, dq: number, point: Position): Vector3[] {
  if (joint.type === 'hinge' && Math.abs(dq) > Math.PI) return turnOf(now, joint, dq, point);
  const far_m = Math.abs(dq) * armOf(now, joint, point), more_m = Math.max(0, ARROW.least_m - far_m), from = pointOf(now, point);
  const back = from.clone().sub(pointOf(moved(now, joint, Math.sign(dq) * 1e-3), point)).normalize();
  return Array.from({ length: ARROW.points }, (_, i) => {
    const along_m = (far_m + more_m) * i / (ARROW.points - 1) - more_m;
    return toThree(along_m < 0 ? from.clone().addScaledVector(back, -along_m) : pointOf(moved(now, joint, far_m > 0 ? dq * along_m / far_m : 0), point));
  });
}

/** Path onto a point, in three.js's frame. @param way direction of pressing, in the program's frame */
function ontoOf(point: Vector3, way: Vector3): Vector3[] {
  return Array.from({ length: ARROW.points }, (_, i) => toThree(point.clone().addScaledVector(way, ARROW.least_m * (i / (ARROW.points - 1) - 1) - RING.round_m)));
}

/** A straight band over a point, across the view. */
function barOver(middle: Vector3, eye: Vector3): Vector3[] {
  const up = new Vector3(0, 1, 0), aside = middle.clone().sub(eye).cross(up).normalize();
  return Array.from({ length: RING.points }, (_, i) => middle.clone().addScaledVector(up, FORCE.over_m).addScaledVector(aside, FORCE.wide_m * (i / (RING.points - 1) - 0.5)));
}

/** A loop around a bar. */
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

/** The body in its goal pose: the taken or pushed part pale, and a frame around its front. @param piece one child for each shape */
export function makeGhost(piece: Group, body: BodyT, front: ShapeT | undefined): Group {
  const { shapes } = body, barred = hasBar(body), ghost = new Group(), pale = flat('#fff6df', { transparent: true, opacity: 0.22, depthWrite: false });
  piece.children.forEach((child, i) => {
    if (!(child instanceof Mesh) || (barred && shapes[i]!.type === ShapeType.Box && shapes[i] !== front)) return;
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

export interface CueInput {
  readonly step: KitchenStep;
  readonly now: Placement;
  readonly handle: Handle;
  /** Goal of the hand, in the body's frame. */
  readonly point: Position;
  /** The body has a bar at this point. */
  readonly barred: boolean;
  readonly joint: Joint | undefined;
  readonly q: number;
  readonly held_s: number;
  /** Share of the asked force. */
  readonly force: number;
}

export class Cues {
  readonly root = new Group();
  private readonly ring = new Ribbon(RING.points);
  private readonly track = new Ribbon(RING.points, { color: '#fff4dc' });
  private readonly arrow = new Ribbon(ARROW.points, { above: true });
  private readonly mark = new Ribbon(RING.points, { above: true });
  private readonly force = [new Ribbon(RING.points, { color: '#fff4dc', above: true }), new Ribbon(RING.points, { above: true })] as const;
  private readonly region = new Mesh(new BoxGeometry(), flat('#fff6df', { transparent: true, opacity: 0.28, depthWrite: false }));
  private readonly signs = { open: handSign('open'), closed: handSign('closed') } as const;

  /** @param ghosts ghosts by the index of their bodies, in the program's frame */
  constructor(private readonly ghosts: ReadonlyMap<number, Group>) {
    this.root.add(this.track.root, this.ring.root, this.mark.root, this.arrow.root, ...this.force.map(({ root }) => root), this.region, this.signs.open, this.signs.closed);
  }

  /** @param shown undefined: there is no task */
  update(shown: CueInput | undefined, eye: Vector3): void {
    const verb = shown?.step.verb, rings = verb === 'reach' || verb === 'take' || verb === 'hold' || verb === 'press';
    const dq = shown?.step.verb === 'move' && shown.step.to !== undefined ? shown.step.to - shown.q : 0;
    const goes = shown?.joint !== undefined && Math.abs(dq) > NEAR, puts = verb === 'put' && shown?.step.center_m !== undefined;
    this.signs.open.visible = verb === 'let_go';
    this.signs.closed.visible = verb === 'take';
    this.ring.root.visible = rings && shown!.barred;
    this.mark.root.visible = rings && !shown!.barred;
    this.track.root.visible = verb === 'hold';
    this.arrow.root.visible = goes || puts || verb === 'press';
    for (const { root } of this.force) root.visible = verb === 'press';
    this.region.visible = puts;
    this.ghosts.forEach((ghost, body) => { ghost.visible = (goes || puts) && body === shown?.step.body; });
    if (!shown) return;
    const { now, handle, joint, step, barred } = shown, half_m = barred ? handle.length_m / 2 : 0;
    const up = new Vector3(0, 0, 1).applyQuaternion(new Quaternion(...[handle.turn?.x ?? 0, handle.turn?.y ?? 0, handle.turn?.z ?? 0, handle.turn?.w ?? 1]));
    const at = barred ? handle.at_m : shown.point, middle = toThree(pointOf(now, at)), along = toThree(up.clone().applyQuaternion(now.turn));
    if (rings) {
      const path = around(middle, along, half_m, eye);
      (barred ? this.ring : this.mark).lay(path, eye, even, step.verb === 'hold' ? shown.held_s / (step.for_s ?? 1) : 1);
      if (this.track.root.visible) this.track.lay(path.map((p) => p.clone().addScaledVector(p.clone().sub(eye).normalize(), 0.002)), eye, even);
    }
    if (goes) this.go(shown, moved(now, joint!, dq), wayOf(now, joint!, dq, barred ? up.multiplyScalar(half_m + ARROW.over_m).add(at) : at), eye);
    if (puts) this.put(shown, eye);
    if (verb === 'press') {
      this.arrow.lay(ontoOf(pointOf(now, at), pressedTo(shown)), eye, pointed);
      const path = barOver(middle.clone().addScaledVector(along, half_m), eye);
      this.force[0].lay(path, eye, thick);
      this.force[1].lay(path.map((p) => p.clone().addScaledVector(p.clone().sub(eye).normalize(), -0.002)), eye, thick, Math.min(1, shown.force));
    }
    for (const sign of Object.values(this.signs)) {
      sign.position.copy(middle).addScaledVector(along, half_m + SIGN.over_m);
      sign.lookAt(eye);
    }
  }

  private go({ step }: CueInput, goal: Placement, way: readonly Vector3[], eye: Vector3): void {
    this.arrow.lay(way, eye, pointed);
    const ghost = this.ghosts.get(step.body);
    ghost?.position.copy(goal.at);
    ghost?.quaternion.copy(goal.turn);
  }

  /** Shows a low arc to the goal of the body's centre. */
  private put(shown: CueInput, eye: Vector3): void {
    const { now, step } = shown, goal = new Vector3(...step.center_m!), [x, y, z] = step.half_size_m ?? [0.02, 0.02, 0.02], way = goal.clone().sub(now.at);
    const path = Array.from({ length: ARROW.points }, (_, i) => {
      const t = i / (ARROW.points - 1);
      return toThree(now.at.clone().addScaledVector(way, t).add(new Vector3(0, 0, way.length() * t * (1 - t))));
    });
    this.go(shown, { at: goal, turn: now.turn }, path, eye);
    this.region.position.copy(toThree(goal));
    this.region.scale.set(2 * y, 2 * z, 2 * x);   // three.js: x right, y up, z near
  }
}

/** Direction of pressing, in the program's frame: along its joint if there is one, to its farther end. */
function pressedTo({ step, now, joint, q, point }: CueInput): Vector3 {
  if (!joint) return new Vector3(...(step.met?.toward ?? [1, 0, 0]));
  const least = joint.least ?? -Infinity, most = joint.most ?? Infinity, dq = most - q >= q - least ? 1e-3 : -1e-3;
  return pointOf(moved(now, joint, dq), point).sub(pointOf(now, point)).normalize();
}
