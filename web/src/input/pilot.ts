import { Carry, isInPlace } from './carry';
import { depthOf, INSIDE, laneOf, ownGrip } from './guide';
import { ROUND } from './posture';
import { Push } from './push';
import { Trigger } from './trigger';
import { asksToSqueeze, type Help, type Triple, type Wish } from './wish';

/** What the pilot looks at in a moment. Grips are device coordinates. */
export interface Sight {
  /** Where the hand is [m]: lanes are chosen from here, not from where it is aimed. */
  hand: Triple;
  /** Where it is aimed [m]. */
  aim: Triple;
  /** x of the hand drawn back [m]. */
  back_m: number;
  grips: readonly Triple[];
  /** How far each target that is carried is from where it is squeezed [m]. */
  awayFromUse?: readonly (Triple | undefined)[];
  /** Targets are on joints: one is led to its use while it is held, and never lifted. */
  onJoint?: boolean;
  /** The target that is asked for is pushed with straight fingers: where to. */
  pushes?: Triple;
  /** There is more to do once it was let go of. */
  goesOn?: boolean;
  squeeze_n: number;
  squeezeLow_n: number;
  /** Which side of the hand a target is gripped on: +1 left (a right hand), -1 right. */
  beside: number;
  /** The target that is asked for, an index of `grips`; -1: none. */
  target: number;
  /** Which of `grips` the hand can come to. */
  reachable: (grip: Triple) => boolean;
  /** The hand is closed: it leaves when it has opened. */
  closed: boolean;
  /** Nothing is to be held now: the step has enough, the row moves, or the task is done. */
  letGo: boolean;
  /** What is held is to be eased, and squeezed again after it. */
  easesOff?: boolean;
}

/** What the hand is to do now, as if a person had pressed keys for it. */
export interface Course {
  wish: Wish;
  /** The target that is meant, an index of the grips; undefined: none. */
  goal?: number;
  /** The hand is on its way out of the row by itself. */
  leaving: boolean;
  /** The target that is asked for is out of reach. */
  outOfReach?: boolean;
  /** The target is carried: it is where the hand is. It is only held, or squeezed. */
  carries?: boolean;
  holds?: boolean;
  /** It is pushed: the hand stays open, with straight fingers. */
  pushes?: boolean;
}

/** Speed at which the hand is taken along [m/s]. */
const SPEED_M_S = 0.16;
/** A cursor that stays on a target for this long asks for it [s]. */
const DWELL_S = 0.8;
/** Nearer than this to its lane the hand may go in [m]. */
const LANE_M = 0.012;
/** A hand this far sideways from a target's lane is near it [m]. */
const NEAR_M = 0.045;
const NEAR_HANDLE_M = 0.11;
/** A hand that closes is no farther from the grip than this, away from the person [m]. */
const AT_GRIP_M = 0.03;
/** Drawn back, to within this [m]. */
const BACK_AT_M = 0.004;
/** How fast a target on a joint is led, and how soon the hand slows down [m/s, 1/s]. */
const LED_M_S = 0.06;
const SLOWS_PER_S = 3;

/** What is held is squeezed well, or eased for a moment. */
const isWell = ({ squeeze_n, squeezeLow_n, easesOff }: Sight): boolean => easesOff === true || (squeezeLow_n > 0 && squeeze_n >= squeezeLow_n);

/** Whether help keeps the force of a squeeze. With some help it does where the person does not say how far. */
function keepsForce(squeeze: Wish['squeeze'], help: Help): boolean {
  return help === 'full' ? asksToSqueeze(squeeze) : help === 'some' && squeeze === true;
}

/**
 * "This target" is one intent. The pilot turns it into moves: out of the row where the hand is in
 * another lane, sideways in front of it, in, round the target, and out again. With full help it does all
 * of that, with some the last bit once a squeeze is asked for, with none nothing.
 */
