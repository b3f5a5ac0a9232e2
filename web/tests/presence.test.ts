// Behaviour of a page that is left, silent or unanswered: the controls, the heartbeat, the emergency stop.
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { Connection } from '../src/net/connection';
import type { SocketConnection } from '../src/net/socket_connection';
import type { WorkerMessage, WorkerRequest } from '../src/net/worker_connection';
import { ControlsT, Order, Payload, ReplyT } from '../src/protocol';
import { TestConnection } from './test_connection';

let sockets: TestConnection[] = [];
let connection: Connection;

beforeEach(() => {
  vi.useFakeTimers();
  sockets = [];
  connection = new Connection({ url: 'ws://nowhere/ws', open: () => { const socket = new TestConnection(); sockets.push(socket); return socket; } });
  sockets[0].welcome();
});
afterEach(() => { connection.close(); vi.useRealTimers(); });

const last = (): TestConnection => sockets[sockets.length - 1];
const accept = (id: number): void => last().sendMessage(Payload.Reply, new ReplyT(id, true, ''));
const sentOf = (order: Order, socket = last()): number[] => socket.sent.filter((sent) => sent.order === order).map(({ id }) => id);

async function take(): Promise<void> {
  const taken = connection.takeControls();
  accept(sentOf(Order.TakeControls).at(-1)!);
  last().sendMessage(Payload.Controls, new ControlsT(true, true));
  expect((await taken).accepted).toBe(true);
}

describe('a page that is left', () => {
  it('is silent at once, and takes nothing again by itself when the person is back', async () => {
    await take();
    let ordered: unknown;
    connection.on('leaving', () => { ordered = connection.aim([0]); });
    connection.leave();
    expect(ordered, 'the last moment to order something').toBeInstanceOf(Promise);
    expect(sentOf(Order.Aim)).toHaveLength(1);
    const before = last().sent.length;
    await vi.advanceTimersByTimeAsync(1000);
    expect(last().sent).toHaveLength(before);
    expect([connection.controls.heldByYou, connection.loss]).toEqual([false, 'left']);
    last().sendMessage(Payload.Controls, new ControlsT(false, false));
    connection.comeBack();
    await vi.advanceTimersByTimeAsync(1000);
    expect(last().sent).toHaveLength(before);
    expect(connection.loss).toBe('left');
    await take();
    expect(connection.loss).toBe('');
  });

  it('goes on without a press when it still holds the controls', async () => {
    await take();
    connection.leave();
    await vi.advanceTimersByTimeAsync(1500);
    const before = sentOf(Order.Heartbeat).length;
    connection.comeBack();
    expect([connection.controls.heldByYou, connection.loss]).toEqual([true, '']);
    await vi.advanceTimersByTimeAsync(200);
    expect(sentOf(Order.Heartbeat).length).toBeGreaterThan(before);
  });

  it('takes nothing back from a player who has taken the controls meanwhile', async () => {
    await take();
    connection.leave();
    last().sendMessage(Payload.Controls, new ControlsT(false, true));
    connection.comeBack();
    await vi.advanceTimersByTimeAsync(500);
    expect([connection.controls.heldByYou, connection.controls.held, connection.loss]).toEqual([false, true, 'left']);
    expect(sentOf(Order.Heartbeat)).toHaveLength(0);
  });

  it('orders nothing but stops', async () => {
    connection.leave();
    for (const order of [connection.takeControls(), connection.arm(1, 1), connection.aim([0]), connection.loadExercise('', 1, '')])
      expect(await order).toEqual({ accepted: false, reason: 'You left the page meanwhile. Press again.' });
    expect(last().sent).toHaveLength(0);
    void connection.stop();
    void connection.emergencyStop();
    expect(last().sent.map(({ order }) => order)).toEqual([Order.Stop, Order.EmergencyStop]);
  });

  it('does not hold controls that it was taking when it was left', async () => {
    const taken = connection.takeControls();
    connection.leave();
    accept(1);
    last().sendMessage(Payload.Controls, new ControlsT(true, true));
    await taken;
    await vi.advanceTimersByTimeAsync(500);
    expect(sentOf(Order.Heartbeat)).toHaveLength(0);
    expect(connection.controls.heldByYou).toBe(false);
  });
});

describe('the loss of the controls', () => {
  it('is distinguished from giving them back', async () => {
    await take();
    void connection.releaseControls();
    last().sendMessage(Payload.Controls, new ControlsT(false, false));
    expect(connection.loss).toBe('');
    await take();
    last().sendMessage(Payload.Controls, new ControlsT(false, false));
    expect(connection.loss).toBe('unheard');
  });
});

describe('controls that are taken and given back at once', () => {
  it('are not lost, and end the heartbeats', async () => {
    const both = [connection.takeControls(), connection.releaseControls()];
    for (const id of [1, 2]) accept(id);
    last().sendMessage(Payload.Controls, new ControlsT(false, false));
    await Promise.all(both);
    expect([connection.controls.heldByYou, connection.loss]).toEqual([false, '']);
    const before = sentOf(Order.Heartbeat).length;
    await vi.advanceTimersByTimeAsync(500);
    expect(sentOf(Order.Heartbeat)).toHaveLength(before);
  });
});

