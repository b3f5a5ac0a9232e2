import { clamp } from './posture';
import type { InputWay, Wish } from './wish';
import { now_s, restingWish } from './wish';

/** Dead zone of sticks, which are rarely at zero at rest. */
const DEAD_ZONE = 0.15;
const SPEED_M_S = 0.15;

/** Reading of a gamepad. Standard mapping: sticks left x, left y, right x, right y (down positive); 6, 7: triggers. */
export interface PadReading {
  /** "standard"; with any other value the meaning of axes and buttons is unknown. */
  readonly mapping: string;
  axes: readonly number[];
  buttons: readonly { readonly value: number; readonly pressed: boolean }[];
}

/** A stick's deflection without its dead zone, -1 .. 1, with finer resolution near the middle. */
export function stick(value: number | undefined): number {
  const size = Math.abs(value ?? 0);
  if (!(size > DEAD_ZONE)) return 0;
  const part = clamp((size - DEAD_ZONE) / (1 - DEAD_ZONE), 0, 1);
  return Math.sign(value ?? 0) * part * part;
}

/** The wish of a gamepad; undefined while it is at rest, or if its mapping is unknown. */
export function wishOfPad(pad: PadReading): Wish | undefined {
  if (pad.mapping !== 'standard') return undefined;
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

/** A smaller change is noise; relative to the full range. */
const CHANGE = 0.05;

/** Speeds and squeeze of a wish, each relative to its full range. */
function partsOf(wish: Wish | undefined): readonly number[] {
  if (!wish) return [0, 0, 0, 0];
  const { velocity: { x, y, z }, squeeze } = wish;
  return [x / SPEED_M_S, y / SPEED_M_S, z / SPEED_M_S, Number(squeeze)];
}

/**
 * Finds the gamepads in use. A pad counts once it was seen at rest, so that a worn stick cannot
 * steer. It claims the steering only when it changes, so that a stuck one does not block other input.
 */
export class PadWatch {
  private readonly rested = new Set<number>();
  private claimed = partsOf(undefined);

  /** The present wish of the pads, and whether a person has just moved one. */
  look(pads: readonly (PadReading & { readonly index: number } | null)[]): { wish: Wish | undefined; claims: boolean } {
    let wish: Wish | undefined;
    for (const pad of pads) {
      if (pad?.mapping !== 'standard') continue;
      const asked = wishOfPad(pad);
      if (!asked) this.rested.add(pad.index);
      else if (this.rested.has(pad.index)) wish ??= asked;
    }
    const parts = partsOf(wish);
    const changed = parts.some((part, i) => Math.abs(part - this.claimed[i]) > CHANGE);
    if (changed) this.claimed = parts;
    return { wish, claims: changed && wish !== undefined };
  }

  /** Requires every pad to be seen at rest again. */
  forget(): void {
    this.rested.clear();
    this.claimed = partsOf(undefined);
  }
}

/** A gamepad: the left stick moves, the right stick lifts and lowers, a trigger squeezes as far as it is pulled. */
export class GamepadWay implements InputWay {
  readonly way = 'gamepad';
  private enabled = false;
  private readonly watch = new PadWatch();
  private asked: Wish | undefined;
  claimed_s = -Infinity;

  enable(): void {
    this.enabled = true;
    // A page in the background keeps receiving a pad's last reading.
    addEventListener('blur', this.letGo);
  }

  disable(): void {
    removeEventListener('blur', this.letGo);
    this.letGo();
    this.enabled = false;
    this.claimed_s = -Infinity;
  }

  // A button that stays held must be released before it counts again.
  yield(): void { this.letGo(); }

  /** Reads the pads: browsers send no events when a stick moves. */
  poll(): void {
    if (!this.enabled) return;
    const { wish, claims } = this.watch.look((navigator.getGamepads?.() ?? []).map((pad) => (pad?.connected ? pad : null)));
    this.asked = wish;
    if (claims) this.claimed_s = now_s();
  }

  wish(): Wish {
    return this.asked ?? restingWish();
  }

  private readonly letGo = (): void => {
    this.watch.forget();
    this.asked = undefined;
  };
}