export class Pilot {
  private readonly trigger = new Trigger();
  private meant: number | undefined;
  private leaving = false;
  private cursor: number | undefined;
  private cursor_s = 0;
  /** A target that the cursor was left on when its work was done: it is not asked for again by itself. */
  private stale: number | undefined;
  private tooFar = false;
  private over = false;
  private showing = false;
  private squeezed = false;
  /** It lets go in the middle of a task, for the same press. */
  private resumes = false;
  private push: Push | undefined;
  private carry: { readonly target: number; readonly carry: Carry } | undefined;

  /** A hand that is handed over opens and draws back, whatever it holds. */
  begin(): void {
    this.drop();
    this.leaving = true;
  }

  /** Shows what to do next, once: goes to the target, or leaves. A person who moves or presses takes over. */
  show(): void {
    this.showing = true;
  }

  get shows(): boolean {
    return this.showing || this.leaving;
  }

  /** Nobody asks for anything any more, and what is carried falls. */
  drop(): void {
    this.release();
    this.carry = undefined;
  }

  /** Nobody asks for anything any more; what is carried is put back. */
  release(): void {
    this.trigger.release();
    this.meant = this.cursor = this.stale = undefined;
    this.leaving = this.tooFar = this.over = this.squeezed = this.showing = this.resumes = false;
    this.push = undefined;
    this.cursor_s = 0;
  }

