import { Mesh, type Group, type Material } from 'three';
import { describe, expect, it } from 'vitest';
import { GameBodyList, type GameBodyShown } from '../src/net/game_bodies';
import { GameBodiesT, GameBodyT, GameShapesT, PoseT, QuatXyzwT, RegisteredBodyT, ShapeT, ShapeType, SlotState, Vec3T, Whereabouts } from '../src/protocol';
import { GameBodiesView } from '../src/scene/game_bodies_view';

const ball = (radius_m: number) => new ShapeT(ShapeType.Sphere, null, radius_m);
const set = (id: number, ...pieces: ShapeT[]) => new GameShapesT(id, null, pieces);
const message = (bodies: GameBodyT[], shapes: GameShapesT[] = []) => new GameBodiesT(1, bodies, shapes);

describe('bodies of a game', () => {
  it('keep their shapes as long as a body uses them', () => {
    const list = new GameBodyList();
    list.take(message([new GameBodyT(3, 1, 7, SlotState.Ghost)], [set(7, ball(0.03))]));
    expect(list.bodies[0]).toMatchObject({ slot: 3, generation: 1, ghost: true });
    expect(list.bodies[0]!.shapes[0]!.radiusM).toBe(0.03);
    list.take(message([new GameBodyT(3, 1, 7, SlotState.Solid), new GameBodyT(5, 2, 7, SlotState.LettingGo)]));
    expect(list.bodies.map(({ ghost, shapes }) => [ghost, shapes.length])).toEqual([[false, 1], [false, 1]]);
    list.take(message([]));
    expect(list.bodies).toEqual([]);
    list.take(message([new GameBodyT(3, 3, 7, SlotState.Solid)]));   // its shape is no longer sent, so nothing is drawn
    expect(list.bodies[0]!.shapes).toEqual([]);
  });
});

describe('bodies without a slot', () => {
  const pose = new PoseT(new Vec3T(1, 2, 3), new QuatXyzwT(0, 0, 0, 1));
  const registered = (number: number, where: Whereabouts, slot = -1) => new RegisteredBodyT(number, 1, 7, slot, where, pose);
  const apply = (list: GameBodyList, bodies: GameBodyT[], changed: RegisteredBodyT[], shapes: GameShapesT[] = []) =>
    list.take(new GameBodiesT(1, bodies, shapes, changed));

  it('are drawn at their reported pose, and once while they have a slot', () => {
    const list = new GameBodyList();
    apply(list, [], [registered(1000, Whereabouts.OutOfReach), registered(1001, Whereabouts.LeftOut)], [set(7, ball(0.03))]);
    expect(list.bodies.map(({ slot, pose: at, shapes }) => [slot, at?.positionM?.x, shapes.length])).toEqual([[1000, 1, 1], [1001, 1, 1]]);
    apply(list, [], [registered(1000, Whereabouts.InSlot, 4)]);   // the loop has not got it yet
    expect(list.bodies.map(({ slot }) => slot)).toEqual([1000, 1001]);
    apply(list, [new GameBodyT(4, 9, 7, SlotState.Solid)], []);
    expect(list.bodies.map(({ slot, pose: at }) => [slot, at === undefined])).toEqual([[4, true], [1001, false]]);
    apply(list, [], [registered(1000, Whereabouts.Gone), registered(1001, Whereabouts.Gone)]);
    expect(list.bodies).toEqual([]);
  });

  it('follow their reported pose without a state', () => {
    const view = new GameBodiesView('low');
    const shapes = [ball(0.03)];
    view.take([{ slot: 1000, generation: 1, ghost: false, shapes, pose }]);
    const group = view.root.children[0] as Group;
    expect([group.visible, group.position.toArray()]).toEqual([true, [1, 2, 3]]);
    view.place([new PoseT(new Vec3T(9, 9, 9), new QuatXyzwT(0, 0, 0, 1))], 0);
    expect(group.position.toArray()).toEqual([1, 2, 3]);
    view.take([{ slot: 1000, generation: 1, ghost: false, shapes, pose: new PoseT(new Vec3T(4, 5, 6), new QuatXyzwT(0, 0, 0, 1)) }]);
    expect(view.root.children[0]).toBe(group);
    expect(group.position.toArray()).toEqual([4, 5, 6]);
  });
});

describe('the view of a game\'s bodies', () => {
  const body = (slot: number, ghost = false, generation = 1): GameBodyShown => ({ slot, generation, ghost, shapes });
  const shapes = [ball(0.03), ball(0.02)];
  const poseAt = (z: number) => new PoseT(new Vec3T(0.1, 0.2, z), new QuatXyzwT(0, 0, 0, 1));
  const materialOf = (group: Group) => (group.children[0] as Mesh).material as Material;

  it('draws every body at its slot\'s pose, and no empty slot', () => {
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

  it('draws ghosts transparent, and rebuilds only what changed', () => {
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
