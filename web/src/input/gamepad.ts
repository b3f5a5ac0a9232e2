import { clamp } from './posture';
import type { InputWay, Wish } from './wish';
import { now_s, restingWish } from './wish';

/** Sticks at rest are rarely at zero. */
const DEAD_ZONE = 0.15;
const SPEED_M_S = 0.15;

/** Standard mapping: sticks left x, left y, right x, right y (down positive); 6, 7: triggers. */
export interface PadReading {
  axes: readonly number[];
  buttons: readonly { readonly value: number; readonly pressed: boolean }[];
}

/** A stick's deflection without its dead zone, -1 .. 1, finer near the middle. */
export function stick(value: number | undefined): number {
  const size = Math.abs(value ?? 0);
  if (!(size > DEAD_ZONE)) return 0;
  const part = clamp((size - DEAD_ZONE) / (1 - DEAD_ZONE), 0, 1);
  return Math.sign(value ?? 0) * part * part;
}

/** What a game pad asks for; undefined while nothing on it is moved. */
export function wishOfPad(pad: PadReading): Wish | undefined {
  const trigger = Math.max(pad.buttons[6]?.value ?? 0, pad.buttons[7]?.value ?? 0);
  const held = pad.buttons[0]?.pressed ?? false;
  const velocity = {
    x: 0 - SPEED_M_S * stick(pad.axes[1]),
    y: 0 - SPEED_M_S * stick(pad.axes[0]),
    z: 0 - SPEED_M_S * stick(pad.axes[3]),
  };
  const moved = velocity.x !== 0 || velocity.y !== 0 || velocity.z !== 0;
  if (!moved && !held && trigger < 0.05) return undefined;
  return { ...restingWish(), velocity, squeeze: held ? true : trigger };
}

/** Left stick moves, right stick lifts and lowers, a trigger squeezes as far as it is pulled. */
export class GamepadWay implements InputWay {
  readonly way = 'gamepad';
  private enabled = false;
  claimed_s = -Infinity;

  enable(): void {
    this.enabled = true;
  }

  disable(): void {
    this.enabled = false;
    this.claimed_s = -Infinity;
  }

  // A pad holds nothing: what it asks for is read anew each time.
  yield(): void {}

  /** Pads are looked at here: browsers do not tell when a stick moves. */
  poll(): void {
    if (this.enabled && this.read()) this.claimed_s = now_s();
  }

  wish(): Wish {
    return this.read() ?? restingWish();
  }

  private read(): Wish | undefined {
    for (const pad of navigator.getGamepads?.() ?? []) {
      const wish = pad?.connected ? wishOfPad(pad) : undefined;
      if (wish) return wish;
    }
    return undefined;
  }
}
