import { CarryControl, isInPlace } from './carry_speed';
import { depthOf, INSIDE, isStacked, laneOf, ownGrip } from './guide';
import type { Perception } from './perceiver';
import { ROUND } from './posture';
import { Push } from './push';
import { Trigger } from './trigger';
import { dot, length, minus, plus, times } from './triple';
import { asksToSqueeze, type Help, type Triple, type Wish } from './wish';

/** The input of the pilot at one moment. Grips are device coordinates. */
export interface PilotInput extends Pick<Perception, 'grips' | 'awayFromUse' | 'onJoint' | 'pushes' | 'goesOn' | 'squeeze_n' | 'squeezeLow_n' | 'beside' | 'target' | 'letGo' | 'easesOff'> {
  /** Position of the hand [m]; lanes are chosen from here, not from the aim. */
  hand: Triple;
  /** Position of the aim [m]. */
  aim: Triple;
  /** x of a hand that is drawn back [m]. */
  back_m: number;
  /** Whether the hand can reach a grip. */
  reachable: (grip: Triple) => boolean;
  /** The hand is closed: it leaves only after it has opened. */
  closed: boolean;
}

/** The next movement of the hand, as a wish like that of pressed keys. */
export interface Course {
  wish: Wish;
  /** The chosen target, an index of the grips; undefined: none. */
  goal?: number;
  /** The hand leaves the row by itself. */
  leaving: boolean;
  /** The chosen target is out of reach. */
  outOfReach?: boolean;
  /** The target is carried with the hand. `holds`: it is only held, not squeezed. */
  carries?: boolean;
  holds?: boolean;
  /** The target is pushed: the hand stays open, with straight fingers. */
  pushes?: boolean;
}

/** Speed at which the hand is moved [m/s]. */
const SPEED_M_S = 0.16;
/** A cursor that stays on a target for this long asks for it [s]. */
const DWELL_S = 0.8;
/** The hand may enter within this distance of its lane [m]. */
const LANE_M = 0.012;
/** A hand within this lateral distance of a target's lane is near it [m]. */
const NEAR_M = 0.045;
const NEAR_HANDLE_M = 0.11;
/** A closing hand is at most this far from the grip, away from the person [m]. */
const AT_GRIP_M = 0.03;
/** Tolerance for a hand that is drawn back [m]. */
const BACK_AT_M = 0.004;
/** Speed of a target on a joint, and rate at which the hand slows down near its goal [m/s, 1/s]. */
const LED_M_S = 0.06;
const SLOWS_PER_S = 3;

/** Whether the grip force is in its range, or is eased for a moment. */
const isWell = ({ squeeze_n, squeezeLow_n, easesOff }: PilotInput): boolean => easesOff === true || (squeezeLow_n > 0 && squeeze_n >= squeezeLow_n);

/** Whether help regulates the force of a squeeze. With some help it does unless the person controls the degree. */
function keepsForce(squeeze: Wish['squeeze'], help: Help): boolean {
  return help === 'full' ? asksToSqueeze(squeeze) : help === 'some' && squeeze === true;
}

/**
 * Turns the intent "this target" into moves: out of the row if the hand is in
 * another lane, sideways in front of it, in, around the target, and out again. With full help it does all
 * of that; with some help, the last part once a squeeze is requested; without help, nothing.
 */
export class Pilot {
  private readonly trigger = new Trigger();
  private meant: number | undefined;
  private leaving = false;
  private cursor: number | undefined;
  private cursor_s = 0;
  /** A target that the cursor still points at when its task is done; it is not requested again by itself. */
  private stale: number | undefined;
  private tooFar = false;
  private over = false;
  private showing = false;
  private squeezed = false;
  /** It lets go in the middle of a task, and squeezes again for the same press. */
  private resumes = false;
  private push: Push | undefined;
  private carry: { readonly target: number; readonly carry: CarryControl } | undefined;

  /** A hand that is handed over opens and draws back, whatever it holds. */
  begin(): void {
    this.drop();
    this.leaving = true;
  }

  /** Demonstrates the next action once: goes to the target, or leaves. A person who moves or presses takes over. */
  show(): void {
    this.showing = true;
  }

  get shows(): boolean {
    return this.showing || this.leaving;
  }

  /** Cancels every request; a carried target falls. */
  drop(): void {
    this.release();
    this.carry = undefined;
  }

  /** Cancels every request; a carried target is put back. */
  release(): void {
    this.trigger.release();
    this.meant = this.cursor = this.stale = undefined;
    this.leaving = this.tooFar = this.over = this.squeezed = this.showing = this.resumes = false;
    this.push = undefined;
    this.cursor_s = 0;
  }

  /** It does something that was asked for, or demonstrates it. */
  get acts(): boolean {
    return this.meant !== undefined || this.carry !== undefined || this.resumes || this.shows;
  }

