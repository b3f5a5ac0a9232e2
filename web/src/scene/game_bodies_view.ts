// Draws the bodies that a game has put into the world. Empty slots are not drawn.
import { Group, Mesh, type Material } from 'three';
import type { GameBodyShown } from '../net/game_bodies';
import { BodyT, type PoseT } from '../protocol';
import { disposeTree } from './materials';
import { makeBody } from './plain_bodies';
import type { Quality } from './quality';

const COLOR = '#3B6FD1';
const GHOST_OPACITY = 0.4;

interface BodyDrawing { readonly body: GameBodyShown; readonly group: Group }

export class GameBodiesView {
  /** This group is in the program's frame. */
  readonly root = new Group();
  private readonly drawn = new Map<number, BodyDrawing>();   // by slot or number

  constructor(private readonly quality: Quality) {}

  /** Sets all bodies; unchanged bodies are not rebuilt. */
  take(bodies: readonly GameBodyShown[]): void {
    const wanted = new Map(bodies.map((body) => [body.slot, body]));
    for (const [slot, { body, group }] of this.drawn) {
      const now = wanted.get(slot);
      if (now && now.generation === body.generation && now.shapes === body.shapes && now.ghost === body.ghost) continue;
      disposeTree(group);
      this.root.remove(group);
      this.drawn.delete(slot);
    }
    for (const [slot, body] of wanted) {
      if (this.drawn.has(slot)) continue;
      const group = makeBody(new BodyT('', false, COLOR, [...body.shapes]), this.quality);
      if (body.ghost) fade(group);
      group.visible = false;   // hidden until its pose comes
      this.drawn.set(slot, { body, group });
      this.root.add(group);
    }
    // A body without a slot is drawn at its reported pose.
    for (const body of bodies) {
      if (body.pose) put(this.drawn.get(body.slot)!.group, body.pose);
    }
  }

  /** @param poses of a state @param first index of slot 0 among them */
  place(poses: readonly PoseT[], first: number): void {
    for (const [slot, { body, group }] of this.drawn) {
      if (!body.pose) put(group, poses[first + slot]);
    }
  }

  dispose(): void {
    this.take([]);
  }
}

function put(group: Group, pose: PoseT | undefined): void {
  const p = pose?.positionM, q = pose?.orientationXyzw;
  group.visible = Boolean(p && q);
  if (!p || !q) return;
  group.position.set(p.x, p.y, p.z);
  group.quaternion.set(q.x, q.y, q.z, q.w);
}

function fade(group: Group): void {
  group.traverse((object) => {
    if (!(object instanceof Mesh)) return;
    const material = object.material as Material;
    material.transparent = true;
    material.opacity = GHOST_OPACITY;
    object.castShadow = false;
  });
}
