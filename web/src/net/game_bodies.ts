// The list of bodies that a game has put into the world, assembled from the program's messages.
import { SlotState, Whereabouts, type GameBodiesT, type PoseT, type RegisteredBodyT, type ShapeT } from '../protocol';

/** A body of a game. Its pose is WorldState.bodies[slot + number of Scene.bodies], or `pose`. */
export interface GameBodyShown {
  /** For a body without a slot: its number, from 1000 on. */
  readonly slot: number;
  readonly generation: number;
  /** The body overlaps something and does not collide yet. */
  readonly ghost: boolean;
  readonly shapes: readonly ShapeT[];
  /** Pose of a body without a slot. */
  readonly pose?: PoseT;
}

/** Keeps the shapes of the bodies in the world: a message contains only new shapes. */
export class GameBodyList {
  bodies: readonly GameBodyShown[] = [];
  private shapes = new Map<number, readonly ShapeT[]>();
  private readonly registered = new Map<number, RegisteredBodyT>();   // by number

  take(message: GameBodiesT): void {
    const known = new Map(this.shapes);
    for (const set of message.newShapes) known.set(set.id, set.pieces);
    this.shapes = new Map();
    const shapesOf = (id: number): readonly ShapeT[] => {
      const shapes = known.get(id) ?? [];
      this.shapes.set(id, shapes);
      return shapes;
    };
    for (const body of message.registered) {
      if (body.whereabouts === Whereabouts.Gone) this.registered.delete(body.number);
      else this.registered.set(body.number, body);
    }
    const inSlots = message.bodies.map(({ slot, generation, shapes: id, state }) =>
      ({ slot, generation, ghost: state === SlotState.Ghost, shapes: shapesOf(id) }));
    const taken = new Set(inSlots.map(({ slot }) => slot));
    // A body on its way into a slot is shown at its earlier pose.
    const outside = [...this.registered.values()].map(({ number, slot, generation, shapes: id, pose }) =>
      ({ inSlot: taken.has(slot), body: { slot: number, generation, ghost: false, shapes: shapesOf(id), pose: pose ?? undefined } }));
    this.bodies = [...inSlots, ...outside.filter(({ inSlot }) => !inSlot).map(({ body }) => body)];
  }

  /** Clears the list for a new connection: the program reports all bodies again. */
  clear(): void {
    this.bodies = [];
    this.shapes.clear();
    this.registered.clear();
  }
}