  steer(asked: Wish, sight: PilotInput, set: Help, dt_s: number): Course {
    const help = this.showing ? 'full' : set;
    const own = ownGrip(sight.grips, sight.hand, sight.beside);
    if (own === undefined) return { wish: asked, leaving: false };
    const inside = depthOf(sight.hand.x, sight.back_m, sight.grips[own]!) > INSIDE;
    if (this.carry) {
      const carried = this.carryOn(this.carry, asked, sight, dt_s);
      if (carried) return carried;
      this.finish(asked, true);
    }
    if (help === 'full' && sight.letGo && !this.over) {
      this.resumes = sight.goesOn === true && this.meant !== undefined;
      this.finish(asked, (inside && !(isStacked(sight.grips, own) && !sight.onJoint)) || this.push !== undefined);
    }
    this.over = sight.letGo;
    if (this.resumes && !sight.letGo && !this.leaving) {
      this.resumes = false;
      this.trigger.resume();
    }
    const same = this.meant !== undefined && this.meant === sight.target;
    const pressed = { taps: help === 'full', closed: sight.closed, same, well: same && isWell(sight) };
    const wish = { ...asked, squeeze: this.trigger.step(asked.squeeze, pressed, dt_s) };
    this.look(asked.pointed, dt_s);
    this.choose(wish, sight, own, help);
    if (this.leaving) return this.leave(wish, sight);
    if (help === 'full' && sight.letGo) wish.squeeze = false;
    if (sight.easesOff && keepsForce(wish.squeeze, help)) wish.squeeze = ROUND;
    if (help === 'full' && sight.pushes && this.meant === sight.target && this.meant !== undefined) return this.pushOn(wish, sight, sight.pushes, this.meant);
    this.push = undefined;
    if (help === 'none') return { wish, leaving: false };
    const away = this.meant === undefined ? undefined : sight.awayFromUse?.[this.meant], takes = help === 'full' && away !== undefined && sight.closed && asksToSqueeze(wish.squeeze);
    if (takes && sight.onJoint && this.meant !== undefined) return this.lead(wish, away, sight, this.meant);
    if (takes && this.meant !== undefined) {
      this.carry = { target: this.meant, carry: new CarryControl() };
    }
    if (this.tooFar) return { wish: { ...wish, squeeze: false }, leaving: false, outOfReach: true };
    return this.meant === undefined ? this.alone(wish, own, inside) : this.reach(wish, sight, own, inside, this.meant);
  }

  /** Pushes a target with straight fingers. */
  private pushOn(wish: Wish, { hand, aim, grips, back_m, awayFromUse }: PilotInput, toward: Triple, goal: number): Course {
    this.push ??= new Push();
    const velocity = this.push.step({ hand, aim, grip: grips[goal]!, back_m, toward, away: awayFromUse?.[goal] });
    return { wish: { ...wish, place: {}, velocity, squeeze: false }, goal, leaving: false, pushes: true };
  }

  /** Moves a held target along its joint. Across the path the aim returns to the grip: an aim that leaves a turning handle sideways would pull it out of the hand. */
  private lead(wish: Wish, away: Triple, { aim, grips }: PilotInput, goal: number): Course {
    const far_m = Math.max(length(away), 1e-6), off = minus(grips[goal]!, aim), across = minus(off, times(away, dot(off, away) / far_m ** 2));
    const velocity = plus(times(away, Math.min(SLOWS_PER_S, LED_M_S / far_m)), times(across, SLOWS_PER_S));
    return { wish: { ...wish, place: {}, velocity }, goal, leaving: false, carries: true };
  }

  /** Puts a carried target back before the hand lets go of it. Undefined: it is no longer carried. */
  private carryOn({ target, carry }: { readonly target: number; readonly carry: CarryControl }, asked: Wish, sight: PilotInput, dt_s: number): Course | undefined {
    this.over = sight.letGo;
    const away = sight.awayFromUse?.[target];
    const wants = this.trigger.step(asked.squeeze, { taps: true, closed: sight.closed, well: away !== undefined && isInPlace(away) && isWell(sight) }, dt_s);
    const { x, y, z } = asked.velocity, isLed = x !== 0 || y !== 0 || z !== 0;
    const move = away && carry.step({ ...sight, away, goesOn: asksToSqueeze(wants) && !sight.letGo }, dt_s);
    if (move) return { wish: { ...asked, place: {}, velocity: isLed ? asked.velocity : move.velocity, squeeze: true }, goal: target, leaving: false, carries: true, holds: move.hold };
    this.carry = undefined;
    return undefined;
  }

  /** Lets go of a target whose step is finished, and leaves. */
  private finish(asked: Wish, inside: boolean): void {
    this.trigger.finish();
    this.meant = undefined;
    this.stale = asked.pointed;
    if (inside && asked.velocity.x <= 0) this.leaving = true;
  }

