// The page of a commissioning: its display of the program's messages, and every way of releasing the hold button.
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { de } from '../src/commission/i18n/de';
import { en } from '../src/commission/i18n/en';
import { fr } from '../src/commission/i18n/fr';
import { HoldButton } from '../src/commission/hold_button';
import { numbers, repeatable, stepNow, taskOf, typedNumber } from '../src/commission/view';
import { Connection } from '../src/net/connection';
import type { Hands } from '../src/net/holding';
import { Answer, QuestionKind, CommissioningStepT, CommissioningT, ControlsT, HoldToMove, MotionKind, MotionState, Order, Payload, ReplyT, Role, StepState } from '../src/protocol';
import { TestConnection } from './test_connection';
import { testTexts } from './texts';

const hands = (heldByYou: boolean, held = heldByYou, role = Role.Therapist): Hands => ({ heldByYou, held, role, holder: Role.Unspecified, led: true });
const steps = (...states: StepState[]): CommissioningStepT[] => ['identify', 'home', 'signs'].map((name, i) => new CommissioningStepT(name, states[i] ?? StepState.Waiting));

function commissioning(change: Partial<CommissioningT>): CommissioningT {
  return Object.assign(new CommissioningT('rail', 'handled', 'H-1', '1', 'A', steps(StepState.UnderWay)), { motionState: MotionState.Over }, change);
}

describe('the task', () => {
  const task = (change: Partial<CommissioningT>, who = hands(true)): string => taskOf(commissioning(change), 'open', who, false);
  it.each([
    [QuestionKind.ThisDevice, 'yes-no'], [QuestionKind.NobodyAttached, 'yes-no'], [QuestionKind.PushAway, 'done'], [QuestionKind.EmergencyStop, 'done'],
    [QuestionKind.Travel, 'number'], [QuestionKind.KnownForce, 'number'], [QuestionKind.NextStep, 'next'],
  ])('of question %i is %s', (asked, wanted) => { expect(task({ asked })).toBe(wanted); });

  it('is to hold the button while a motion waits for it or moves, and between the moves of one step', () => {
    expect(task({ motionState: MotionState.AwaitsKey })).toBe('hold');
    expect(task({ motionState: MotionState.Moves })).toBe('hold');
    expect(task({ steps: steps(StepState.Done, StepState.Done, StepState.UnderWay) })).toBe('hold');
    expect(task({})).toBe('wait');
  });

  it('is offered only to the leader; other pages watch, and leading needs a press', () => {
    expect(task({ asked: QuestionKind.NobodyAttached }, hands(false, true))).toBe('watch');
    expect(task({ motionState: MotionState.AwaitsKey }, hands(false, false))).toBe('lead');
    expect(task({}, hands(false, false, Role.Watcher))).toBe('watch');
    expect(taskOf(null, 'open', hands(false), false)).toBe('connecting');
    expect(taskOf(null, 'open', hands(false), true)).toBe('elsewhere');
    expect(taskOf(commissioning({}), 'lost', hands(true), false)).toBe('lost');
    expect(taskOf(commissioning({ passport: 'mine.toml' }), 'lost', hands(false), false)).toBe('finished');
  });

  it('offers to repeat a step only after all earlier ones are done', () => {
    const c = commissioning({ steps: steps(StepState.Done, StepState.Failed, StepState.Done) });
    expect(repeatable(c)).toEqual(['identify']);
    expect(stepNow(c)).toBe(1);
  });
});

it('Numbers_OfAnInterval_HaveTheSameDecimals', () => {
  expect(numbers({ lower: 0.98, upper: 1.0211 }, 'to')).toBe('0.98 to 1.02');
  expect(numbers({ lower: -0.0004, upper: 0.01234 }, 'to')).toBe('−0.0004 to 0.0123');
  expect(numbers({ lower: 21.4, upper: 21.4 }, 'to')).toBe('21.4');
  expect(numbers({ lower: 0, upper: 0 }, 'to')).toBe('0');
});

it('TypedNumber_WithCommaOrUnit_IsReadOrRefused', () => {
  expect(['0,122', ' 0.122 ', '.5'].map(typedNumber)).toEqual(['0.122', '0.122', '.5']);
  expect(['0.122 m', '0', '-1', '', '1,000,0'].map(typedNumber)).toEqual(['', '', '', '', '']);
});