  steer(asked: Wish, sight: Sight, set: Help, dt_s: number): Course {
    const help = this.showing ? 'full' : set;
    const own = ownGrip(sight.grips, sight.hand.y, sight.beside);
    if (own === undefined) return { wish: asked, leaving: false };
    const inside = depthOf(sight.hand.x, sight.back_m, sight.grips[own]!) > INSIDE;
    if (this.carry) {
      const carried = this.carryOn(this.carry, asked, sight, dt_s);
      if (carried) return carried;
      this.finish(asked, true);
    }
    if (help === 'full' && sight.letGo && !this.over) {
      this.resumes = sight.goesOn === true && this.meant !== undefined;
      this.finish(asked, inside || this.push !== undefined);
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
    if (takes && sight.onJoint) return this.lead(wish, away);
    if (takes && this.meant !== undefined) {
      this.carry = { target: this.meant, carry: new Carry() };
    }
    if (this.tooFar) return { wish: { ...wish, squeeze: false }, leaving: false, outOfReach: true };
    return this.meant === undefined ? this.alone(wish, own, inside) : this.reach(wish, sight, own, inside, this.meant);
  }

  /** What is pushed is met with straight fingers. */
  private pushOn(wish: Wish, { hand, aim, grips, back_m, awayFromUse }: Sight, toward: Triple, goal: number): Course {
    this.push ??= new Push();
    const velocity = this.push.step({ hand, aim, grip: grips[goal]!, back_m, toward, away: awayFromUse?.[goal] });
    return { wish: { ...wish, place: {}, velocity, squeeze: false }, goal, leaving: false, pushes: true };
  }

  /** What is held goes the way of its joint. */
  private lead(wish: Wish, { x, y, z }: Triple): Course {
    const speed = Math.min(SLOWS_PER_S, LED_M_S / Math.max(Math.hypot(x, y, z), 1e-6));
    return { wish: { ...wish, place: {}, velocity: { x: speed * x, y: speed * y, z: speed * z } }, goal: this.meant, leaving: false, carries: true };
  }

  /** What is carried is put back before the hand lets go of it. Undefined: it is no longer carried. */
  private carryOn({ target, carry }: { readonly target: number; readonly carry: Carry }, asked: Wish, sight: Sight, dt_s: number): Course | undefined {
    this.over = sight.letGo;
    const away = sight.awayFromUse?.[target];
    const wants = this.trigger.step(asked.squeeze, { taps: true, closed: sight.closed, well: away !== undefined && isInPlace(away) && isWell(sight) }, dt_s);
    const { x, y, z } = asked.velocity, isLed = x !== 0 || y !== 0 || z !== 0;
    const move = away && carry.step({ ...sight, away, goesOn: asksToSqueeze(wants) && !sight.letGo }, dt_s);
    if (move) return { wish: { ...asked, place: {}, velocity: isLed ? asked.velocity : move.velocity, squeeze: true }, goal: target, leaving: false, carries: true, holds: move.hold };
    this.carry = undefined;
    return undefined;
  }

  /** Enough is in: what is held is let go of, and the hand leaves. */
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

  /** Which target is meant now. A person who moves the hand with keys decides it by hand. */
  private choose(wish: Wish, sight: Sight, own: number, help: Help): void {
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
    // A press asks for what the task asks for, wherever the cursor is: help that does everything does the right thing.
    const asked = sight.target >= 0 ? sight.target : pointed ?? own;
    const wanted = squeezes ? asked : pointed ?? asked;
    this.tooFar = help === 'full' && squeezes && !sight.reachable(sight.grips[wanted]!);
    if (help === 'none' || sight.letGo) this.meant = undefined;
    else if (help === 'full') {
      const dwelt = pointed !== undefined && this.cursor_s >= DWELL_S;
      const says = squeezes ? !before || this.meant === undefined : dwelt;
      if (says && sight.reachable(sight.grips[wanted]!)) this.meant = wanted;
    } else if (!squeezes) this.meant = undefined;
    else if (Math.abs(sight.hand.y - laneOf(sight.grips[own]!, sight.beside, sight.onJoint)) < (sight.onJoint ? NEAR_HANDLE_M : NEAR_M)) this.meant ??= own;
    if (this.meant !== undefined) this.leaving = false;
  }

  /** Out of the row if the hand is at another target, in front of the one that is meant, and in. */
  private reach(wish: Wish, sight: Sight, own: number, inside: boolean, goal: number): Course {
    const move = (velocity: Partial<Triple>, more: Partial<Wish> = {}): Course => (
      { wish: { ...wish, place: {}, velocity: { x: 0, y: 0, z: 0, ...velocity }, ...more }, goal, leaving: false });
    const grip = sight.grips[goal];
    if (!grip) return { wish, leaving: false };
    // A fist that goes in jams between two targets: it opens first.
    if (sight.closed && own === goal && Math.abs(sight.hand.x - grip.x) > AT_GRIP_M) return move({}, { squeeze: false });
    if (inside && own !== goal) return { ...move({ x: sight.closed ? 0 : -SPEED_M_S }, { squeeze: false }), goal: undefined };
    const aside_m = laneOf(grip, sight.beside, sight.onJoint) - sight.aim.y;
    if (inside || Math.abs(aside_m) <= LANE_M) return move({ x: SPEED_M_S });
    return move({ y: Math.sign(aside_m) * Math.min(SPEED_M_S, 6 * Math.abs(aside_m)) });
  }

  /** Inside the row a cursor on another target asks for the way out: sideways the hand would meet a target's side. */
  private alone(wish: Wish, own: number, inside: boolean): Course {
    if (!inside || wish.place.y === undefined) return { wish, leaving: false };
    if (wish.pointed !== undefined && wish.pointed !== own) return { wish: { ...wish, velocity: { x: -SPEED_M_S, y: 0, z: 0 }, place: {} }, leaving: false };
    return { wish: { ...wish, place: wish.place.x === undefined ? {} : { x: wish.place.x } }, leaving: false };
  }

  private leave(wish: Wish, { hand, aim, back_m, closed }: Sight): Course {
    this.push = undefined;
    if (hand.x <= back_m + BACK_AT_M || aim.x <= back_m) this.leaving = false;
    return { wish: { ...wish, velocity: { x: closed ? 0 : -SPEED_M_S, y: 0, z: 0 }, place: {}, squeeze: false }, leaving: true };
  }
}
