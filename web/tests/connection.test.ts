import { afterEach, beforeEach, expect, test, vi } from 'vitest';
import { Connection } from '../src/net/connection';
import { socketUrl, tokenOf } from '../src/net/open_connection';
import {
  Arm, ControlsT, EventsT, EventT, Order, Payload, Refusal, ReplyT, SCHEMA_VERSION, SceneT, SetParameter, TakeControls, WelcomeT, WorldStateT,
} from '../src/protocol';
import { setLanguage } from '../src/shared/i18n';
import { TestLine } from './test_line';

let lines: TestLine[] = [];
const connections: Connection[] = [];
const connect = (token = ''): Connection => {
  const connection = new Connection({ url: 'ws://nowhere/ws', token, open: () => { const line = new TestLine(); lines.push(line); return line; } });
  connections.push(connection);
  return connection;
};

beforeEach(() => { vi.useFakeTimers(); lines = []; });
afterEach(() => { connections.splice(0).forEach((c) => c.close()); vi.useRealTimers(); });

test('Connection_AfterWelcome_IsOpenAndTellsOfMessages', () => {
  const connection = connect();
  const seen: string[] = [];
  connection.on('status', (status) => seen.push(status));
  connection.on('scene', (scene) => seen.push(`scene ${String(scene.sceneName)}`));
  connection.on('state', (state) => seen.push(`state ${state.tick}`));
  connection.on('events', (events) => seen.push(`event ${events[0].type}`));
  const end = connection.on('controls', (controls) => seen.push(`held ${controls.held}`));
  lines[0].welcome();
  const scene = new SceneT();
  scene.sceneName = 'cocktail-bar';
  lines[0].say(Payload.Scene, scene);
  const state = new WorldStateT();
  state.tick = 42n;
  lines[0].say(Payload.WorldState, state);
  lines[0].say(Payload.Events, new EventsT([new EventT(42n, 6, -1, 0)]));
  lines[0].say(Payload.Controls, new ControlsT(false, true));
  end();
  lines[0].say(Payload.Controls, new ControlsT(false, false));
  expect(seen).toEqual(['open', 'scene cocktail-bar', 'state 42', 'event 6', 'held true']);
  expect(connection.latestState?.tick).toBe(42n);
  expect(connection.controls).toMatchObject({ heldByYou: false, held: false });
});

test('Connection_Orders_HaveStrictlyIncreasingIdsAndTheirOwnAnswers', async () => {
  const connection = connect();
  lines[0].welcome();
  const first = connection.setParameter('lead_in_m', 0.005);
  const second = connection.stop();
  expect(lines[0].sent.map(({ id }) => id)).toEqual([1, 2]);
  const parameter = lines[0].sent[0].table.order(new SetParameter()) as SetParameter;
  expect([parameter.name(), parameter.value()]).toEqual(['lead_in_m', 0.005]);
  lines[0].say(Payload.Reply, new ReplyT(2, true, ''));
  lines[0].say(Payload.Reply, new ReplyT(1, false, 'lead_in_m: allowed is 0 to 0.02'));
  expect(await first).toEqual({ accepted: false, reason: 'lead_in_m: allowed is 0 to 0.02' });
  expect(await second).toEqual({ accepted: true, reason: '' });
});

test('Connection_Arm_NamesTheEndingThatItsPersonWasShown', () => {
  const connection = connect();
  lines[0].welcome();
  expect(connection.endings).toBe(0);
  const state = new WorldStateT();
  state.endings = 3;
  lines[0].say(Payload.WorldState, state);
  expect(connection.endings).toBe(3);
  void connection.arm(2);  // pressed before the third one was shown
  expect((lines[0].sent[0].table.order(new Arm()) as Arm).endingsSeen()).toBe(2);
  // Another run of the program counts anew.
  lines[0].welcome();
  expect(connection.endings).toBe(0);
});