describe('the hold button', () => {
  class FakeElement extends EventTarget { setPointerCapture(): void { /* nothing is drawn here */ } }
  class FakeDocument extends EventTarget { hidden = false; }
  let element: FakeElement, page: FakeDocument, surroundings: EventTarget, button: HoldButton, allowed: boolean;
  let sent: [number, boolean][];
  let presses: number;

  beforeEach(() => {
    vi.useFakeTimers();
    [element, page, surroundings, allowed, sent] = [new FakeElement(), new FakeDocument(), new EventTarget(), true, []];
    presses = 0;
    button = new HoldButton(element as never, { window: surroundings, document: page }, {
      nextPress: () => ++presses, send: (press, held) => sent.push([press, held]), changed: () => { /* checked by `held` */ }, allowed: () => allowed,
    });
  });
  afterEach(() => { button.close(); vi.useRealTimers(); });

  const event = (name: string, more: object = {}): Event => Object.assign(new Event(name, { cancelable: true }), more);
  const pointer = (name: string, more: object = {}): void => { element.dispatchEvent(event(name, { pointerId: 3, button: 0, isPrimary: true, ...more })); };
  const key = (name: string, more: object = {}): void => { element.dispatchEvent(event(name, { code: 'Space', repeat: false, ...more })); };

  it('sends a heartbeat every 40 ms while it is held', () => {
    pointer('pointerdown');
    vi.advanceTimersByTime(1000);
    expect(sent).toHaveLength(26);
    expect(sent.every(([press, held]) => press === 1 && held)).toBe(true);
  });

  it.each<[string, () => void]>([
    ['pointerup', () => pointer('pointerup')],
    ['pointercancel', () => pointer('pointercancel')],
    ['lostpointercapture', () => pointer('lostpointercapture')],
    ['lost focus of the button', () => element.dispatchEvent(event('blur'))],
    ['lost focus of the window', () => surroundings.dispatchEvent(event('blur'))],
    ['a page that is left', () => surroundings.dispatchEvent(event('pagehide'))],
    ['a hidden page', () => { page.hidden = true; page.dispatchEvent(event('visibilitychange')); }],
    ['a page put to sleep', () => page.dispatchEvent(event('freeze'))],
    ['a lost line or lead', () => { allowed = false; vi.advanceTimersByTime(50); }],
    ['a question or a stop', () => button.end()],
    ['a page that hung for 200 ms', () => { vi.setSystemTime(Date.now() + 200); vi.spyOn(performance, 'now').mockReturnValue(performance.now() + 200); vi.advanceTimersByTime(50); vi.restoreAllMocks(); }],
  ])('is released once by %s, and stays released', (_name, lose) => {
    pointer('pointerdown');
    vi.advanceTimersByTime(100);
    lose();
    expect(button.held).toBe(false);
    expect(sent.at(-1)).toEqual([1, false]);
    const count = sent.length;
    vi.advanceTimersByTime(1000);
    expect(sent).toHaveLength(count);
    [allowed, page.hidden] = [true, false];
    pointer('pointerdown');
    expect(sent.at(-1), 'a new press has a new number').toEqual([2, true]);
  });

  it('is held by a key until that key is released, whatever keys repeat', () => {
    key('keydown');
    key('keydown', { repeat: true });
    key('keyup', { code: 'KeyA' });
    expect(button.held).toBe(true);
    key('keyup');
    expect(sent).toEqual([[1, true], [1, false]]);
    key('keydown', { repeat: true });
    expect(button.held, 'a key that was down before').toBe(false);
  });

  it('is not latched by a click, a second button or a second finger', () => {
    element.dispatchEvent(event('click'));
    pointer('pointerdown', { button: 2 });
    pointer('pointerdown', { isPrimary: false });
    expect(sent).toEqual([]);
    pointer('pointerdown');
    pointer('pointerup');
    element.dispatchEvent(event('click'));
    vi.advanceTimersByTime(500);
    expect(sent).toEqual([[1, true], [1, false]]);
  });
});

describe('messages to the program', () => {
  it('contain the number of the question that is answered, and of the press that is held', async () => {
    vi.useFakeTimers();
    const socket = new TestConnection();
    const connection = new Connection({ url: 'ws://nowhere/ws', open: () => socket });
    socket.welcome();
    socket.sendMessage(Payload.Controls, new ControlsT(true, true, Role.Therapist, Role.Therapist, true));
    socket.sendMessage(Payload.Commissioning, commissioning({ question: 7, asked: QuestionKind.Travel, unit: 'm', motion: MotionKind.Push }));
    expect(connection.commissioning?.question).toBe(7);
    const answered = connection.answer(7, '0.122');
    const { id, table } = socket.sent.find(({ order }) => order === Order.Answer)!;
    const answer = table.order(new Answer()) as Answer;
    expect([answer.question(), answer.text()]).toEqual([7, '0.122']);
    socket.sendMessage(Payload.Reply, new ReplyT(id, true, ''));
    expect((await answered).accepted).toBe(true);
    void connection.holdToMove(3, true);
    const hold = socket.sent.find(({ order }) => order === Order.HoldToMove)!.table.order(new HoldToMove()) as HoldToMove;
    expect([hold.press(), hold.held()]).toEqual([3, true]);
    connection.close();
    vi.useRealTimers();
  });
});

describe('the texts', () => {
  testTexts(en, de, fr);
  it('exist for every motion and step state of the schema', () => {
    const count = (of: object): number => Object.keys(of).length / 2;
    expect(en.motion).toHaveLength(count(MotionKind));
    expect(en.states).toHaveLength(count(StepState));
  });
});
