import { clamp } from './posture';
import type { InputWay, Triple, Wish } from './wish';
import { now_s, restingWish } from './wish';

/** The part of the picture's width and height that covers the whole workspace. */
const PLAY_PART = 0.7;
/** A shorter movement of the cursor does not start steering [px of travel]. */
const FIRST_TRAVEL_PX = 24;
const TRAVEL_FROM_ANOTHER_WAY_PX = 240;
/** Movement per notch of a wheel (100 px of scrolling), relative to half the depth. */
const DEPTH_PER_NOTCH = 0.12;

/** After any of these events the button may have been released. */
const ENDS = ['pointerup', 'pointercancel', 'lostpointercapture', 'contextmenu', 'blur'] as const;
/** Events of these that a person causes to end a press; after the others the press is cancelled. */
const LETS_GO = new Set<string>(['pointerup', 'lostpointercapture']);

/** y (left) and z (up), each -1 .. 1, at a point in the picture. */
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

/** Depth -1 .. 1 after scrolling; pages and lines are converted to pixels. */
export function depthAfterWheel(depth: number, delta: number, deltaMode: number): number {
  const pixels = delta * (deltaMode === 0 ? 1 : deltaMode === 1 ? 33 : 400);
  return clamp(depth - (pixels / 100) * DEPTH_PER_NOTCH, -1, 1);
}

/** The place at a point of the picture, along y and z, -1 .. 1, and the target there. */
export interface PointedPlace {
  y: number;
  z: number;
  target?: number;
}

/** The mouse: the cursor sets the hand's place in the picture, the wheel its depth; a button squeezes. */
export class Mouse implements InputWay {
  readonly way = 'mouse';
  claimed_s = -Infinity;
  private place: Partial<Triple> = {};
  private pointed: number | undefined;
  private squeeze = false;
  /** The button was pressed since the last look, so that a short click on a slow page counts. */
  private clicked = false;
  private stillToGo_px = FIRST_TRAVEL_PX;
  private last: { x_px: number; y_px: number } | undefined;

  /** @param depthNow returns the hand's position along x, -1 .. 1, when the wheel is first turned */
  constructor(
    private readonly element: HTMLElement,
    private readonly depthNow: () => number,
    /** The place at a point of the page; undefined: unknown, then positions relative to the picture's middle are used. */
    private readonly pointedAt: (x_px: number, y_px: number) => PointedPlace | undefined = () => undefined,
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

  /** The cursor is an absolute place; only the wheel accumulates. */
  overruled({ x }: Readonly<Partial<Triple>>): void {
    if (x !== undefined && this.place.x !== undefined) this.place = { ...this.place, x };
  }

  private readonly move = (event: PointerEvent): void => {
    if (event.pointerType !== 'mouse') return;
    // The button was released without an event: over a menu, in another window.
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