  private look(pointed: number | undefined, dt_s: number): void {
    this.cursor_s = pointed === this.cursor ? this.cursor_s + dt_s : 0;
    this.cursor = pointed;
    if (pointed !== this.stale) this.stale = undefined;
  }

  /** Chooses the target. A person who moves the hand with keys chooses by the hand's position. */
  private choose(wish: Wish, sight: PilotInput, own: number, help: Help): void {
    const { x, y, z } = wish.velocity;
    const squeezes = asksToSqueeze(wish.squeeze);
    const before = this.squeezed;
    this.squeezed = squeezes && !sight.letGo;
    if (x !== 0 || y !== 0 || z !== 0) {
      this.meant = undefined;
      this.leaving = this.showing = false;
      return;
    }
    if (this.showing && sight.letGo) {
      this.showing = false;
      this.leaving = true;
    } else if (this.showing && this.meant === undefined && sight.target >= 0) this.meant = sight.target;
    const pointed = this.stale === undefined ? this.cursor : undefined;
    // A press requests the task's current target, wherever the cursor is, since full help does the right action.
    // Of two targets in one lane, a cursor beside them chooses none.
    const chosen = pointed ?? (wish.place.y !== undefined && !sight.onJoint && isStacked(sight.grips, own) ? undefined : own);
    const asked = sight.target >= 0 ? sight.target : chosen;
    const wanted = squeezes ? asked : pointed ?? asked;
    this.tooFar = help === 'full' && squeezes && wanted !== undefined && !sight.reachable(sight.grips[wanted]!);
    if (help === 'none' || sight.letGo) this.meant = undefined;
    else if (help === 'full') {
      const dwelt = pointed !== undefined && this.cursor_s >= DWELL_S;
      const says = squeezes ? !before || this.meant === undefined : dwelt;
      if (says && wanted !== undefined && sight.reachable(sight.grips[wanted]!)) this.meant = wanted;
    } else if (!squeezes) this.meant = undefined;
    else if (Math.abs(sight.hand.y - laneOf(sight.grips[own]!, sight.beside, sight.onJoint)) < (sight.onJoint ? NEAR_HANDLE_M : NEAR_M)) this.meant ??= own;
    if (this.meant !== undefined) this.leaving = false;
  }

  /** Moves out of the row if the hand is at another target, then in front of the chosen one, and in. */
  private reach(wish: Wish, sight: PilotInput, own: number, inside: boolean, goal: number): Course {
    const move = (velocity: Partial<Triple>, more: Partial<Wish> = {}): Course => (
      { wish: { ...wish, place: {}, velocity: { x: 0, y: 0, z: 0, ...velocity }, ...more }, goal, leaving: false });
    const grip = sight.grips[goal];
    if (!grip) return { wish, leaving: false };
    // A fist that moves in would jam between two targets: it opens first.
    if (sight.closed && own === goal && Math.abs(sight.hand.x - grip.x) > AT_GRIP_M) return move({}, { squeeze: false });
    if (inside && own !== goal && sight.grips[own] && isStacked([grip, sight.grips[own]], 0) && !sight.onJoint) return move({ x: sight.closed ? 0 : SPEED_M_S }, { squeeze: false });
    if (inside && own !== goal) return { ...move({ x: sight.closed ? 0 : -SPEED_M_S }, { squeeze: false }), goal: undefined };
    const aside_m = laneOf(grip, sight.beside, sight.onJoint) - sight.aim.y;
    if (inside || Math.abs(aside_m) <= LANE_M) return move({ x: SPEED_M_S });
    return move({ y: Math.sign(aside_m) * Math.min(SPEED_M_S, 6 * Math.abs(aside_m)) });
  }

  /** Inside the row a cursor on another target moves the hand out: sideways it would hit a target's side. */
  private alone(wish: Wish, own: number, inside: boolean): Course {
    if (!inside || wish.place.y === undefined) return { wish, leaving: false };
    if (wish.pointed !== undefined && wish.pointed !== own) return { wish: { ...wish, velocity: { x: -SPEED_M_S, y: 0, z: 0 }, place: {} }, leaving: false };
    return { wish: { ...wish, place: wish.place.x === undefined ? {} : { x: wish.place.x } }, leaving: false };
  }

  private leave(wish: Wish, { hand, aim, back_m, closed }: PilotInput): Course {
    this.push = undefined;
    if (hand.x <= back_m + BACK_AT_M || aim.x <= back_m) this.leaving = false;
    return { wish: { ...wish, velocity: { x: closed ? 0 : -SPEED_M_S, y: 0, z: 0 }, place: {}, squeeze: false }, leaving: true };
  }
}
