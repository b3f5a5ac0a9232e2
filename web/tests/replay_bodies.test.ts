// Bodies of a game in a replay: for each row the picture shows the same bodies as the live pages.
import { describe, expect, it, vi } from 'vitest';
import { FakeRecordings } from '../fake/fake_recordings';
import { BodyBudgetT, GameBodiesT, GameBodyT, GameShapesT, ShapeT, ShapeType, SlotState } from '../src/protocol';
import { BodiesHistory } from '../src/replay/bodies_history';
import { Column } from '../src/replay/column';
import { asProblem } from '../src/replay/problem';
import { RecordingSource } from '../src/replay/recording_source';
import { ReplaySide } from '../src/replay/side';

const ball = new GameShapesT(7, null, [new ShapeT(ShapeType.Sphere, null, 0.03)]);
const gameBodies = (bodies: GameBodyT[], shapes: GameShapesT[] = []) => new GameBodiesT(1, bodies, shapes);
const CHANGES = [
  { row: 100, reported: gameBodies([new GameBodyT(2, 1, 7, SlotState.Ghost)], [ball]) },
  { row: 150, reported: gameBodies([new GameBodyT(2, 1, 7, SlotState.Solid)]) },
  { row: 900, reported: gameBodies([]) },
];
const WINDOW = { from_s: 0, to_s: 2 };

function recording(budget = true): FakeRecordings {
  const fake = new FakeRecordings(new URLSearchParams({ length: '2' }));
  if (budget) fake.scene.budget = new BodyBudgetT(64, 24);
  fake.bodies = CHANGES;
  return fake;
}

async function sideOf(fake: FakeRecordings): Promise<ReplaySide> {
  return ReplaySide.open(new RecordingSource('a.h5', '', (address) => fake.answer(address)));
}

describe('bodies of a game in a recording', () => {
  it('exist from their first row to their last, as ghosts until they are solid', async () => {
    const side = await sideOf(recording());
    const at = async (row: number) => {
      await vi.waitFor(() => { side.seek(row / 1000, WINDOW, false, 1); expect(side.shown).toBe(row); });
      return side.bodies.map(({ slot, ghost, shapes }) => [slot, ghost, shapes[0]?.radiusM]);
    };
    await vi.waitFor(() => expect(side.fresh).toBe(true));
    const radius = Math.fround(0.03);
    expect(await at(99)).toEqual([]);
    expect(await at(100)).toEqual([[2, true, radius]]);
    expect(await at(149)).toEqual([[2, true, radius]]);
    expect(await at(1500)).toEqual([]);
    expect(await at(500)).toEqual([[2, false, radius]]);
    side.close();
  });

  it('are not requested if the scene has none', async () => {
    const fake = recording(false);
    const side = await sideOf(fake);
    expect(fake.asked.some((address) => address.includes('/bodies'))).toBe(false);
    side.close();
  });

  it('are sent to the picture once for every change, before the state is drawn', () => {
    const calls: string[] = [];
    const side = { hasScene: true, bodies: BodiesHistory.prototype.at.call(new BodiesHistory(), 0) };
    const column = Object.create(Column.prototype) as Column;
    const view = { setView: () => undefined, draw: () => calls.push('draw') };
    Object.assign(column, { side, view, redraw: { begin: () => undefined } });
    column.setView({ setBodies: (bodies: unknown[]) => calls.push(`bodies ${bodies.length}`) } as never);
    column.drawState(0, true);
    column.drawState(1, true);
    side.bodies = [{ slot: 2, generation: 1, ghost: true, shapes: [] }];
    column.drawState(2, true);
    expect(calls).toEqual(['bodies 0', 'draw', 'draw', 'bodies 1', 'draw']);
  });

  it('throw a Problem for damaged bytes', () => {
    const whole = new Uint8Array([1, 0, 0, 0, 200, 0, 0, 0, 1, 2]);
    for (const length of [3, 7, 10]) {
      expect(() => BodiesHistory.read(whole.slice(0, length).buffer)).toThrow();
    }
    try { BodiesHistory.read(whole.buffer); } catch (thrown) { expect(asProblem(thrown).kind).toBe('nonsense'); }
    expect(BodiesHistory.read(new ArrayBuffer(0)).at(5)).toEqual([]);
  });
});
