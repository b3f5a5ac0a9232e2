import { clamp } from './posture';
import type { InputWay, Triple, Wish } from './wish';
import { now_s, restingWish } from './wish';

/** The part of the picture's width and height that covers the whole workspace. */
const PLAY_PART = 0.7;
/** A cursor that crosses the picture by chance is not a wish to play [px of travel]. */
const FIRST_TRAVEL_PX = 24;
const TRAVEL_FROM_ANOTHER_WAY_PX = 240;
/** How far one notch of a wheel (100 px of scrolling) goes, in parts of half the depth. */
const DEPTH_PER_NOTCH = 0.12;

/** After any of these nobody holds the button for sure. */
const ENDS = ['pointerup', 'pointercancel', 'lostpointercapture', 'contextmenu', 'blur'] as const;
/** Of these, what a person does to end a press; after the others nobody wants it. */
const LETS_GO = new Set<string>(['pointerup', 'lostpointercapture']);

/** y (left) and z (up), each -1 .. 1, of a point in the picture. */
export function placeOfPointer(
  x_px: number, y_px: number, box: { left: number; top: number; width: number; height: number },
): { y: number; z: number } {
  const across = (x_px - box.left) / box.width - 0.5;
  const down = (y_px - box.top) / box.height - 0.5;
  return {
    y: clamp(-across / (PLAY_PART / 2), -1, 1),
    z: clamp(-down / (PLAY_PART / 2), -1, 1),
  };
}

/** Depth -1 .. 1 after scrolling; pages and lines count as the pixels they stand for. */
export function depthAfterWheel(depth: number, delta: number, deltaMode: number): number {
  const pixels = delta * (deltaMode === 0 ? 1 : deltaMode === 1 ? 33 : 400);
  return clamp(depth - (pixels / 100) * DEPTH_PER_NOTCH, -1, 1);
}

/** What a point of the picture stands for: a place along y and z, -1 .. 1, and the target that is there. */
export interface Pointed {
  y: number;
  z: number;
  target?: number;
}

/** The cursor is the hand's place in the picture; the wheel goes away and near; a button squeezes. */
export class Mouse implements InputWay {
  readonly way = 'mouse';
  claimed_s = -Infinity;
  private place: Partial<Triple> = {};
  private pointed: number | undefined;
  private squeeze = false;
  /** The button came down since the last look: a click between two looks of a slow page is one, too. */
  private clicked = false;
  private stillToGo_px = FIRST_TRAVEL_PX;
  private last: { x_px: number; y_px: number } | undefined;

  /** `depthNow` says where the hand is along x, -1 .. 1, when the wheel is first turned. */
  constructor(
    private readonly element: HTMLElement,
    private readonly depthNow: () => number,
    /** What is drawn at a point of the page; undefined: nobody knows, and the picture's own middle counts. */
    private readonly pointedAt: (x_px: number, y_px: number) => Pointed | undefined = () => undefined,
  ) {}

  enable(): void {
    this.element.addEventListener('pointermove', this.move);
    this.element.addEventListener('pointerdown', this.press);
    this.element.addEventListener('wheel', this.wheel, { passive: false });
    for (const type of ENDS) addEventListener(type, this.release);
  }

  disable(): void {
    this.element.removeEventListener('pointermove', this.move);
    this.element.removeEventListener('pointerdown', this.press);
    this.element.removeEventListener('wheel', this.wheel);
    for (const type of ENDS) removeEventListener(type, this.release);
    this.yield();
    this.stillToGo_px = FIRST_TRAVEL_PX;
    this.claimed_s = -Infinity;
  }

  yield(): void {
    this.place = {};
    this.pointed = undefined;
    this.squeeze = this.clicked = false;
    this.stillToGo_px = TRAVEL_FROM_ANOTHER_WAY_PX;
  }

  wish(): Wish {
    const squeeze = this.squeeze || this.clicked;
    this.clicked = false;
    return { ...restingWish(), place: this.place, pointed: this.pointed, squeeze };
  }

  /** The cursor is a place; only the wheel adds up. */
  overruled({ x }: Readonly<Partial<Triple>>): void {
    if (x !== undefined && this.place.x !== undefined) this.place = { ...this.place, x };
  }

  private readonly move = (event: PointerEvent): void => {
    if (event.pointerType !== 'mouse') return;
    // A button that was released without an event: over a menu, in another window.
    if ((event.buttons & 1) === 0) this.squeeze = false;
    const { last } = this;
    this.last = { x_px: event.clientX, y_px: event.clientY };
    if (last) this.stillToGo_px -= Math.hypot(event.clientX - last.x_px, event.clientY - last.y_px);
    if (this.stillToGo_px <= 0) this.point(event);
  };

  private point(event: PointerEvent): void {
    this.stillToGo_px = 0;
    this.claimed_s = now_s();
    const seen = this.pointedAt(event.clientX, event.clientY);
    const { y, z } = seen ?? placeOfPointer(event.clientX, event.clientY, this.element.getBoundingClientRect());
    this.place = { ...this.place, y, z };
    this.pointed = seen?.target;
  }

  private readonly press = (event: PointerEvent): void => {
    if (event.pointerType !== 'mouse' || event.button !== 0) return;
    this.point(event);
    this.element.setPointerCapture(event.pointerId);
    this.squeeze = this.clicked = true;
  };

  private readonly release = ({ type }: Event): void => {
    this.squeeze = false;
    if (!LETS_GO.has(type)) this.clicked = false;
  };

  private readonly wheel = (event: WheelEvent): void => {
    if (event.ctrlKey) return;
    event.preventDefault();
    this.claimed_s = now_s();
    const from = this.place.x ?? this.depthNow();
    this.place = { ...this.place, x: depthAfterWheel(from, event.deltaY, event.deltaMode) };
  };
}
