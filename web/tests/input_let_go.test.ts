// Every loss of the input opens the hand, and unheld inputs request nothing.
import { afterEach, beforeEach, describe, expect, it, vi } from 'vitest';
import { AimModel } from '../src/input/aim_model';
import { Controls } from '../src/input/controls';
import { PadWatch, wishOfPad, type PadReading } from '../src/input/gamepad';
import { Keys } from '../src/input/keys';
import { Mouse } from '../src/input/mouse';
import { postureOf } from '../src/input/posture';
import { Touch } from '../src/input/touch';
import { PictureWatch } from '../src/input/webcam';
import { restingWish } from '../src/input/wish';
import type { Connection } from '../src/net/connection';
import { AxisT, RunState, SceneT, Steering, WorldStateT } from '../src/protocol';

const WINDOW = new EventTarget();
beforeEach(() => {
  vi.stubGlobal('addEventListener', WINDOW.addEventListener.bind(WINDOW));
  vi.stubGlobal('removeEventListener', WINDOW.removeEventListener.bind(WINDOW));
});
afterEach(() => { vi.unstubAllGlobals(); vi.useRealTimers(); });

class Picture extends EventTarget {
  readonly style: Record<string, string> = {};
  clientWidth = 1000;
  clientHeight = 600;
  parentElement = null;
  setPointerCapture(): void {}
  getBoundingClientRect(): object { return { left: 0, top: 0, width: 1000, height: 600 }; }
}
const event = (type: string, more: object = {}): Event => Object.assign(new Event(type), { buttons: 1, button: 0, isPrimary: true, pointerId: 1, clientX: 500, clientY: 300, ...more });

