// Every input method, used in front of the game's picture of the bar, without a real page.
import { PerspectiveCamera } from 'three';
import { vi } from 'vitest';
import { barOf } from '../src/exercises/cocktail_bar/bar';
import { outlineOf } from '../src/exercises/cocktail_bar/outline';
import { partOfAxis } from '../src/input/axis_range';
import { Keys } from '../src/input/keys';
import { Mouse, type PointedPlace } from '../src/input/mouse';
import { PadWatch } from '../src/input/gamepad';
import { clamp } from '../src/input/posture';
import { Touch } from '../src/input/touch';
import { restingWish, type InputWay, type Wish } from '../src/input/wish';
import { placeCamera, pointInRow } from '../src/scene/camera';
import { toThree } from '../src/scene/frames';
import type { PlayedHand } from './player';

export interface Screen { readonly width: number; readonly height: number }
export const DESKTOP: Screen = { width: 1280, height: 800 };

/** An input method, and the press of its button at a place of the screen. */
export interface PlayingWay extends Partial<Pick<InputWay, 'enable' | 'disable' | 'overruled'>> {
  readonly name: string;
  wish(now_s: number): Wish;
  readonly points: boolean;
  press(down: boolean, at: { clientX: number; clientY: number }): void;
}

const eventOf = (type: string, more: object): Event => Object.assign(new Event(type), { button: 0, buttons: 1, isPrimary: true, pointerId: 1, ...more });

/** The game's picture of the bar. */
export class Picture {
  readonly camera = new PerspectiveCamera();
  readonly window = new EventTarget();
  readonly page: EventTarget;
  private readonly row_z: number;

  constructor(readonly hand: PlayedHand, readonly screen: Screen) {
    const { scene, state } = hand, bar = barOf(scene)!;
    this.row_z = toThree(state.bodies[hand.bodyOf(0)]!.positionM!).z;
    placeCamera(this.camera, 'game', { right: scene.rightHand, counter_y: bar.counter_z_m, row_z: this.row_z }, outlineOf(bar, scene, state), screen.width, screen.height);
    this.camera.updateMatrixWorld(true);
    const { width, height } = screen;
    this.page = Object.assign(new EventTarget(), { style: {}, clientWidth: width, clientHeight: height, setPointerCapture() {}, getBoundingClientRect: () => ({ left: 0, top: 0, width, height }) });
    vi.stubGlobal('addEventListener', this.window.addEventListener.bind(this.window));
    vi.stubGlobal('removeEventListener', this.window.removeEventListener.bind(this.window));
    vi.stubGlobal('Element', class {});
  }

  /** Position of the current bottle in the picture [px]. */
  wanted(): { clientX: number; clientY: number } {
    const { hand, screen } = this;
    const at = toThree(hand.state.bodies[hand.bodyOf(hand.value('target_dispenser'))]!.positionM!).project(this.camera);
    return { clientX: (at.x * 0.5 + 0.5) * screen.width, clientY: (0.5 - at.y * 0.5) * screen.height };
  }

  /** Position of the hand along an axis, -1 .. 1. */
  part(name: string): number {
    const i = this.hand.axes.findIndex((axis) => axis.name === name);
    return partOfAxis(this.hand.axes[i]!, this.hand.state.qM[i]!);
  }

  /** The page's interpretation of a point in it. */
  pointedAt(x_px: number, y_px: number): PointedPlace {
    const { hand, screen } = this;
    const at = pointInRow(this.camera, this.row_z, x_px / screen.width, y_px / screen.height)!;
    const palm = hand.perceiver.palmAt(hand.state, at)!;
    const part = (name: 'y' | 'z'): number => clamp(partOfAxis(hand.axes.find((axis) => axis.name === name)!, palm[name]), -1, 1);
    return { y: part('y'), z: part('z'), target: hand.perceiver.targetAt(hand.state, at) };
  }
}

export function waysOf(picture: Picture): PlayingWay[] {
  const { page, window } = picture, element = page as unknown as HTMLElement;
  const pointedAt = (x_px: number, y_px: number): PointedPlace => picture.pointedAt(x_px, y_px);
  const keys = new Keys(), mouse = new Mouse(element, () => 0, pointedAt);
  const touch = new Touch(element, () => ({ x: picture.part('x'), y: picture.part('y') }), () => ({ squeeze: '', higher: '', lower: '' }), (x, y) => pointedAt(x, y).target, () => true);
  Object.assign(touch, { buttons: { remove: () => {} } });
  const pads = new PadWatch();
  let padDown = false, tapped = false;
  const button = (pressed: boolean): { value: number; pressed: boolean } => ({ value: Number(pressed), pressed });
  const padWish = (): Wish => pads.look([{ index: 0, mapping: 'standard', axes: [0, 0, 0, 0], buttons: [button(padDown)] }]).wish ?? restingWish();
  const pointer = (way: Mouse | Touch, name: string, pointerType: string): PlayingWay => ({
    name, points: true, enable: () => way.enable(), disable: () => way.disable(), wish: () => way.wish(), overruled: (places) => way.overruled(places),
    press: (down, at) => void (down ? page : window).dispatchEvent(eventOf(down ? 'pointerdown' : 'pointerup', { pointerType, ...at })),
  });
  return [
    { name: 'one button', points: false, wish: () => ({ ...restingWish(), squeeze: tapped }), press: (down) => { tapped = down; } },
    { name: 'keys', points: false, enable: () => keys.enable(), disable: () => keys.disable(), wish: () => keys.wish(),
      press: (down) => void window.dispatchEvent(Object.assign(new Event(down ? 'keydown' : 'keyup'), { code: 'Space' })) },
    pointer(mouse, 'mouse', 'mouse'),
    pointer(touch, 'touch', 'touch'),
    { name: 'pad', points: false, wish: padWish, press: (down) => { padDown = down; } },
  ];
}