test('Connection_ARefusal_IsSaidInThePersonsLanguage', async () => {
  vi.stubGlobal('document', { documentElement: {} });
  const connection = connect();
  lines[0].welcome();
  const answerTo = (refusal: Refusal, reason: string): Promise<unknown> => {
    const answer = connection.arm(1);
    lines[0].say(Payload.Reply, new ReplyT(lines[0].sent.at(-1)!.id, false, reason, refusal));
    return answer.then((given) => given.reason);
  };
  try {
    setLanguage('de');
    expect(await answerTo(Refusal.ArmedAlready, 'it is armed already')).toBe('Es ist schon gestartet.');
    // What only the program can know follows in its own words.
    expect(await answerTo(Refusal.CannotStart, 'the device is not calibrated')).toBe('Es lässt sich nicht starten. the device is not calibrated');
    // A newer program's refusal, and one that has no sentence.
    expect(await answerTo(200 as Refusal, 'the moon is full')).toBe('the moon is full');
    expect(await answerTo(Refusal.Other, 'for a reason')).toBe('for a reason');
    setLanguage('fr');
    expect(await answerTo(Refusal.NotHolder, 'this client does not hold the controls')).toBe('Cet écran n’a pas les commandes.');
  } finally {
    setLanguage('en');
    vi.unstubAllGlobals();
  }
});

test('Connection_Lost_TriesAgainWithGrowingWaitsAndKeepsIdsIncreasing', async () => {
  const connection = connect();
  lines[0].welcome();
  void connection.arm(1);
  lines[0].breaks();
  expect(connection.status).toBe('lost');
  // 0.25 s, then twice as long after each failure, 2 s at most.
  for (const wait_ms of [250, 500, 1000, 2000, 2000]) {
    const before = lines.length;
    await vi.advanceTimersByTimeAsync(wait_ms - 1);
    expect(lines).toHaveLength(before);
    await vi.advanceTimersByTimeAsync(1);
    expect(lines).toHaveLength(before + 1);
    lines.at(-1)!.breaks();
  }
  expect(connection.attempts).toBe(6);
  await vi.advanceTimersByTimeAsync(2000);
  const line = lines.at(-1)!;
  line.onopen?.({} as Event);
  line.welcome();
  expect([connection.status, connection.attempts]).toEqual(['open', 0]);
  void connection.arm(1);
  expect(line.sent[0].id).toBe(2);
  // The wait is short again.
  line.breaks();
  await vi.advanceTimersByTimeAsync(250);
  expect(lines.at(-1)).not.toBe(line);
});

test('Connection_LostBeforeAnAnswer_AnswersTheOrderItself', async () => {
  const connection = connect();
  expect(await connection.arm(1)).toEqual({ accepted: false, reason: 'There is no connection.' });
  lines[0].welcome();
  const arm = connection.arm(1);
  lines[0].breaks();
  expect(await arm).toEqual({ accepted: false, reason: 'The connection was lost.' });
  expect(connection.controls.heldByYou).toBe(false);
});

test('Connection_ClosedWithAReason_AnswersWhatWaitsWithIt', async () => {
  const connection = connect();
  lines[0].welcome();
  const arm = connection.arm(1);
  lines[0].breaks('message: is damaged or cut short');
  expect(await arm).toEqual({ accepted: false, reason: 'message: is damaged or cut short' });
});

test.each([[401, 401], [403, 403], [426, 0], [0, 0]])('Connection_RefusedWith%i_Knows%i', async (status, known) => {
  const connection = new Connection({
    url: 'ws://nowhere/ws', open: () => { const line = new TestLine(); lines.push(line); return line; },
    why: () => (status > 0 ? Promise.resolve(status) : Promise.reject(new Error('nobody there'))),
  });
  connections.push(connection);
  lines[0].breaks();
  await vi.advanceTimersByTimeAsync(300);
  expect(connection.refusedWith).toBe(known);
  // It goes on trying: the next program may let it in.
  expect(lines).toHaveLength(2);
  lines[1].welcome();
  expect(connection.refusedWith).toBe(0);
});

test('Connection_OrderWithoutAnswer_IsGivenUp', async () => {
  const connection = connect();
  lines[0].welcome();
  const stop = connection.stop();
  await vi.advanceTimersByTimeAsync(2900);
  lines[0].say(Payload.WorldState, new WorldStateT());
  await vi.advanceTimersByTimeAsync(101);
  expect(await stop).toEqual({ accepted: false, reason: 'The program does not answer.' });
});

