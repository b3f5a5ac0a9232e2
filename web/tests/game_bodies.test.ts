import { Mesh, type Group, type Material } from 'three';
import { describe, expect, it } from 'vitest';
import { GameBodyList, type GameBodyShown } from '../src/net/game_bodies';
import { GameBodiesT, GameBodyT, GameShapesT, PoseT, QuatXyzwT, ShapeT, ShapeType, SlotState, Vec3T } from '../src/protocol';
import { GameBodiesView } from '../src/scene/game_bodies_view';

const ball = (radius_m: number) => new ShapeT(ShapeType.Sphere, null, radius_m);
const set = (id: number, ...pieces: ShapeT[]) => new GameShapesT(id, null, pieces);
const message = (bodies: GameBodyT[], shapes: GameShapesT[] = []) => new GameBodiesT(1, bodies, shapes);

describe('bodies of a game', () => {
  it('keep the shapes that came before, as long as a body has them', () => {
    const list = new GameBodyList();
    list.take(message([new GameBodyT(3, 1, 7, SlotState.Ghost)], [set(7, ball(0.03))]));
    expect(list.bodies[0]).toMatchObject({ slot: 3, generation: 1, ghost: true });
    expect(list.bodies[0]!.shapes[0]!.radiusM).toBe(0.03);
    list.take(message([new GameBodyT(3, 1, 7, SlotState.Solid), new GameBodyT(5, 2, 7, SlotState.LettingGo)]));
    expect(list.bodies.map(({ ghost, shapes }) => [ghost, shapes.length])).toEqual([[false, 1], [false, 1]]);
    list.take(message([]));
    expect(list.bodies).toEqual([]);
    list.take(message([new GameBodyT(3, 3, 7, SlotState.Solid)]));   // not told again: nothing to draw
    expect(list.bodies[0]!.shapes).toEqual([]);
  });
});

describe('the picture of bodies of a game', () => {
  const body = (slot: number, ghost = false, generation = 1): GameBodyShown => ({ slot, generation, ghost, shapes });
  const shapes = [ball(0.03), ball(0.02)];
  const poseAt = (z: number) => new PoseT(new Vec3T(0.1, 0.2, z), new QuatXyzwT(0, 0, 0, 1));
  const materialOf = (group: Group) => (group.children[0] as Mesh).material as Material;

  it('draws every body where its slot is, and no empty slot', () => {
    const view = new GameBodiesView('low');
    view.take([body(1)]);
    expect(view.root.children).toHaveLength(1);
    const group = view.root.children[0] as Group;
    expect(group.visible).toBe(false);   // no pose has come
    expect(group.children).toHaveLength(2);
    view.place([poseAt(0), poseAt(-10), poseAt(0.5), poseAt(-10)], 1);   // one body of the scene, slots 0 to 2
    expect(group.visible).toBe(true);
    expect(group.position.toArray()).toEqual([0.1, 0.2, 0.5]);
    view.place([poseAt(0)], 1);   // a state of another scene
    expect(group.visible).toBe(false);
    view.take([]);
    expect(view.root.children).toHaveLength(0);
  });

  it('shows a ghost through, and builds only what changed', () => {
    const view = new GameBodiesView('low');
    view.take([body(0, true), body(1)]);
    const [ghost, stays] = view.root.children as Group[];
    expect(materialOf(ghost!).opacity).toBeLessThan(1);
    expect(materialOf(stays!).opacity).toBe(1);
    view.take([body(0), body(1)]);
    expect(view.root.children).toContain(stays);
    expect(view.root.children).not.toContain(ghost);
    expect(materialOf(view.root.children[1] as Group).opacity).toBe(1);
    view.take([body(0), body(1, false, 2)]);
    expect(view.root.children).not.toContain(stays);
  });
});
