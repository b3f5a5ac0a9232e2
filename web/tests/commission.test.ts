// The page of a commissioning: what it shows of what the program says, and every way of letting go of the button.
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { de } from '../src/commission/i18n/de';
import { en } from '../src/commission/i18n/en';
import { fr } from '../src/commission/i18n/fr';
import { HoldButton } from '../src/commission/hold_button';
import { numbers, repeatable, stepNow, taskOf, typedNumber } from '../src/commission/view';
import { Connection } from '../src/net/connection';
import type { Hands } from '../src/net/holding';
import { Answer, Asked, CommissioningStepT, CommissioningT, ControlsT, HoldToMove, MotionKind, MotionState, Order, Payload, ReplyT, Role, StepState } from '../src/protocol';
import { TestLine } from './test_line';
import { testTexts } from './texts';

const hands = (heldByYou: boolean, held = heldByYou, role = Role.Therapist): Hands => ({ heldByYou, held, role, holder: Role.Unsaid, led: true });
const steps = (...states: StepState[]): CommissioningStepT[] => ['identify', 'home', 'signs'].map((name, i) => new CommissioningStepT(name, states[i] ?? StepState.Waiting));

function said(change: Partial<CommissioningT>): CommissioningT {
  return Object.assign(new CommissioningT('rail', 'handled', 'H-1', '1', 'A', steps(StepState.UnderWay)), { motionState: MotionState.Over }, change);
}

describe('the task', () => {
  const task = (change: Partial<CommissioningT>, who = hands(true)): string => taskOf(said(change), 'open', who, false);
  it.each([
    [Asked.ThisDevice, 'yes-no'], [Asked.NobodyAttached, 'yes-no'], [Asked.PushAway, 'done'], [Asked.EmergencyStop, 'done'],
    [Asked.Travel, 'number'], [Asked.KnownForce, 'number'], [Asked.NextStep, 'next'],
  ])('of question %i is %s', (asked, wanted) => { expect(task({ asked })).toBe(wanted); });

  it('is to hold while a motion awaits the key or moves, and between the moves of one step', () => {
    expect(task({ motionState: MotionState.AwaitsKey })).toBe('hold');
    expect(task({ motionState: MotionState.Moves })).toBe('hold');
    expect(task({ steps: steps(StepState.Done, StepState.Done, StepState.UnderWay) })).toBe('hold');
    expect(task({})).toBe('wait');
  });

  it('is only the leader\'s: others watch, and nothing is led without a press', () => {
    expect(task({ asked: Asked.NobodyAttached }, hands(false, true))).toBe('watch');
    expect(task({ motionState: MotionState.AwaitsKey }, hands(false, false))).toBe('lead');
    expect(task({}, hands(false, false, Role.Watcher))).toBe('watch');
    expect(taskOf(null, 'open', hands(false), false)).toBe('connecting');
    expect(taskOf(null, 'open', hands(false), true)).toBe('elsewhere');
    expect(taskOf(said({}), 'lost', hands(true), false)).toBe('lost');
    expect(taskOf(said({ passport: 'mine.toml' }), 'lost', hands(false), false)).toBe('finished');
  });

  it('offers to repeat only what has everything before it', () => {
    const c = said({ steps: steps(StepState.Done, StepState.Failed, StepState.Done) });
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

describe('the held button', () => {
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
      nextPress: () => ++presses, send: (press, held) => sent.push([press, held]), changed: () => { /* looked at by `held` */ }, allowed: () => allowed,
    });
  });
  afterEach(() => { button.close(); vi.useRealTimers(); });

  const event = (name: string, more: object = {}): Event => Object.assign(new Event(name, { cancelable: true }), more);
  const pointer = (name: string, more: object = {}): void => { element.dispatchEvent(event(name, { pointerId: 3, button: 0, isPrimary: true, ...more })); };
  const key = (name: string, more: object = {}): void => { element.dispatchEvent(event(name, { code: 'Space', repeat: false, ...more })); };

  it('beats every 40 ms for as long as it is held', () => {
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
  ])('is let go by %s, once, and stays so', (_name, lose) => {
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

  it('is held by a key until that key comes up, whatever it repeats', () => {
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

describe('what is said to the program', () => {
  it('names the question that is answered, and the press that is held', async () => {
    vi.useFakeTimers();
    const line = new TestLine();
    const connection = new Connection({ url: 'ws://nowhere/ws', open: () => line });
    line.welcome();
    line.say(Payload.Controls, new ControlsT(true, true, Role.Therapist, Role.Therapist, true));
    line.say(Payload.Commissioning, said({ question: 7, asked: Asked.Travel, unit: 'm', motion: MotionKind.Push }));
    expect(connection.commissioning?.question).toBe(7);
    const answered = connection.answer(7, '0.122');
    const { id, table } = line.sent.find(({ order }) => order === Order.Answer)!;
    const answer = table.order(new Answer()) as Answer;
    expect([answer.question(), answer.text()]).toEqual([7, '0.122']);
    line.say(Payload.Reply, new ReplyT(id, true, ''));
    expect((await answered).accepted).toBe(true);
    void connection.holdToMove(3, true);
    const hold = line.sent.find(({ order }) => order === Order.HoldToMove)!.table.order(new HoldToMove()) as HoldToMove;
    expect([hold.press(), hold.held()]).toEqual([3, true]);
    connection.close();
    vi.useRealTimers();
  });
});

describe('the texts', () => {
  testTexts(en, de, fr);
  it('have a word for every motion and step state of the schema', () => {
    const count = (of: object): number => Object.keys(of).length / 2;
    expect(en.motion).toHaveLength(count(MotionKind));
    expect(en.states).toHaveLength(count(StepState));
  });
});