describe('loss of the input', () => {
  let tellScene: (reported: SceneT) => void;
  /** A person who has closed the hand with Space; the axes are the robot's. */
  function closing(): { controls: Controls; aims: number[][]; emit: (name: string) => void; state: WorldStateT; connection: { controls: { heldByYou: boolean } } } {
    vi.useFakeTimers();
    vi.stubGlobal('Element', class {});
    vi.stubGlobal('navigator', {});
    const scene = new SceneT();
    for (const [name, upper] of [['x', 0.085], ['finger_flexion', Math.PI], ['thumb_flexion', 1.4]] as const) {
      const axis = new AxisT();
      Object.assign(axis, { name, lower: name === 'x' ? -0.085 : 0, upper });
      scene.axes.push(axis);
    }
    const state = new WorldStateT();
    Object.assign(state, { runState: RunState.Rendering, steering: Steering.Person, qM: [0, 1.2, 0], intention: [0, 1.2, 0] });
    const aims: number[][] = [];
    const listeners = new Map<string, (value: unknown) => void>();
    const connection = {
      scene, latestState: state, status: 'open', controls: { heldByYou: true, held: true }, taken: 0,
      on: (name: string, callback: (value: unknown) => void) => { listeners.set(name, callback); return () => {}; },
      aim: (q: number[]) => { aims.push(q); return Promise.resolve({ accepted: true, reason: '' }); },
      takeControls() { this.taken += 1; return Promise.resolve({ accepted: true, reason: '' }); },
      steered: 0,
      steer() { this.steered += 1; return Promise.resolve({ accepted: true, reason: '' }); },
    };
    const controls = new Controls(connection as unknown as Connection, new Picture() as unknown as HTMLElement);
    controls.enable();
    WINDOW.dispatchEvent(Object.assign(event('keydown'), { code: 'Space' }));
    vi.advanceTimersByTime(2500);
    expect(aims.at(-1)![1]).toBeGreaterThan(2.5);
    tellScene = (reported) => listeners.get('scene')?.(reported);
    return { controls, aims, emit: (name) => listeners.get(name)?.(undefined), state, connection };
  }
  /** Fingers at most half bent, and the thumb straight: nothing is squeezed. */
  function expectOpen(aim: readonly number[]): void {
    expect(aim[1]).toBeLessThanOrEqual(postureOf('finger_flexion', 0) + 1e-9);
    expect(aim[2]).toBe(0);
  }

  it('by a card over the play opens the hand at once', () => {
    const { controls, aims } = closing();
    controls.disable();
    expectOpen(aims.at(-1)!);
    const before = aims.length;
    vi.advanceTimersByTime(1000);
    expect(aims).toHaveLength(before);  // requested once: the program keeps the last aim
  });

  it('by leaving the page opens the hand before the page is silent', () => {
    const { controls, aims, emit } = closing();
    emit('leaving');
    expectOpen(aims.at(-1)!);
    controls.disable();
  });

  it('by another window opens the hand at its usual rate', () => {
    const { controls, aims } = closing();
    WINDOW.dispatchEvent(new Event('blur'));
    vi.advanceTimersByTime(1000);
    expectOpen(aims.at(-1)!);
    controls.disable();
  });

  it('does not happen when a therapist saves a profile, which sends the same scene again', () => {
    const { controls, aims, connection } = closing();
    const { scene } = connection as unknown as { scene: SceneT };
    const before = aims.length;
    tellScene(Object.assign(new SceneT(), scene, { profile: 'anna', recording: 'a.h5' }));
    vi.advanceTimersByTime(1000);
    expect(aims.length).toBeGreaterThan(before);
    for (const aim of aims.slice(before)) expect(aim[1]).toBeGreaterThan(2.5);
    controls.disable();
  });

  it('sends nothing on a real device, whose hand is the person\'s own', () => {
    const { controls, aims, state, connection } = closing();
    state.intention = [];
    state.steering = Steering.VirtualPatient;
    const before = aims.length;
    WINDOW.dispatchEvent(Object.assign(event('keydown'), { code: 'Space' }));
    vi.advanceTimersByTime(3000);
    expect([aims.length, (connection as unknown as { steered: number }).steered]).toEqual([before, 0]);
    controls.disable();
  });

  it('by a camera or a pad that is gone opens the hand at once, and sends no more requests', () => {
    const { controls, aims } = closing();
    // The calls of Webcam and GamepadWay.
    for (const way of (controls as unknown as { ways: { claimed_s: number }[] }).ways) way.claimed_s = -Infinity;
    vi.advanceTimersByTime(20);
    expectOpen(aims.at(-1)!);
    const before = aims.length;
    vi.advanceTimersByTime(1000);
    expect(aims).toHaveLength(before);
    controls.disable();
  });

  it('by the program is not undone by a key that is still held', () => {
    const { controls, aims, connection } = closing();
    connection.controls = { heldByYou: false };
    const before = aims.length;
    WINDOW.dispatchEvent(Object.assign(event('keydown'), { code: 'Space' }));
    vi.advanceTimersByTime(3000);
    expect([aims.length, (connection as unknown as { taken: number }).taken]).toEqual([before, 0]);
    controls.disable();
  });

  // The withdrawal is tested in steered_hand.test.ts; there is no bottle here.
  it('is not needed for a hand that is taken over in a grip: it opens before the first input', () => {
    const { controls, aims, state } = closing();
    controls.disable();
    state.qM = state.intention = [0.05, 2.5, 1];
    aims.length = 0;
    controls.enable();
    for (let k = 0; k < 250; k += 1) {
      vi.advanceTimersByTime(16);
      state.qM = aims.at(-1) ?? state.qM;   // a device that follows
    }
    expectOpen(aims.at(-1)!);
    controls.disable();
  });

  it('keeps an open hand that nobody closed in its posture', () => {
    const model = new AimModel([{ name: 'finger_flexion', lower: 0, upper: Math.PI }]);
    model.begin([postureOf('finger_flexion', 0)]);
    model.step(restingWish(), { device: [1], grips: [], beside: 1, squeeze_n: 0, squeezeLow_n: 4, squeezeHigh_n: 8, target: -1, letGo: false, touches: [] }, 0.016);
    const before = [...model.aim];
    model.open();
    expect(model.aim).toEqual(before);
  });
});