describe('an emergency stop', () => {
  it('with an answer is sent once, without an alarm', async () => {
    const answer = connection.emergencyStop();
    await vi.advanceTimersByTimeAsync(299);
    accept(sentOf(Order.EmergencyStop)[0]);
    expect(await answer).toEqual({ accepted: true, reason: '' });
    await vi.advanceTimersByTimeAsync(5000);
    expect(sentOf(Order.EmergencyStop, sockets[0])).toHaveLength(1);
    expect(connection.stopUnconfirmed).toBe(false);
  });

  it('without an answer for 300 ms is reported as unconfirmed and repeated until it is answered', async () => {
    void connection.emergencyStop();
    await vi.advanceTimersByTimeAsync(299);
    expect(connection.stopUnconfirmed).toBe(false);
    await vi.advanceTimersByTimeAsync(1);
    expect(connection.stopUnconfirmed).toBe(true);
    await vi.advanceTimersByTimeAsync(900);
    expect(sentOf(Order.EmergencyStop)).toHaveLength(5);  // at 0, 300, ... 1200 ms
    accept(sentOf(Order.EmergencyStop)[2]);
    await vi.advanceTimersByTimeAsync(900);
    expect([connection.stopUnconfirmed, sentOf(Order.EmergencyStop).length]).toEqual([false, 5]);
  });

  it('is sent over the next connection after a loss, also if it was requested without one', async () => {
    sockets[0].disconnect();
    let confirmed = false;
    void connection.emergencyStop().then(() => { confirmed = true; });
    await vi.advanceTimersByTimeAsync(300);
    expect([connection.stopUnconfirmed, sockets.length]).toEqual([true, 2]);
    last().welcome();
    await vi.advanceTimersByTimeAsync(300);
    accept(sentOf(Order.EmergencyStop)[0]);
    await vi.advanceTimersByTimeAsync(0);
    expect([connection.stopUnconfirmed, confirmed]).toEqual([false, true]);
  });
});

describe('a connection with its own heartbeat', () => {
  it('sends heartbeats only while this page has the controls', async () => {
    const held: boolean[] = [];
    class HeartbeatConnection extends TestConnection implements SocketConnection {
      keepAlive(beats: unknown): void { held.push(beats !== null); }
    }
    const beating = new HeartbeatConnection();
    const other = new Connection({ url: 'ws://nowhere/ws', open: () => beating });
    beating.welcome();
    const taken = other.takeControls();
    expect(held, 'a page that is busy until it can read the answer').toEqual([true]);
    beating.sendMessage(Payload.Reply, new ReplyT(1, true, ''));
    await taken;
    await vi.advanceTimersByTimeAsync(500);
    other.leave();
    expect(held).toEqual([true, false]);
    expect(beating.sent).toHaveLength(1);  // the page sends no heartbeat in addition
    other.close();
  });
});

describe('the connection worker', () => {
  const sent: unknown[] = [], alive = new Uint8Array([7]), busy = new Uint8Array([8]);
  const count = (beat: unknown): number => sent.filter((each) => each === beat).length;
  const reported: WorkerMessage[] = [];
  let deliver: (order: WorkerRequest) => void = () => {};

  it('sends a heartbeat every 50 ms while the page answers, and says that a page is busy that has not answered for 3 s', async () => {
    class Socket { static readonly OPEN = 1; readyState = 1; send(bytes: unknown): void { sent.push(bytes); } close(): void {} }
    vi.stubGlobal('WebSocket', Socket);
    vi.stubGlobal('postMessage', (message: WorkerMessage) => reported.push(message));
    vi.stubGlobal('addEventListener', (_: string, callback: (event: { data: WorkerRequest }) => void) => { deliver = (data) => callback({ data }); });
    await import('../src/net/connection_worker');
    deliver({ is: 'open', url: 'ws://nowhere/ws' });
    await vi.advanceTimersByTimeAsync(500);
    expect(sent).toHaveLength(0);
    deliver({ is: 'hold', heartbeats: { alive, busy } });
    for (let i = 0; i < 20; i += 1) {
      await vi.advanceTimersByTimeAsync(50);
      deliver({ is: 'answer' });
    }
    expect([sent.length, reported.filter(({ is }) => is === 'ask').length]).toEqual([20, 20]);
    await vi.advanceTimersByTimeAsync(5000);  // the page does not answer: alive at 50 to 2950 ms
    expect([count(alive), count(busy)]).toEqual([79, 41]);
    deliver({ is: 'answer' });
    await vi.advanceTimersByTimeAsync(500);
    expect([count(alive), count(busy)]).toEqual([89, 41]);
    deliver({ is: 'hold', heartbeats: null });
    await vi.advanceTimersByTimeAsync(500);
    expect(sent).toHaveLength(130);
    vi.unstubAllGlobals();
  });
});
