// What a page that is left, silent or not answered does: the controls, the beat, the emergency stop.
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { Connection } from '../src/net/connection';
import type { Line } from '../src/net/line';
import type { FromLine, ToLine } from '../src/net/worker_line';
import { ControlsT, Order, Payload, ReplyT } from '../src/protocol';
import { TestLine } from './test_line';

let lines: TestLine[] = [];
let connection: Connection;

beforeEach(() => {
  vi.useFakeTimers();
  lines = [];
  connection = new Connection({ url: 'ws://nowhere/ws', open: () => { const line = new TestLine(); lines.push(line); return line; } });
  lines[0].welcome();
});
afterEach(() => { connection.close(); vi.useRealTimers(); });

const last = (): TestLine => lines[lines.length - 1];
const accept = (id: number): void => last().say(Payload.Reply, new ReplyT(id, true, ''));
const sentOf = (order: Order, line = last()): number[] => line.sent.filter((sent) => sent.order === order).map(({ id }) => id);

async function take(): Promise<void> {
  const taken = connection.takeControls();
  accept(sentOf(Order.TakeControls).at(-1)!);
  last().say(Payload.Controls, new ControlsT(true, true));
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
    expect(last().sent).toHaveLength(before);  // 200 ms of silence and the program has given the controls up
    expect([connection.controls.heldByYou, connection.loss]).toEqual([false, 'left']);
    last().say(Payload.Controls, new ControlsT(false, false));
    connection.comeBack();
    await vi.advanceTimersByTimeAsync(1000);
    expect(last().sent).toHaveLength(before);
    expect(connection.loss).toBe('left');
    await take();
    expect(connection.loss).toBe('');
  });

  it('orders nothing but stops', async () => {
    connection.leave();
    for (const order of [connection.takeControls(), connection.arm(1), connection.aim([0]), connection.loadExercise('', 1, '')])
      expect(await order).toEqual({ accepted: false, reason: 'You left the page meanwhile. Press again.' });
    expect(last().sent).toHaveLength(0);
    void connection.stop();
    void connection.emergencyStop();
    expect(last().sent.map(({ order }) => order)).toEqual([Order.Stop, Order.EmergencyStop]);
  });

  it('while it takes the controls does not have them afterwards', async () => {
    const taken = connection.takeControls();
    connection.leave();
    accept(1);
    last().say(Payload.Controls, new ControlsT(true, true));
    await taken;
    await vi.advanceTimersByTimeAsync(500);
    expect(sentOf(Order.Heartbeat)).toHaveLength(0);
    expect(connection.controls.heldByYou).toBe(false);
  });
});

describe('the loss of the controls', () => {
  it('is known from giving them back', async () => {
    await take();
    void connection.releaseControls();
    last().say(Payload.Controls, new ControlsT(false, false));
    expect(connection.loss).toBe('');
    await take();
    last().say(Payload.Controls, new ControlsT(false, false));
    expect(connection.loss).toBe('unheard');
  });
});

describe('controls that are taken and given back in one go', () => {
  it('are not lost, and end the beats', async () => {
    const both = [connection.takeControls(), connection.releaseControls()];
    for (const id of [1, 2]) accept(id);
    last().say(Payload.Controls, new ControlsT(false, false));
    await Promise.all(both);
    expect([connection.controls.heldByYou, connection.loss]).toEqual([false, '']);
    const before = sentOf(Order.Heartbeat).length;
    await vi.advanceTimersByTimeAsync(500);
    expect(sentOf(Order.Heartbeat)).toHaveLength(before);
  });
});

describe('an emergency stop', () => {
  it('that is answered is sent once, and nobody is alarmed', async () => {
    const answer = connection.emergencyStop();
    await vi.advanceTimersByTimeAsync(299);
    accept(sentOf(Order.EmergencyStop)[0]);
    expect(await answer).toEqual({ accepted: true, reason: '' });
    await vi.advanceTimersByTimeAsync(5000);
    expect(sentOf(Order.EmergencyStop, lines[0])).toHaveLength(1);
    expect(connection.stopUnconfirmed).toBe(false);
  });

  it('without an answer for 300 ms is said to be unconfirmed and sent again, until there is one', async () => {
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

  it('is sent over the next line when this one is lost, and asked for without one, too', async () => {
    lines[0].breaks();
    let confirmed = false;
    void connection.emergencyStop().then(() => { confirmed = true; });
    await vi.advanceTimersByTimeAsync(300);
    expect([connection.stopUnconfirmed, lines.length]).toEqual([true, 2]);
    last().welcome();
    await vi.advanceTimersByTimeAsync(300);
    accept(sentOf(Order.EmergencyStop)[0]);
    await vi.advanceTimersByTimeAsync(0);
    expect([connection.stopUnconfirmed, confirmed]).toEqual([false, true]);
  });
});

describe('a line with a beat of its own', () => {
  it('beats while this page has the controls, and no longer', async () => {
    const held: boolean[] = [];
    class BeatingLine extends TestLine implements Line {
      hold(beat: Uint8Array | null): void { held.push(beat !== null); }
    }
    const beating = new BeatingLine();
    const other = new Connection({ url: 'ws://nowhere/ws', open: () => beating });
    beating.welcome();
    const taken = other.takeControls();
    expect(held, 'a page that is busy until it can read the answer').toEqual([true]);
    beating.say(Payload.Reply, new ReplyT(1, true, ''));
    await taken;
    await vi.advanceTimersByTimeAsync(500);
    other.leave();
    expect(held).toEqual([true, false]);
    expect(beating.sent).toHaveLength(1);  // the page itself does not beat beside it
    other.close();
  });
});

describe('the worker', () => {
  const sent: unknown[] = [];
  const reported: FromLine[] = [];
  let hear: (order: ToLine) => void = () => {};

  it('beats every 50 ms for as long as the page answers, and a page that hangs for 3 s is silent', async () => {
    class Socket { static readonly OPEN = 1; readyState = 1; send(bytes: unknown): void { sent.push(bytes); } close(): void {} }
    vi.stubGlobal('WebSocket', Socket);
    vi.stubGlobal('postMessage', (message: FromLine) => reported.push(message));
    vi.stubGlobal('addEventListener', (_: string, callback: (event: { data: ToLine }) => void) => { hear = (data) => callback({ data }); });
    await import('../src/net/line_worker');
    hear({ is: 'open', url: 'ws://nowhere/ws' });
    await vi.advanceTimersByTimeAsync(500);
    expect(sent).toHaveLength(0);
    hear({ is: 'hold', beat: new Uint8Array([7]) });
    for (let i = 0; i < 20; i += 1) {
      await vi.advanceTimersByTimeAsync(50);
      hear({ is: 'answer' });
    }
    expect([sent.length, reported.filter(({ is }) => is === 'ask').length]).toEqual([20, 20]);
    await vi.advanceTimersByTimeAsync(5000);  // the page does not answer: beats at 50 to 2950 ms
    expect(sent).toHaveLength(79);
    hear({ is: 'hold', beat: null });
    await vi.advanceTimersByTimeAsync(500);
    expect(sent).toHaveLength(79);
    vi.unstubAllGlobals();
  });
});
