// Bodies that a game has put into the world, gathered from what the program says of them.
import { SlotState, type GameBodiesT, type ShapeT } from '../protocol';

/** A body of a game. Its pose is WorldState.bodies[slot + number of Scene.bodies]. */
export interface GameBodyShown {
  readonly slot: number;
  readonly generation: number;
  /** Overlaps something and touches nothing yet. */
  readonly ghost: boolean;
  readonly shapes: readonly ShapeT[];
}

/** Keeps the shapes of the bodies that are in the world: a message brings those that are new. */
export class GameBodyList {
  bodies: readonly GameBodyShown[] = [];
  private shapes = new Map<number, readonly ShapeT[]>();

  take(message: GameBodiesT): void {
    const known = new Map(this.shapes);
    for (const set of message.newShapes) known.set(set.id, set.pieces);
    this.shapes = new Map();
    this.bodies = message.bodies.map(({ slot, generation, shapes: id, state }) => {
      const shapes = known.get(id) ?? [];
      this.shapes.set(id, shapes);
      return { slot, generation, ghost: state === SlotState.Ghost, shapes };
    });
  }

  /** Another connection: the program tells of all of them anew. */
  clear(): void {
    this.bodies = [];
    this.shapes.clear();
  }
}
