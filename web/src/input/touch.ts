import { clamp } from './posture';
import type { InputWay, Wish } from './wish';
import { now_s, restingWish } from './wish';

/** A finger that crosses this part of the picture's smaller side moves the hand through its range. */
const PLAY_PART = 0.6;
/** Speed while "higher" or "lower" is held [m/s]. */
const LIFT_M_S = 0.08;

export interface TouchWords {
  squeeze: string;
  higher: string;
  lower: string;
}

/** x and y, -1 .. 1, after a finger went (dx, dy) px from where the hand was (x, y). */
export function placeOfDrag(
  from: { x: number; y: number }, dx_px: number, dy_px: number, side_px: number,
): { x: number; y: number } {
  const whole_px = (side_px * PLAY_PART) / 2;
  return {
    x: clamp(from.x - dy_px / whole_px, -1, 1),
    y: clamp(from.y - dx_px / whole_px, -1, 1),
  };
}

/**
 * One finger drags the hand: sideways, and up for away. A second finger or the large button
 * squeezes; two small buttons lift and lower. The buttons appear with the first touch.
 */
export class Touch implements InputWay {
  readonly way = 'touch';
  claimed_s = -Infinity;
  private place: { x: number; y: number } | undefined;
  private drag: { id: number; x_px: number; y_px: number; from: { x: number; y: number } } | undefined;
  private readonly others = new Set<number>();
  private held = new Set<string>();
  private buttons: HTMLElement | undefined;

  /** `placeNow` says where the hand is, -1 .. 1 along x and y, when a finger comes down. */
  constructor(
    private readonly element: HTMLElement,
    private readonly placeNow: () => { x: number; y: number },
    private readonly words: () => TouchWords,
  ) {}

  enable(): void {
    this.element.addEventListener('pointerdown', this.down);
    this.element.addEventListener('pointermove', this.move);
    addEventListener('pointerup', this.up);
    addEventListener('pointercancel', this.up);
    // Without this the browser scrolls and zooms instead.
    this.element.style.touchAction = 'none';
  }

  disable(): void {
    this.element.removeEventListener('pointerdown', this.down);
    this.element.removeEventListener('pointermove', this.move);
    removeEventListener('pointerup', this.up);
    removeEventListener('pointercancel', this.up);
    this.element.style.touchAction = '';
    this.yield();
    this.buttons?.remove();
    this.buttons = undefined;
    this.claimed_s = -Infinity;
  }

  yield(): void {
    this.drag = undefined;
    this.place = undefined;
    this.others.clear();
    this.held.clear();
  }

  wish(): Wish {
    const lift = Number(this.held.has('higher')) - Number(this.held.has('lower'));
    return {
      ...restingWish(),
      velocity: { x: 0, y: 0, z: LIFT_M_S * lift },
      place: this.place ?? {},
      squeeze: this.others.size > 0 || this.held.has('squeeze'),
    };
  }

  private readonly down = (event: PointerEvent): void => {
    if (event.pointerType === 'mouse') return;
    this.claimed_s = now_s();
    this.showButtons();
    if (this.drag) {
      this.others.add(event.pointerId);
      return;
    }
    const from = this.place ?? this.placeNow();
    this.drag = { id: event.pointerId, x_px: event.clientX, y_px: event.clientY, from };
  };

  private readonly move = (event: PointerEvent): void => {
    if (event.pointerType === 'mouse') return;
    // A finger that was down before playing began drags from where it is now.
    if (!this.drag && !this.others.has(event.pointerId)) this.down(event);
    if (!this.drag || event.pointerId !== this.drag.id) return;
    this.claimed_s = now_s();
    const side_px = Math.min(this.element.clientWidth, this.element.clientHeight);
    const { x_px, y_px, from } = this.drag;
    this.place = placeOfDrag(from, event.clientX - x_px, event.clientY - y_px, side_px);
  };

  private readonly up = (event: PointerEvent): void => {
    this.others.delete(event.pointerId);
    if (event.pointerId === this.drag?.id) this.drag = undefined;
  };

  private showButtons(): void {
    if (this.buttons) return;
    this.buttons = document.createElement('div');
    this.buttons.className = 'touch-buttons';
    const words = this.words();
    for (const name of ['higher', 'lower', 'squeeze'] as const) {
      const button = document.createElement('button');
      button.type = 'button';
      button.className = `touch-${name}`;
      button.textContent = words[name];
      button.dataset.testid = `touch-${name}`;
      this.holdable(button, name);
      this.buttons.append(button);
    }
    (this.element.parentElement ?? document.body).append(this.buttons);
  }

  private holdable(button: HTMLButtonElement, name: string): void {
    const end = (): void => {
      this.held.delete(name);
    };
    button.addEventListener('pointerdown', (event) => {
      event.stopPropagation();
      button.setPointerCapture(event.pointerId);
      this.claimed_s = now_s();
      this.held.add(name);
    });
    for (const type of ['pointerup', 'pointercancel', 'blur'] as const) {
      button.addEventListener(type, end);
    }
  }
}
