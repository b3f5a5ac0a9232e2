import type { InputWay, Wish } from './wish';
import { now_s, restingWish } from './wish';

/** Speed of the aim while a key is held [m/s]; the aim model limits it further. */
const SPEED_M_S = 0.12;

type Move = 'away' | 'near' | 'left' | 'right' | 'up' | 'down' | 'squeeze';

/** Moves by `KeyboardEvent.code`: the position on the keyboard counts, not the printed letter. */
const KEYS: Readonly<Record<string, Move>> = {
  ArrowUp: 'away', KeyW: 'away',
  ArrowDown: 'near', KeyS: 'near',
  ArrowLeft: 'left', KeyA: 'left',
  ArrowRight: 'right', KeyD: 'right',
  KeyR: 'up', PageUp: 'up',
  KeyF: 'down', PageDown: 'down',
  Space: 'squeeze',
};

/** Whether the focused element uses a key: for typing, sliders, or pressing a button. */
function keyBelongsTo(target: EventTarget | null, code: string): boolean {
  if (!(target instanceof Element)) return false;
  if (target.closest('input, select, textarea, [contenteditable], [role=slider]')) return true;
  return code === 'Space' && target.closest('button, a, summary, [role=button], [role=tab]') !== null;
}

/** The wish of the held keys. */
export function wishOfMoves(held: ReadonlySet<Move>): Wish {
  const one = (plus: Move, minus: Move): number =>
    SPEED_M_S * (Number(held.has(plus)) - Number(held.has(minus)));
  return {
    ...restingWish(),
    velocity: { x: one('away', 'near'), y: one('left', 'right'), z: one('up', 'down') },
    squeeze: held.has('squeeze'),
  };
}

/** The keyboard: arrows or WASD move, R and F (or Page up and down) lift and lower, Space squeezes while held. */
export class Keys implements InputWay {
  readonly way = 'keys';
  private readonly held = new Map<string, Move>();
  /** Space was pressed since the last look, so that a short tap on a slow page counts. */
  private tapped = false;
  claimed_s = -Infinity;

  enable(): void {
    addEventListener('keydown', this.down);
    addEventListener('keyup', this.up);
    addEventListener('blur', this.letGo);
  }

  disable(): void {
    removeEventListener('keydown', this.down);
    removeEventListener('keyup', this.up);
    removeEventListener('blur', this.letGo);
    this.letGo();
    this.claimed_s = -Infinity;
  }

  yield(): void {
    this.letGo();
  }

  wish(): Wish {
    const moves = new Set(this.held.values());
    if (this.tapped) moves.add('squeeze');
    this.tapped = false;
    return wishOfMoves(moves);
  }

  private readonly down = (event: KeyboardEvent): void => {
    const move = KEYS[event.code];
    if (!move || event.ctrlKey || event.altKey || event.metaKey) return;
    if (keyBelongsTo(event.target, event.code)) return;
    event.preventDefault();
    this.held.set(event.code, move);
    this.tapped ||= move === 'squeeze' && !event.repeat;
    this.claimed_s = now_s();
  };

  private readonly up = (event: KeyboardEvent): void => {
    this.held.delete(event.code);
  };

  // A key that is released in another window sends no event here.
  private readonly letGo = (): void => {
    this.held.clear();
    this.tapped = false;
  };
}
