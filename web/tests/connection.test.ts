import { afterEach, beforeEach, expect, test, vi } from 'vitest';
import { Connection } from '../src/net/connection';
import { socketUrl, tokenOf } from '../src/net/open_connection';
import {
  Arm, ControlsT, EventsT, EventT, Order, Payload, Refusal, ReplyT, SCHEMA_VERSION, SceneT, SetParameter, TakeControls, WelcomeT, WorldStateT,
} from '../src/protocol';
import { setLanguage } from '../src/shared/i18n';
import { TestConnection } from './test_connection';

let sockets: TestConnection[] = [];
const connections: Connection[] = [];
const connect = (token = ''): Connection => {
  const connection = new Connection({ url: 'ws://nowhere/ws', token, open: () => { const socket = new TestConnection(); sockets.push(socket); return socket; } });
  connections.push(connection);
  return connection;
};

beforeEach(() => { vi.useFakeTimers(); sockets = []; });
afterEach(() => { connections.splice(0).forEach((c) => c.close()); vi.useRealTimers(); });

test('Connection_AfterWelcome_IsOpenAndForwardsMessages', () => {
  const connection = connect();
  const seen: string[] = [];
  connection.on('status', (status) => seen.push(status));
  connection.on('scene', (scene) => seen.push(`scene ${String(scene.sceneName)}`));
  connection.on('state', (state) => seen.push(`state ${state.tick}`));
  connection.on('events', (events) => seen.push(`event ${events[0].type}`));
  const end = connection.on('controls', (controls) => seen.push(`held ${controls.held}`));
  sockets[0].welcome();
  const scene = new SceneT();
  scene.sceneName = 'cocktail-bar';
  sockets[0].sendMessage(Payload.Scene, scene);
  const state = new WorldStateT();
  state.tick = 42n;
  sockets[0].sendMessage(Payload.WorldState, state);
  sockets[0].sendMessage(Payload.Events, new EventsT([new EventT(42n, 6, -1, 0)]));
  sockets[0].sendMessage(Payload.Controls, new ControlsT(false, true));
  end();
  sockets[0].sendMessage(Payload.Controls, new ControlsT(false, false));
  expect(seen).toEqual(['open', 'scene cocktail-bar', 'state 42', 'event 6', 'held true']);
  expect(connection.latestState?.tick).toBe(42n);
  expect(connection.controls).toMatchObject({ heldByYou: false, held: false });
});

test('Connection_Orders_HaveIncreasingIdsAndSeparateAnswers', async () => {
  const connection = connect();
  sockets[0].welcome();
  const first = connection.setParameter('lead_in_m', 0.005);
  const second = connection.stop();
  expect(sockets[0].sent.map(({ id }) => id)).toEqual([1, 2]);
  const parameter = sockets[0].sent[0].table.order(new SetParameter()) as SetParameter;
  expect([parameter.name(), parameter.value()]).toEqual(['lead_in_m', 0.005]);
  sockets[0].sendMessage(Payload.Reply, new ReplyT(2, true, ''));
  sockets[0].sendMessage(Payload.Reply, new ReplyT(1, false, 'lead_in_m: allowed is 0 to 0.02'));
  expect(await first).toEqual({ accepted: false, reason: 'lead_in_m: allowed is 0 to 0.02' });
  expect(await second).toEqual({ accepted: true, reason: '' });
});

test('Connection_Arm_ContainsTheEndingThatWasShown', () => {
  const connection = connect();
  sockets[0].welcome();
  expect(connection.endings).toBe(0);
  const state = new WorldStateT();
  state.endings = 3;
  state.basis = 7;
  sockets[0].sendMessage(Payload.WorldState, state);
  expect(connection.endings).toBe(3);
  expect(connection.basis).toBe(7);
  void connection.arm(2, 5);  // pressed before the third ending and the seventh basis were shown
  const arm = sockets[0].sent[0].table.order(new Arm()) as Arm;
  expect([arm.endingsSeen(), arm.basisSeen()]).toEqual([2, 5]);
  void connection.setParameter('effort_limit_arm_n', 9);
  expect((sockets[0].sent[1].table.order(new SetParameter()) as SetParameter).basisSeen()).toBe(7);
  // Another run of the program counts from 0.
  sockets[0].welcome();
  expect([connection.endings, connection.basis]).toEqual([0, 0]);
});