describe('a gamepad', () => {
  const pad = (axes: number[], more: Partial<PadReading> = {}, trigger = 0): PadReading & { index: number } => ({
    mapping: 'standard', index: 0, axes, buttons: Array.from({ length: 17 }, (_, i) => ({ value: i === 7 ? trigger : 0, pressed: false })), ...more,
  });

  it('without the standard mapping is ignored: its axes may be pedals that rest at -1', () => {
    expect(wishOfPad(pad([-1, -1, -1, -1], { mapping: '' }))).toBeUndefined();
    const watch = new PadWatch();
    expect(watch.look([pad([0, 0, 0, 0], { mapping: '' })]).wish).toBeUndefined();
    expect(watch.look([pad([-1, -1, -1, -1], { mapping: '' })])).toEqual({ wish: undefined, claims: false });
  });

  it('counts only after it was seen at rest, so that a defective stick does not steer', () => {
    const worn = new PadWatch();
    for (let i = 0; i < 100; i += 1) expect(worn.look([pad([0.4, 0, 0, 0])])).toEqual({ wish: undefined, claims: false });
    const good = new PadWatch();
    good.look([null, pad([0.05, 0, 0, 0])]);
    expect(good.look([null, pad([0, -1, 0, 0])]).wish?.velocity.x).toBe(0.15);
  });

  it('claims the steering when it changes, but not while it is stuck', () => {
    const watch = new PadWatch();
    watch.look([pad([0, 0, 0, 0])]);
    expect(watch.look([pad([0, -1, 0, 0])]).claims).toBe(true);
    for (let i = 0; i < 100; i += 1) expect(watch.look([pad([0, -1 + 0.001 * (i % 2), 0, 0])]).claims).toBe(false);
    expect(watch.look([pad([0, 0, 0, 0])]).claims).toBe(false);
    expect(watch.look([pad([0, 0, 0, 0], {}, 0.8)]).claims).toBe(true);
  });

  it('that is held when the input is lost must be released first', () => {
    const watch = new PadWatch();
    watch.look([pad([0, 0, 0, 0])]);
    expect(watch.look([pad([0, 0, 0, 0], {}, 1)]).wish?.squeeze).toBe(1);
    watch.forget();
    expect(watch.look([pad([0, 0, 0, 0], {}, 1)]).wish).toBeUndefined();
    watch.look([pad([0, 0, 0, 0])]);
    expect(watch.look([pad([0, 0, 0, 0], {}, 1)]).wish?.squeeze).toBe(1);
  });
});

describe('a press that began and ended between two looks of a slow page', () => {
  it('counts for key, mouse and finger, unless it was cancelled', () => {
    vi.stubGlobal('Element', class {});
    const keys = new Keys();
    keys.enable();
    for (const type of ['keydown', 'keyup']) WINDOW.dispatchEvent(Object.assign(new Event(type), { code: 'Space' }));
    expect([keys.wish().squeeze, keys.wish().squeeze]).toEqual([true, false]);
    keys.disable();
    const picture = new Picture();
    const mouse = new Mouse(picture as unknown as HTMLElement, () => 0);
    mouse.enable();
    for (const [ends, seen] of [['pointerup', true], ['pointercancel', false], ['blur', false]] as const) {
      picture.dispatchEvent(event('pointerdown', { pointerType: 'mouse' }));
      WINDOW.dispatchEvent(new Event(ends));
      expect([mouse.wish().squeeze, mouse.wish().squeeze], ends).toEqual([seen, false]);
    }
    mouse.disable();
    const touch = new Touch(picture as unknown as HTMLElement, () => ({ x: 0, y: 0 }), () => ({ squeeze: '', higher: '', lower: '' }), () => 2, () => true);
    Object.assign(touch, { buttons: { remove: () => {} } });
    touch.enable();
    for (const [ends, seen] of [['pointerup', true], ['pointercancel', false], ['blur', false]] as const) {
      picture.dispatchEvent(event('pointerdown', { pointerType: 'touch' }));
      WINDOW.dispatchEvent(event(ends, { pointerType: 'touch' }));
      expect([touch.wish().squeeze, touch.wish().squeeze], ends).toEqual([seen, false]);
    }
    touch.disable();
  });
});

describe('a mouse', () => {
  it.each(['pointercancel', 'lostpointercapture', 'blur', 'contextmenu'])('stops squeezing after %s', (type) => {
    const picture = new Picture();
    const mouse = new Mouse(picture as unknown as HTMLElement, () => 0);
    mouse.enable();
    picture.dispatchEvent(event('pointerdown', { pointerType: 'mouse' }));
    expect(mouse.wish().squeeze).toBe(true);
    WINDOW.dispatchEvent(new Event(type));
    expect(mouse.wish().squeeze).toBe(false);
    mouse.disable();
  });

  it('stops squeezing if its button was released without an event', () => {
    const picture = new Picture();
    const mouse = new Mouse(picture as unknown as HTMLElement, () => 0);
    mouse.enable();
    picture.dispatchEvent(event('pointerdown', { pointerType: 'mouse' }));
    picture.dispatchEvent(event('pointermove', { pointerType: 'mouse' }));
    expect(mouse.wish().squeeze).toBe(true);
    picture.dispatchEvent(event('pointermove', { pointerType: 'mouse', buttons: 0 }));
    expect(mouse.wish().squeeze).toBe(false);
    mouse.disable();
  });
});