test('Connection_OtherSchemaVersion_IsRefusedForGood', async () => {
  const connection = connect();
  lines[0].say(Payload.Welcome, new WelcomeT(9, 1, true, '9.0'), 9);
  expect(connection.problem).toEqual({ theirs: 9, ours: SCHEMA_VERSION });
  expect([connection.status, lines[0].closed]).toEqual(['lost', true]);
  await vi.advanceTimersByTimeAsync(60_000);
  expect(lines).toHaveLength(1);
});

test('Connection_HoldingTheControls_BeatsAtLeastEvery100Ms', async () => {
  const connection = connect('secret');
  lines[0].welcome();
  await vi.advanceTimersByTimeAsync(500);
  expect(lines[0].sent).toHaveLength(0);
  const taken = connection.takeControls();
  expect((lines[0].sent[0].table.order(new TakeControls()) as TakeControls).token()).toBe('secret');
  lines[0].say(Payload.Reply, new ReplyT(lines[0].sent[0].id, true, ''));
  await taken;
  await vi.advanceTimersByTimeAsync(1000);
  const beats = lines[0].sent.filter(({ order }) => order === Order.Heartbeat);
  expect(beats.length).toBeGreaterThanOrEqual(10);
  expect(beats.every((beat, i) => i === 0 || beat.id > beats[i - 1].id)).toBe(true);
  lines[0].say(Payload.Controls, new ControlsT(false, true));
  const before = lines[0].sent.length;
  await vi.advanceTimersByTimeAsync(500);
  expect(lines[0].sent).toHaveLength(before);
});

test('Connection_SilentLine_CountsAsLost', async () => {
  const connection = connect();
  lines[0].welcome();
  await vi.advanceTimersByTimeAsync(3100);
  expect(connection.attempts).toBeGreaterThanOrEqual(1);
  expect(lines[0].closed).toBe(true);
});

test('Connection_PageThatWasBusy_DoesNotBlameTheLine', () => {
  const connection = connect();
  lines[0].welcome();
  // Eight seconds without a turn of the event loop; the first turn is a beat.
  vi.setSystemTime(Date.now() + 8000);
  const now = performance.now() + 8000;
  const spy = vi.spyOn(performance, 'now').mockReturnValue(now);
  vi.advanceTimersByTime(50);
  expect([connection.status, lines[0].closed]).toEqual(['open', false]);
  spy.mockRestore();
});

test('Connection_DamagedMessages_AreCountedAndChangeNothing', () => {
  const warn = vi.spyOn(console, 'warn').mockImplementation(() => {});
  const connection = connect();
  lines[0].welcome();
  lines[0].deliver(new ArrayBuffer(0));
  lines[0].deliver(new Uint8Array([1, 2, 3, 4, 88, 88, 88, 88, 0, 0, 0, 0]).buffer);
  lines[0].deliver('text');
  // A state whose payload is not there.
  lines[0].say(Payload.NONE, null);
  expect(connection.unreadable).toBe(4);
  expect(connection.latestState).toBeNull();
  expect([connection.status, warn.mock.calls.length]).toEqual(['open', 1]);
  warn.mockRestore();
});

test('SocketUrl_TakesTheTokenAndNoForeignServer', () => {
  const at = (search: string, hash = '') => ({ protocol: 'https:', host: 'bar.example:8080', search, hash });
  expect(socketUrl(at(''), false, 'player')).toBe('wss://bar.example:8080/ws?role=player');
  expect(socketUrl(at('?token=a%2Fb'), false, 'player')).toBe('wss://bar.example:8080/ws?role=player&token=a%2Fb');
  expect(tokenOf(at('', '#token=xyz'))).toBe('xyz');
  expect(socketUrl(at('?server=127.0.0.1:9000'), true, 'player')).toBe('wss://127.0.0.1:9000/ws?role=player');
  expect(socketUrl(at('?server=127.0.0.1:9000'), false, 'player')).toBe('wss://bar.example:8080/ws?role=player');
  expect(socketUrl(at('?server=evil.example'), true, 'player')).toBe('wss://bar.example:8080/ws?role=player');
});