test('Connection_ArmAndLoad_SendHeartbeatsUntilTheAnswer', async () => {
  const connection = connect();
  sockets[0].welcome();
  const beats = (): number => sockets[0].sent.filter(({ order }) => order === Order.Heartbeat).length;
  vi.advanceTimersByTime(200);
  expect(beats()).toBe(0);
  for (const give of [() => connection.arm(1, 1), () => connection.loadExercise('', 2, '')]) {
    const before = beats(), answer = give();
    const { id } = sockets[0].sent.at(-1)!;
    vi.advanceTimersByTime(200);
    expect(beats()).toBe(before + 4);  // every 50 ms
    sockets[0].sendMessage(Payload.Reply, new ReplyT(id, true, ''));
    await answer;
    await vi.advanceTimersByTimeAsync(200);
    expect(beats()).toBe(before + 4);
  }
});

test('Connection_Refusal_IsReportedInThePagesLanguage', async () => {
  vi.stubGlobal('document', { documentElement: {} });
  const connection = connect();
  sockets[0].welcome();
  const answerTo = (refusal: Refusal, reason: string): Promise<unknown> => {
    const answer = connection.arm(1, 1);
    sockets[0].sendMessage(Payload.Reply, new ReplyT(sockets[0].sent.at(-1)!.id, false, reason, refusal));
    return answer.then((given) => given.reason);
  };
  try {
    setLanguage('de');
    expect(await answerTo(Refusal.ArmedAlready, 'it is armed already')).toBe('Es ist schon gestartet.');
    // A reason that only the program knows is appended in its own words.
    expect(await answerTo(Refusal.CannotStart, 'the device is not calibrated')).toBe('Es lässt sich nicht starten. the device is not calibrated');
    // Refusals of a newer program, and one without a sentence.
    expect(await answerTo(200 as Refusal, 'the moon is full')).toBe('the moon is full');
    expect(await answerTo(Refusal.Other, 'for a reason')).toBe('for a reason');
    setLanguage('fr');
    expect(await answerTo(Refusal.NotHolder, 'this client does not hold the controls')).toBe('Cet écran n’a pas les commandes.');
  } finally {
    setLanguage('en');
    vi.unstubAllGlobals();
  }
});

test('Connection_Lost_RetriesWithGrowingWaitsAndKeepsIdsIncreasing', async () => {
  const connection = connect();
  sockets[0].welcome();
  void connection.arm(1, 1);
  sockets[0].disconnect();
  expect(connection.status).toBe('lost');
  // 0.25 s, then twice as long after each failure, at most 2 s.
  for (const wait_ms of [250, 500, 1000, 2000, 2000]) {
    const before = sockets.length;
    await vi.advanceTimersByTimeAsync(wait_ms - 1);
    expect(sockets).toHaveLength(before);
    await vi.advanceTimersByTimeAsync(1);
    expect(sockets).toHaveLength(before + 1);
    sockets.at(-1)!.disconnect();
  }
  expect(connection.attempts).toBe(6);
  await vi.advanceTimersByTimeAsync(2000);
  const socket = sockets.at(-1)!;
  socket.onopen?.({} as Event);
  socket.welcome();
  expect([connection.status, connection.attempts]).toEqual(['open', 0]);
  void connection.arm(1, 1);
  expect(socket.sent[0].id).toBe(2);
  // The wait is short again.
  socket.disconnect();
  await vi.advanceTimersByTimeAsync(250);
  expect(sockets.at(-1)).not.toBe(socket);
});

test('Connection_LostBeforeAnAnswer_RefusesTheOrder', async () => {
  const connection = connect();
  expect(await connection.arm(1, 1)).toEqual({ accepted: false, reason: 'There is no connection.' });
  sockets[0].welcome();
  const arm = connection.arm(1, 1);
  sockets[0].disconnect();
  expect(await arm).toEqual({ accepted: false, reason: 'The connection was lost.' });
  expect(connection.controls.heldByYou).toBe(false);
});

test('Connection_ClosedWithAReason_RefusesPendingOrdersWithIt', async () => {
  const connection = connect();
  sockets[0].welcome();
  const arm = connection.arm(1, 1);
  sockets[0].disconnect('message: is damaged or cut short');
  expect(await arm).toEqual({ accepted: false, reason: 'message: is damaged or cut short' });
});

test.each([[401, 401], [403, 403], [426, 0], [0, 0]])('Connection_RefusedWithStatus%i_ReportsStatus%i', async (status, known) => {
  const connection = new Connection({
    url: 'ws://nowhere/ws', open: () => { const socket = new TestConnection(); sockets.push(socket); return socket; },
    why: () => (status > 0 ? Promise.resolve(status) : Promise.reject(new Error('nobody there'))),
  });
  connections.push(connection);
  sockets[0].disconnect();
  await vi.advanceTimersByTimeAsync(300);
  expect(connection.refusedWith).toBe(known);
  // The page keeps trying: the next program may accept it.
  expect(sockets).toHaveLength(2);
  sockets[1].welcome();
  expect(connection.refusedWith).toBe(0);
});

