import { clamp } from './posture';
import type { InputWay, Triple, Wish } from './wish';
import { now_s, restingWish } from './wish';

/** A drag across this part of the picture's smaller side moves the hand through its range. */
const PLAY_PART = 0.6;
/** A finger that moved less than this counts as still [px]. */
const STILL_PX = 14;
/** Speed while "higher" or "lower" is held [m/s]. */
const LIFT_M_S = 0.08;

export interface TouchWords {
  squeeze: string;
  higher: string;
  lower: string;
}

/** Requested place of the hand, relative to the ranges along x and y, -1 .. 1. */
export interface DraggedPlace {
  x: number;
  y: number;
}

/**
 * A finger that drags the hand: its displacement counts, not its position. If the help moves
 * the hand meanwhile, the finger drags it on from there, independent of its own past.
 */
export class Drag {
  private at_px: { x: number; y: number };

  constructor(readonly pointerId: number, x_px: number, y_px: number, private asked: DraggedPlace) {
    this.at_px = { x: x_px, y: y_px };
  }

  get place(): DraggedPlace {
    return this.asked;
  }

  /** The finger moved to (x, y) [px] in a picture whose smaller side is `side_px`. */
  moveTo(x_px: number, y_px: number, side_px: number): void {
    const whole_px = (side_px * PLAY_PART) / 2;
    this.asked = {
      x: clamp(this.asked.x - (y_px - this.at_px.y) / whole_px, -1, 1),
      y: clamp(this.asked.y - (x_px - this.at_px.x) / whole_px, -1, 1),
    };
    this.at_px = { x: x_px, y: y_px };
  }

  overruled(places: Readonly<Partial<DraggedPlace>>): void {
    this.asked = { x: places.x ?? this.asked.x, y: places.y ?? this.asked.y };
  }
}

/**
 * Touch: one finger drags the hand sideways, and upwards for away. A second finger or the large button
 * squeezes; two small buttons lift and lower. The buttons appear with the first touch.
 */
export class Touch implements InputWay {
  readonly way = 'touch';
  claimed_s = -Infinity;
  /** Kept when the finger is lifted: the hand waits at the requested place. */
  private drag: Drag | undefined;
  private dragging = false;
  /** Type of the dragging pointer: pen or touch. */
  private kind = '';
  private readonly others = new Set<number>();
  /** Position of the last finger while it has not moved; it presses what is under it. */
  private still: { x_px: number; y_px: number } | undefined;
  /** Something was pressed since the last look, so that a short tap on a slow page counts. */
  private tapped = false;
  private pointed: number | undefined;
  private held = new Set<string>();
  private buttons: HTMLElement | undefined;

  /** @param placeNow returns the hand's position, -1 .. 1 along x and y, when a finger comes down */
  constructor(
    private readonly element: HTMLElement,
    private readonly placeNow: () => DraggedPlace,
    private readonly words: () => TouchWords,
    /** The target at a point of the page. */
    private readonly targetAt: (x_px: number, y_px: number) => number | undefined = () => undefined,
    /** Whether a still finger presses; else it only drags. */
    private readonly presses: () => boolean = () => false,
    /** Whether the buttons are needed: they cover a part of the picture. */
    private readonly needsButtons: () => boolean = () => true,
  ) {}

  enable(): void {
    this.element.addEventListener('pointerdown', this.down);
    this.element.addEventListener('pointermove', this.move);
    addEventListener('pointerup', this.up);
    addEventListener('pointercancel', this.up);
    addEventListener('blur', this.letGo);
    // Without this the browser would scroll and zoom instead.
    this.element.style.touchAction = 'none';
  }

  disable(): void {
    this.element.removeEventListener('pointerdown', this.down);
    this.element.removeEventListener('pointermove', this.move);
    removeEventListener('pointerup', this.up);
    removeEventListener('pointercancel', this.up);
    removeEventListener('blur', this.letGo);
    this.element.style.touchAction = '';
    this.yield();
    this.removeButtons();
    this.claimed_s = -Infinity;
  }

  yield(): void {
    this.drag = this.pointed = undefined;
    this.letGo();
  }

  wish(): Wish {
    const tapped = this.tapped;
    this.tapped = false;
    const lift = Number(this.held.has('higher')) - Number(this.held.has('lower'));
    return {
      ...restingWish(),
      velocity: { x: 0, y: 0, z: LIFT_M_S * lift },
      place: this.still || tapped ? {} : this.drag?.place ?? {},
      // A still finger requests a target; while it drags the hand, the target of the drag counts.
      pointed: this.pointed,
      squeeze: this.others.size > 0 || this.held.has('squeeze') || this.still !== undefined || tapped,
    };
  }

  overruled(places: Readonly<Partial<Triple>>): void {
    this.drag?.overruled(places);
  }

  private readonly down = (event: PointerEvent): void => {
    if (event.pointerType === 'mouse') return;
    this.claimed_s = now_s();
    if (this.needsButtons()) this.showButtons();
    else this.removeButtons();
    // The first pointer of its type: an earlier one has ended without an event.
    if (event.isPrimary && event.pointerType === this.kind) this.letGo();
    if (this.dragging) {
      // A hand that rests beside a pen does not squeeze, nor does a pen beside a finger.
      if (event.pointerType !== this.kind) return;
      this.others.add(event.pointerId);
      this.tapped = true;
      return;
    }
    this.kind = event.pointerType;
    if (this.presses()) {
      this.still = { x_px: event.clientX, y_px: event.clientY };
      this.pointed = this.targetAt(event.clientX, event.clientY);
      this.tapped = true;
    }
    this.drag = new Drag(event.pointerId, event.clientX, event.clientY, this.drag?.place ?? this.placeNow());
    this.dragging = true;
  };

  private readonly move = (event: PointerEvent): void => {
    // A hovering pen does not touch.
    if (event.pointerType === 'mouse' || event.buttons === 0) return;
    // A finger that was down before playing began drags from its present position.
    if (!this.dragging && !this.others.has(event.pointerId)) this.down(event);
    if (!this.dragging || event.pointerId !== this.drag?.pointerId) return;
    this.claimed_s = now_s();
    if (this.still && Math.hypot(event.clientX - this.still.x_px, event.clientY - this.still.y_px) < STILL_PX) return;
    if (this.still) this.tapped = false;
    this.still = this.pointed = undefined;
    this.drag.moveTo(event.clientX, event.clientY, Math.min(this.element.clientWidth, this.element.clientHeight));
  };

  private readonly up = (event: PointerEvent): void => {
    this.others.delete(event.pointerId);
    if (event.type === 'pointercancel') this.tapped = false;
    if (event.pointerId !== this.drag?.pointerId) return;
    this.dragging = false;
    this.still = undefined;
  };

  private readonly letGo = (): void => {
    this.dragging = false;
    this.still = undefined;
    this.tapped = false;
    this.others.clear();
    this.held.clear();
  };

  private removeButtons(): void {
    this.buttons?.remove();
    this.buttons = undefined;
  }

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
      this.tapped ||= name === 'squeeze';
    });
    for (const type of ['pointerup', 'pointercancel', 'lostpointercapture', 'blur'] as const) {
      button.addEventListener(type, end);
    }
  }
}
