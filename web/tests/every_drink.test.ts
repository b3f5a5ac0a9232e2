// A drink by every way of playing with full help, by a person who does only what the screen says, on the simulated
// clock. WHOLEHAND_FULL=1: both hands, every level of both bars, and four screens for who points.
import { PerspectiveCamera } from 'three';
import { afterEach, expect, it, vi } from 'vitest';
import { barOf, Stage } from '../src/exercises/cocktail_bar/bar';
import { outlineOf } from '../src/exercises/cocktail_bar/outline';
import { partOfAxis } from '../src/input/axis_range';
import { Keys } from '../src/input/keys';
import { Mouse, type Pointed } from '../src/input/mouse';
import { PadWatch } from '../src/input/gamepad';
import { clamp } from '../src/input/posture';
import { Touch } from '../src/input/touch';
import { restingWish, type InputWay, type Wish } from '../src/input/wish';
import { placeCamera, pointInRow } from '../src/scene/camera';
import { toThree } from '../src/scene/frames';
import { Player } from './player';
import { LOOK_S, SteeredHand } from './steered_hand';

const FULL = process.env.WHOLEHAND_FULL === '1';
/** A drink with full help takes no longer. */
const DRINK_S = 60;
/** A person presses when it has been said for this long, and lets go again. */
const PRESS_FROM_S = 1;
const PRESS_TO_S = 1.2;

interface Screen { readonly width: number; readonly height: number }
const DESKTOP: Screen = { width: 1280, height: 800 };
const SCREENS: readonly Screen[] = [DESKTOP, { width: 1920, height: 1080 }, { width: 820, height: 1180 }, { width: 390, height: 844 }];
interface Place { readonly side: string; readonly exercise: string; readonly level: number; readonly screen: Screen }
const LEVELS: readonly [string, number][] = [1, 2, 3, 4].map((level) => ['cocktail-bar', level] as [string, number]);
const FREE_LEVELS: readonly [string, number][] = [['cocktail-bar-free', 1], ['cocktail-bar-free', 2]];
const PLACES: readonly Place[] = !FULL ? [{ side: 'right', exercise: 'cocktail-bar', level: 1, screen: DESKTOP }]
  : ['right', 'left'].flatMap((side) => [...LEVELS, ...FREE_LEVELS].flatMap(([exercise, level]) => SCREENS.map((screen) => ({ side, exercise, level, screen }))));

/** A way of playing, and what presses its button where the screen has something. */
interface Played extends Partial<Pick<InputWay, 'enable' | 'disable' | 'overruled'>> {
  readonly name: string;
  wish(now_s: number): Wish;
  readonly points: boolean;
  press(down: boolean, at: { clientX: number; clientY: number }): void;
}

const eventOf = (type: string, more: object): Event => Object.assign(new Event(type), { button: 0, buttons: 1, isPrimary: true, pointerId: 1, ...more });

/** The game's picture of the bar, and a page without a page. */
class Picture {
  readonly camera = new PerspectiveCamera();
  readonly window = new EventTarget();
  readonly page: EventTarget;
  private readonly row_z: number;

  constructor(readonly hand: SteeredHand, readonly screen: Screen) {
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

  /** Where the bottle is drawn that the screen asks for [px]. */
  wanted(): { clientX: number; clientY: number } {
    const { hand, screen } = this;
    const at = toThree(hand.state.bodies[hand.bodyOf(hand.value('target_dispenser'))]!.positionM!).project(this.camera);
    return { clientX: (at.x * 0.5 + 0.5) * screen.width, clientY: (0.5 - at.y * 0.5) * screen.height };
  }

  /** Where the hand is along an axis, -1 .. 1. */
  part(name: string): number {
    const i = this.hand.axes.findIndex((axis) => axis.name === name);
    return partOfAxis(this.hand.axes[i]!, this.hand.state.qM[i]!);
  }

  /** What the page makes of a point of it. */
  pointedAt(x_px: number, y_px: number): Pointed {
    const { hand, screen } = this;
    const at = pointInRow(this.camera, this.row_z, x_px / screen.width, y_px / screen.height)!;
    const palm = hand.perceiver.palmAt(hand.state, at)!;
    const part = (name: 'y' | 'z'): number => clamp(partOfAxis(hand.axes.find((axis) => axis.name === name)!, palm[name]), -1, 1);
    return { y: part('y'), z: part('z'), target: hand.perceiver.targetAt(hand.state, at.y_m) };
  }
}

function waysOf(picture: Picture): Played[] {
  const { page, window } = picture, element = page as unknown as HTMLElement;
  const pointedAt = (x_px: number, y_px: number): Pointed => picture.pointedAt(x_px, y_px);
  const keys = new Keys(), mouse = new Mouse(element, () => 0, pointedAt);
  const touch = new Touch(element, () => ({ x: picture.part('x'), y: picture.part('y') }), () => ({ squeeze: '', higher: '', lower: '' }), (x, y) => pointedAt(x, y).target, () => true);
  Object.assign(touch, { buttons: { remove: () => {} } });
  const pads = new PadWatch();
  let padDown = false, tapped = false;
  const button = (pressed: boolean): { value: number; pressed: boolean } => ({ value: Number(pressed), pressed });
  const padWish = (): Wish => pads.look([{ index: 0, mapping: 'standard', axes: [0, 0, 0, 0], buttons: [button(padDown)] }]).wish ?? restingWish();
  const pointer = (way: Mouse | Touch, name: string, pointerType: string): Played => ({
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

/** Plays from the beginning until a drink is done; how long that took [s]. */
async function drink(hand: SteeredHand, picture: Picture, way: Played): Promise<number> {
  const player = new Player(hand, 'full');
  way.enable?.();
  let t = 0, reaching_s = 0, down = false;
  const done = (): boolean => t > 0.1 && (hand.value('stage') === Stage.DrinkDone || hand.value('stage') === Stage.LevelDone);
  for (; t < DRINK_S && !done(); t += LOOK_S) {
    reaching_s = hand.value('stage') === Stage.Reach ? reaching_s + LOOK_S : 0;
    const presses = reaching_s > PRESS_FROM_S && reaching_s < PRESS_TO_S;
    if (presses !== down) way.press(presses, picture.wanted());
    down = presses;
    await player.look(way.wish(t), t === 0);
    way.overruled?.(player.model.overruled);
  }
  way.disable?.();
  return t;
}

const open: SteeredHand[] = [];
afterEach(() => { for (const hand of open.splice(0)) hand.stop(); vi.unstubAllGlobals(); });

it.each(PLACES)('every way mixes a drink: $side hand, $exercise level $level, $screen.width × $screen.height', async ({ side, exercise, level, screen }) => {
  const hand = await SteeredHand.start(level, exercise, `adult-median-${side}`);
  open.push(hand);
  const picture = new Picture(hand, screen), took: string[] = [], failed: string[] = [];
  for (const way of waysOf(picture)) {
    if (screen !== DESKTOP && !way.points) continue;
    const t = await drink(hand, picture, way);
    const words = `${way.name} ${t.toFixed(1)} s`;
    took.push(words);
    if (t >= DRINK_S || hand.value('stars') < 3) failed.push(`${words}, stage ${hand.value('stage')}, ${hand.value('stars')} stars, spilt ${hand.value('spilt_l')} l`);
  }
  console.log(`figure: a drink, ${side}, ${exercise} ${level}, ${screen.width} × ${screen.height}: ${took.join(', ')}`);
  expect(failed).toEqual([]);
}, 600_000);
