// A stop is sent once the connection is open, and a page reports missing confirmations, even with few turns of the event loop.
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { Connection } from '../src/net/connection';
import { FreshButtons } from '../src/shared/fresh_buttons';
import { Order, Payload, ReplyT, WorldStateT } from '../src/protocol';
import { TestConnection } from './test_connection';
import { TurnClock } from './turn_clock';

/** Busy time of the main thread per turn [ms]. */
const TURNS_MS = [50, 120, 300, 600, 601, 1000, 2000];

let clock: TurnClock;
let sockets: TestConnection[];
let connection: Connection;

beforeEach(() => {
  clock = new TurnClock();
  sockets = [];
  connection = new Connection({ url: 'ws://nowhere/ws', open: () => { const socket = new TestConnection(); sockets.push(socket); return socket; } });
  sockets[0].welcome();
});
afterEach(() => { connection.close(); vi.unstubAllGlobals(); });

const last = (): TestConnection => sockets[sockets.length - 1];
const stops = (): number[] => last().sent.filter(({ order }) => order === Order.EmergencyStop).map(({ id }) => id);

describe.each(TURNS_MS)('a page whose every turn takes %i ms', (turn_ms) => {
  it('reports in its first turn after 300 ms that a silent program has not confirmed a stop', async () => {
    await clock.turn(turn_ms);
    void connection.emergencyStop();
    expect(stops(), 'sent at once').toHaveLength(1);
    const took_ms = await clock.until(() => connection.stopUnconfirmed, turn_ms, 10_000);
    expect(took_ms).toBeGreaterThanOrEqual(300);
    expect(took_ms, 'the turn in which 300 ms are over').toBeLessThan(300 + 50 + turn_ms);
  });

  it('reports the lost connection at the latest one turn after 3 s of silence', async () => {
    last().sendMessage(Payload.WorldState, new WorldStateT());
    const took_ms = await clock.until(() => connection.status === 'lost', turn_ms, 20_000);
    expect(took_ms).toBeGreaterThan(3000);
    expect(took_ms).toBeLessThanOrEqual(3000 + 2 * turn_ms + 50);
  });

  it('keeps a connection whose program sends in every turn', async () => {
    for (let i = 0; i < 20; i += 1) {
      await clock.turn(turn_ms);
      last().sendMessage(Payload.WorldState, new WorldStateT());
    }
    expect([connection.status, sockets.length]).toEqual(['open', 1]);
  });

  it('sends a stop that was pressed without a connection once there is one, and ends the alarm with the answer', async () => {
    last().disconnect();
    let confirmed = false;
    void connection.emergencyStop().then(() => { confirmed = true; });
    await clock.until(() => connection.stopUnconfirmed && sockets.length > 1, turn_ms, 20_000);
    expect(connection.stopUnconfirmed).toBe(true);
    expect(stops(), 'the line does not live yet').toHaveLength(0);
    last().welcome();
    await clock.settle();
    expect(stops(), 'in the turn in which it is welcome').toHaveLength(1);
    last().sendMessage(Payload.Reply, new ReplyT(stops()[0], true, ''));
    await clock.settle();
    expect([connection.stopUnconfirmed, confirmed]).toEqual([false, true]);
  });
});

it('a hidden tab repeats a stop with each received message, not with its timers', async () => {
  clock.hidden = true;
  await clock.turn(1000);
  void connection.emergencyStop();
  for (let i = 0; i < 50; i += 1) {
    await clock.turn(16);
    last().sendMessage(Payload.WorldState, new WorldStateT());
  }
  // In 800 ms: at once, and every 300 ms with the next message of 16 ms; no timer fired.
  expect(stops()).toHaveLength(3);
});

it('a hidden tab sends a stop as soon as the next connection opens', async () => {
  clock.hidden = true;
  last().disconnect();
  void connection.emergencyStop();
  await clock.until(() => sockets.length > 1, 16, 5000);
  last().welcome();
  await clock.settle();
  expect(stops()).toHaveLength(1);
});

describe('buttons that have just appeared', () => {
  class Part extends EventTarget { dataset: Record<string, string> = {}; }
  let part: Part, fresh: FreshButtons, acted: string[];
  beforeEach(() => {
    [part, acted] = [new Part(), []];
    fresh = new FreshButtons(part as never, 'Space');
    for (const kind of ['pointerdown', 'click', 'keydown', 'submit']) part.addEventListener(kind, ({ type }) => acted.push(type));
  });
  const on = (type: string, more: object = {}): void => { part.dispatchEvent(Object.assign(new Event(type, { cancelable: true }), more)); };
  const press = (): void => { on('pointerdown'); on('click', { detail: 1 }); };

  it('ignore presses for 700 ms, so that a double click answers once', async () => {
    await clock.turn(1000);
    press();
    expect(acted).toEqual(['pointerdown', 'click']);
    fresh.changed();
    for (let i = 0; i < 4; i += 1) {
      expect(part.dataset.fresh).toBe('');
      press();
      on('click', { detail: 0 });
      on('keydown', { code: 'Enter' });
      on('submit');
      await clock.turn(i < 3 ? 174 : 178);
    }
    expect(acted).toHaveLength(2);
    expect(part.dataset.fresh).toBeUndefined();
    press();
    expect(acted).toHaveLength(4);
  });

  it('ignore a press that began before they were visible, and a key that is still down', async () => {
    on('pointerdown');
    on('keydown', { code: 'Enter' });
    fresh.changed();
    await clock.turn(650);
    on('pointerdown');
    await clock.turn(200);
    on('click', { detail: 1 });
    on('keydown', { code: 'Enter', repeat: true });
    expect(acted).toEqual(['pointerdown', 'keydown']);
    on('keydown', { code: 'Enter' });
    expect(acted).toHaveLength(3);
  });

  it('ignore Space, which squeezes, while it is held or was just pressed', async () => {
    fresh.changed();
    for (let i = 0; i < 5; i += 1) {
      await clock.turn(600);   // later than 700 ms after the first
      on('keydown', { code: 'Space' });
      on('keydown', { code: 'Space', repeat: true });
      await clock.turn(300);
      on('keyup', { code: 'Space' });
    }
    expect(acted).toEqual([]);
    await clock.turn(750);
    on('keydown', { code: 'Space' });
    expect(acted).toEqual(['keydown']);
  });

  it('let a held key be released at any time', () => {
    part.addEventListener('keyup', ({ type }) => acted.push(type));
    fresh.changed();
    on('keyup', { code: 'Space' });
    expect(acted).toEqual(['keyup']);
  });

  it('do not affect typing', () => {
    fresh.changed();
    on('keydown', { code: 'Digit1' });
    expect(acted).toEqual(['keydown']);
  });
});