describe('a finger', () => {
  function touched(): { picture: Picture; touch: Touch } {
    const picture = new Picture();
    const touch = new Touch(picture as unknown as HTMLElement, () => ({ x: 0, y: 0 }), () => ({ squeeze: '', higher: '', lower: '' }));
    Object.assign(touch, { buttons: { remove: () => {} } });  // the buttons need a document
    touch.enable();
    return { picture, touch };
  }
  it('shows buttons only while they are needed, since they cover a part of the picture', () => {
    const picture = new Picture();
    let needed = false, made = 0, removed = 0;
    const touch = new Touch(picture as unknown as HTMLElement, () => ({ x: 0, y: 0 }), () => ({ squeeze: '', higher: '', lower: '' }), () => 2, () => true, () => needed);
    const buttons = { remove: () => { removed += 1; } };
    Object.assign(touch, { showButtons: () => { made += 1; Object.assign(touch, { buttons }); } });  // the buttons need a document
    touch.enable();
    const seen: (readonly number[])[] = [];
    for (const now of [false, true, false]) {
      needed = now;
      picture.dispatchEvent(event('pointerdown', { pointerType: 'touch' }));
      WINDOW.dispatchEvent(event('pointerup', { pointerType: 'touch' }));
      seen.push([made, removed]);
    }
    expect(seen).toEqual([[0, 0], [1, 0], [1, 1]]);
    touch.disable();
  });

  const pen = { pointerType: 'pen', pointerId: 9 };
  const finger = (pointerId: number, isPrimary: boolean): object => ({ pointerType: 'touch', pointerId, isPrimary });

  it('after a hovering pen drags, and does not squeeze', () => {
    const { picture, touch } = touched();
    picture.dispatchEvent(event('pointermove', { ...pen, buttons: 0 }));
    picture.dispatchEvent(event('pointerdown', finger(1, true)));
    picture.dispatchEvent(event('pointermove', { ...finger(1, true), clientX: 464 }));
    expect(touch.wish()).toMatchObject({ squeeze: false, place: { x: 0, y: 0.2 } });  // 36 of 180 px to the left
    touch.disable();
  });

  it('or the side of a hand beside a dragging pen does not squeeze; a second finger does', () => {
    const { picture, touch } = touched();
    picture.dispatchEvent(event('pointerdown', pen));
    picture.dispatchEvent(event('pointerdown', finger(1, true)));
    expect(touch.wish().squeeze).toBe(false);
    WINDOW.dispatchEvent(event('pointerup', pen));
    WINDOW.dispatchEvent(event('pointerup', finger(1, true)));
    picture.dispatchEvent(event('pointerdown', finger(2, true)));
    picture.dispatchEvent(event('pointerdown', finger(3, false)));
    expect(touch.wish().squeeze).toBe(true);
    WINDOW.dispatchEvent(new Event('blur'));
    expect(touch.wish().squeeze).toBe(false);
    touch.disable();
  });

  it('without an end event is forgotten with the next first finger', () => {
    const { picture, touch } = touched();
    picture.dispatchEvent(event('pointerdown', finger(1, true)));
    picture.dispatchEvent(event('pointerdown', finger(2, true)));
    expect(touch.wish().squeeze).toBe(false);
    touch.disable();
  });
});

describe('a camera', () => {
  it('that is unplugged, muted or frozen gives no new pictures', () => {
    class Stream { track = { readyState: 'live', muted: false }; getVideoTracks(): object[] { return [this.track]; } }
    vi.stubGlobal('MediaStream', Stream);
    const stream = new Stream();
    const video = { currentTime: 1, srcObject: stream as unknown as MediaStream };
    const watch = new PictureWatch();
    expect([watch.isNew(video), watch.isNew(video)]).toEqual([true, false]);
    video.currentTime = 2;
    stream.track.muted = true;
    expect(watch.isNew(video)).toBe(false);
    stream.track.muted = false;
    expect(watch.isNew(video)).toBe(true);
    video.currentTime = 3;
    stream.track.readyState = 'ended';
    expect(watch.isNew(video)).toBe(false);
  });
});