test('Connection_OrderWithoutAnswer_TimesOut', async () => {
  const connection = connect();
  sockets[0].welcome();
  const stop = connection.stop();
  await vi.advanceTimersByTimeAsync(2900);
  sockets[0].sendMessage(Payload.WorldState, new WorldStateT());
  await vi.advanceTimersByTimeAsync(101);
  expect(await stop).toEqual({ accepted: false, reason: 'The program does not answer.' });
});

test('Connection_OtherSchemaVersion_ClosesForGood', async () => {
  const connection = connect();
  sockets[0].sendMessage(Payload.Welcome, new WelcomeT(9, 1, true, '9.0'), 9);
  expect(connection.problem).toEqual({ theirs: 9, ours: SCHEMA_VERSION });
  expect([connection.status, sockets[0].closed]).toEqual(['lost', true]);
  await vi.advanceTimersByTimeAsync(60_000);
  expect(sockets).toHaveLength(1);
});

test('Connection_HoldingTheControls_SendsHeartbeatsAtLeastEvery100Ms', async () => {
  const connection = connect('secret');
  sockets[0].welcome();
  await vi.advanceTimersByTimeAsync(500);
  expect(sockets[0].sent).toHaveLength(0);
  const taken = connection.takeControls();
  expect((sockets[0].sent[0].table.order(new TakeControls()) as TakeControls).token()).toBe('secret');
  sockets[0].sendMessage(Payload.Reply, new ReplyT(sockets[0].sent[0].id, true, ''));
  await taken;
  await vi.advanceTimersByTimeAsync(1000);
  const beats = sockets[0].sent.filter(({ order }) => order === Order.Heartbeat);
  expect(beats.length).toBeGreaterThanOrEqual(10);
  expect(beats.every((beat, i) => i === 0 || beat.id > beats[i - 1].id)).toBe(true);
  sockets[0].sendMessage(Payload.Controls, new ControlsT(false, true));
  const before = sockets[0].sent.length;
  await vi.advanceTimersByTimeAsync(500);
  expect(sockets[0].sent).toHaveLength(before);
});

test('Connection_SilentSocket_CountsAsLost', async () => {
  const connection = connect();
  sockets[0].welcome();
  await vi.advanceTimersByTimeAsync(3100);
  expect(connection.attempts).toBeGreaterThanOrEqual(1);
  expect(sockets[0].closed).toBe(true);
});

test('Connection_AfterABusyPage_IsNotCountedAsLost', () => {
  const connection = connect();
  sockets[0].welcome();
  // Eight seconds without a turn of the event loop; the first turn is a heartbeat.
  vi.setSystemTime(Date.now() + 8000);
  const now = performance.now() + 8000;
  const spy = vi.spyOn(performance, 'now').mockReturnValue(now);
  vi.advanceTimersByTime(50);
  expect([connection.status, sockets[0].closed]).toEqual(['open', false]);
  spy.mockRestore();
});

test('Connection_DamagedMessages_AreCountedAndChangeNothing', () => {
  const warn = vi.spyOn(console, 'warn').mockImplementation(() => {});
  const connection = connect();
  sockets[0].welcome();
  sockets[0].deliver(new ArrayBuffer(0));
  sockets[0].deliver(new Uint8Array([1, 2, 3, 4, 88, 88, 88, 88, 0, 0, 0, 0]).buffer);
  sockets[0].deliver('text');
  // A state without a payload.
  sockets[0].sendMessage(Payload.NONE, null);
  expect(connection.unreadable).toBe(4);
  expect(connection.latestState).toBeNull();
  expect([connection.status, warn.mock.calls.length]).toEqual(['open', 1]);
  warn.mockRestore();
});

test('SocketUrl_ContainsTheTokenAndNoForeignServer', () => {
  const at = (search: string, hash = '') => ({ protocol: 'https:', host: 'bar.example:8080', search, hash });
  expect(socketUrl(at(''), false, 'player')).toBe('wss://bar.example:8080/ws?role=player');
  expect(socketUrl(at('?token=a%2Fb'), false, 'player')).toBe('wss://bar.example:8080/ws?role=player&token=a%2Fb');
  expect(tokenOf(at('', '#token=xyz'))).toBe('xyz');
  expect(socketUrl(at('?server=127.0.0.1:9000'), true, 'player')).toBe('wss://127.0.0.1:9000/ws?role=player');
  expect(socketUrl(at('?server=127.0.0.1:9000'), false, 'player')).toBe('wss://bar.example:8080/ws?role=player');
  expect(socketUrl(at('?server=evil.example'), true, 'player')).toBe('wss://bar.example:8080/ws?role=player');
});
