// A simplified bar for drawing and playing without the program: kinematic contact, squeeze bottles, recipe. It is only
// plausible; the program has the physical model.
import { capsulesOf, jointsOf, linkPoses, type RigidPose, type Triple, type WorldCapsule } from './fake_hand';
import { DRIP_L_S, Stage } from '../src/exercises/cocktail_bar/bar';

const DEGREE = Math.PI / 180;
const LIQUIDS = [
  { name: 'lemon', color: '#F6C636', pattern: 'stripes', symbol: 'triangle', viscosity_pa_s: 0.157, resistance_n_s_m: 80 },
  { name: 'cherry', color: '#A31D38', pattern: 'dots', symbol: 'circle', viscosity_pa_s: 0.251, resistance_n_s_m: 128 },
  { name: 'blueberry', color: '#3B6FD1', pattern: 'waves', symbol: 'square', viscosity_pa_s: 0.402, resistance_n_s_m: 205 },
  { name: 'coconut', color: '#FBF4E6', pattern: 'rings', symbol: 'diamond', viscosity_pa_s: 0.643, resistance_n_s_m: 328 },
] as const;
type Step = { liquid: string; amount_l: number; tolerance_l: number };
export interface Drink { name: string; steps: Step[] }

const step = (liquid: string, amount_ml: number, tolerance_ml: number): Step => (
  { liquid, amount_l: amount_ml / 1000, tolerance_l: tolerance_ml / 1000 });
const LEVELS: { name: string; liquids: number; drinks: Drink[] }[] = [
  { name: 'one', liquids: 1, drinks: [{ name: 'lemonade', steps: [step('lemon', 20, 5)] }, { name: 'lemonade', steps: [step('lemon', 24, 5)] }] },
  { name: 'two', liquids: 2, drinks: [{ name: 'blush', steps: [step('lemon', 16, 5), step('cherry', 14, 5)] }] },
  { name: 'three', liquids: 3, drinks: [{ name: 'blush', steps: [step('cherry', 16, 4), step('lemon', 16, 4)] }, { name: 'sunset', steps: [step('blueberry', 16, 4), step('lemon', 14, 4), step('cherry', 14, 4)] }] },
  { name: 'four', liquids: 4, drinks: [{ name: 'sunset', steps: [step('blueberry', 16, 3), step('lemon', 14, 3), step('cherry', 14, 3)] }, { name: 'island', steps: [step('coconut', 18, 3), step('blueberry', 14, 3)] }] },
];
export const LEVEL_NAMES = LEVELS.map((level) => level.name);

export const AXES = [
  { name: 'x', unit: 'm', lower: -0.085, upper: 0.085, limit: 20, lever: 0, speed: 1.5, spring: 800 },
  { name: 'y', unit: 'm', lower: -0.12, upper: 0.12, limit: 20, lever: 0, speed: 1.5, spring: 800 },
  { name: 'z', unit: 'm', lower: -0.12, upper: 0.12, limit: 20, lever: 0, speed: 1.5, spring: 800 },
  { name: 'finger_flexion', unit: 'rad', lower: 0, upper: Math.PI, limit: 0.8, lever: 0.08, speed: 10, spring: 1.2 },
  { name: 'thumb_circumduction', unit: 'rad', lower: 0, upper: Math.PI / 2, limit: 0.6, lever: 0.08, speed: 10, spring: 0.6 },
  { name: 'thumb_flexion', unit: 'rad', lower: 0, upper: 80 * DEGREE, limit: 0.8, lever: 0.08, speed: 10, spring: 1.2 },
] as const;
export const GEOMETRY = {
  counter_z: -0.253, rail_z: 0.128, row_x: 0.119, pitch: 0.128, bottle_r: 0.025, soft: 0.005, bottle_h: 0.2, bottle_z: 0.004, nozzle_z: -0.109,
  glass_r: 0.034, glass_h: 0.116, m_per_l: 1.48, capacity_l: 0.07, grip: [0.049, 0.041, 0.004] as Triple,
};
/** Forces at the fingertips, as in config/exercises/cocktail-bar.toml, level 1. */
export const SQUEEZE = { threshold_n: 0.5, low_n: 1.4, high_n: 2.6, full_n: 6 };
/** Stiffness of the shell under a digit, of its restoring spring, and of the bottle's core, at the tip [N/m]. */
const SHELL_N_M = 280;
const RETURN_N_M = 25;
const CORE_N_M = 625;
/** For each digit: opening force of the valve [N], resistance of the returning air [N·s/m], and effective area [m²]. */
const OPENING_N = 0.25;
const AIR_N_S_M = 7.5;
const AREA_M2 = 8e-4;
/** Maximum depth of the shell under a digit, at the tip [m]. */
const DEEPEST_M = 0.012;
/**
 * A stroke of at least this amount is spent when its flow stays below this share of its maximum for this time, until air
 * has restored the shell to this share: src/exercises/cocktail_bar/pouring.cpp.
 */
const LEAST_STROKE_L = 0.002;
const SLOW = 0.15;
const SLOW_S = 0.3;
const BACK = 0.15;
const LEVER_M = 0.08;
/** Overlap that is not a contact yet [m], and depth per closing angle of a digit [m/rad]. */
const SKIN_M = 0.0008;
const DEEPER_M = 0.05;
const START_L = 0.7;
const NEUTRAL = [-0.04, 0, -0.01, 65 * DEGREE, 5 * DEGREE, 0];

export interface BarContact { capsule: number; dispenser: number; point: Triple; force: Triple }
export interface BarEvent { name: string; index: number; value: number }

/**
 * The compression of a cushion `dt` later [m], backward Euler in closed form as in src/loop/control/viscoelastic.cpp.
 * @param travel_m compression before @param depth_m depth of the digit behind its first contact
 */
function pressCushion(travel_m: number, depth_m: number, resistance_n_s_m: number, open: boolean, dt: number): number {
  const push_n = SHELL_N_M * depth_m, q_n = Math.max(0, push_n - SHELL_N_M * travel_m) - RETURN_N_M * travel_m;
  const after_m = (d: number, force_n: number, spring_n_m: number): number => (d * travel_m + dt * force_n) / (d + dt * spring_n_m);
  if (open && q_n > OPENING_N) return after_m(resistance_n_s_m, push_n - OPENING_N, SHELL_N_M + RETURN_N_M);
  if (q_n >= 0) return travel_m;
  const back_m = after_m(AIR_N_S_M, push_n, SHELL_N_M + RETURN_N_M);
  return SHELL_N_M * back_m > push_n ? after_m(AIR_N_S_M, 0, RETURN_N_M) : back_m;
}

export class FakeBar {
  time_s = 0;
  readonly intention = [...NEUTRAL];
  readonly qM = [...NEUTRAL];
  qS = [...NEUTRAL];
  theta = jointsOf(NEUTRAL);
  links: RigidPose[] = linkPoses(this.theta);
  contacts: BarContact[] = [];
  alpha = 0;
  stage: number = Stage.Reach;
  drink = 0;
  step = 0;
  squeeze_n = 0;
  flow_l_s = 0;
  pressed_l = 0;
  engaged = -1;
  poured_l = 0;
  spilt_l = 0;
  score = 0;
  stars = 0;
  drinkTime_s = 0;
  row_y = 0;
  glass_y = 0;
  left_l: number[] = [];
  layers_l: number[] = [];
  palmDistance_m = 1;
  paused = false;
  /** Compression of the shell under fingers and thumb [m]. */
  private readonly travel_m = [0, 0];
  private fastest_l_s = 0;
  private slow_s = 0;
  private spentAt_l = 0;
  private rowTarget_y = 0;
  private rest_s = 0;
  private events: BarEvent[] = [];

  constructor(public level = 1) { this.restart(); }

  get drinks(): Drink[] { return LEVELS[this.level - 1].drinks; }
  get liquids(): typeof LIQUIDS[number][] { return LIQUIDS.slice(0, LEVELS[this.level - 1].liquids); }
  get steps(): Step[] { return this.drinks[this.drink].steps; }
  get target(): number { return this.liquids.findIndex((l) => l.name === this.steps[Math.min(this.step, this.steps.length - 1)].liquid); }
  dispenserY(index: number): number { return this.row_y + ((this.liquids.length - 1) / 2 - index) * GEOMETRY.pitch; }

  restart(): void {
    this.left_l = this.liquids.map(() => START_L);
    this.spilt_l = this.score = this.stars = this.drink = 0;
    this.row_y = this.liquids.length === 1 ? GEOMETRY.grip[1] : 0;
    this.beginDrink();
  }

  next(): void {
    if (this.stage !== Stage.DrinkDone) return;
    this.drink += 1;
    this.beginDrink();
  }

  takeEvents(): BarEvent[] { const events = this.events; this.events = []; return events; }

  /** Advances the bar by `dt`. @param player true: the virtual patient moves the hand */
  advance(dt: number, player: boolean, pushing: boolean): void {
    this.time_s += dt;
    if (player && pushing) this.play(dt);
    const follow = 1 - Math.exp(-dt * 9);
    AXES.forEach((axis, i) => {
      const wanted = Math.min(axis.upper, Math.max(axis.lower, this.intention[i]));
      this.qM[i] += (wanted - this.qM[i]) * follow;
    });
    this.touch(dt, pushing && !this.paused);
    if (!this.paused && pushing) this.pour(dt);
    this.slide(dt);
  }

  private beginDrink(): void {
    this.layers_l = [0, 0, 0, 0, 0, 0, 0, 0];
    this.drinkTime_s = 0;
    this.beginStep(0);
  }

  private beginStep(index: number): void {
    this.step = index;
    this.poured_l = 0;
    // The hand's travel is limited: the row slides to it.
    const need_y = this.dispenserY(this.target) - GEOMETRY.grip[1];
    this.rowTarget_y = this.row_y + Math.min(0.115, Math.max(-0.07, need_y)) - need_y;
    this.stage = this.mustSlide() ? Stage.DrawBack : Stage.Reach;
  }

  private glassTarget(): number { return this.dispenserY(this.target); }
  private mustSlide(): boolean { return Math.abs(this.rowTarget_y - this.row_y) > 1e-4 || Math.abs(this.glassTarget() - this.glass_y) > 1e-3; }

  private slide(dt: number): void {
    const away = this.qM[0] < 0.03 && this.squeeze_n === 0;
    if (!away || this.stage >= Stage.DrinkDone && this.stage < Stage.DrawBack) return;
    const towards = (now: number, target: number, most: number) => now + Math.max(-most, Math.min(most, target - now));
    this.row_y = towards(this.row_y, this.rowTarget_y, 0.08 * dt);
    if (Math.abs(this.rowTarget_y - this.row_y) < 1e-4) this.glass_y = towards(this.glass_y, this.glassTarget(), 0.4 * dt);
    if (this.stage === Stage.DrawBack && !this.mustSlide()) this.stage = Stage.Reach;
  }

  /** The virtual patient's path: forward beside the bottle, then sideways until it lies in the palm; back the same way. */
  private play(dt: number): void {
    const y = this.dispenserY(this.target) - GEOMETRY.grip[1];
    const x = GEOMETRY.row_x - GEOMETRY.grip[0];
    const side = y - 0.045;
    const { amount_l, tolerance_l } = this.steps[Math.min(this.step, this.steps.length - 1)];
    const fillsUp = this.stage === Stage.LetGo && this.flow_l_s > DRIP_L_S && this.poured_l < amount_l - 0.3 * tolerance_l;
    const grasping = fillsUp || [Stage.Reach, Stage.Squeeze, Stage.Pour, Stage.Breathe].some((stage) => stage === this.stage);
    const open = this.qM[3] < 60 * DEGREE;
    const [nowX, nowY] = this.qM;
    let wanted = [-0.04, side, -0.01, 40 * DEGREE, 5 * DEGREE, 0];
    if (grasping && Math.abs(nowY - side) < 0.01 || grasping && nowX > 0.03 && nowY < side + 0.01) { wanted[0] = x; wanted[2] = 0; }
    if (grasping && nowX > x - 0.004) wanted = [x, y, 0, 65 * DEGREE, 20 * DEGREE, 0];
    // The way out: open first, then sideways, then back.
    if (!grasping && nowX > 0.03) wanted = [x, open ? side : y, 0, 40 * DEGREE, open ? 5 * DEGREE : 20 * DEGREE, 0];
    if (!grasping && nowX > 0.03 && open && nowY < side + 0.01) wanted[0] = -0.04;
    if (grasping && this.stage !== Stage.Reach && this.stage !== Stage.Breathe && nowX > x - 0.004 && Math.abs(nowY - y) < 0.004) {
      const wish_n = this.poured_l > 0.85 * amount_l ? 1.6 : 2;
      const more = Math.max(-1, Math.min(1, wish_n - this.squeeze_n)) * dt;
      wanted = [x, y, 0, Math.min(155 * DEGREE, this.intention[3] + 1.2 * more), 20 * DEGREE, Math.min(55 * DEGREE, this.intention[5] + 0.5 * more)];
    }
    if (this.stage === Stage.DrinkDone && this.rest_s > 6) this.next();
    const speed = [0.2, 0.16, 0.14, 1.6, 1.2, 1.2];
    wanted.forEach((w, i) => { this.intention[i] += Math.max(-speed[i] * dt, Math.min(speed[i] * dt, w - this.intention[i])); });
  }

  private bottleAxis(index: number): readonly [number, number] { return [GEOMETRY.row_x, this.dispenserY(index)]; }

  /** Depth and position of a capsule in a bottle [m]. */
  private depth(c: WorldCapsule, bottle: number): { depth: number; point: Triple; normal: Triple } {
    const [bx, by] = this.bottleAxis(bottle);
    let best = { depth: -1, point: c.a, normal: [1, 0, 0] as Triple };
    for (let k = 0; k <= 6; k++) {
      const t = k / 6;
      const p: Triple = [c.a[0] + t * (c.b[0] - c.a[0]), c.a[1] + t * (c.b[1] - c.a[1]), c.a[2] + t * (c.b[2] - c.a[2])];
      if (Math.abs(p[2] - GEOMETRY.bottle_z) > GEOMETRY.bottle_h / 2) continue;
      const dx = p[0] - bx, dy = p[1] - by, d = Math.hypot(dx, dy) || 1e-9;
      const deep = GEOMETRY.bottle_r + c.r - d;
      const n: Triple = [dx / d, dy / d, 0];
      if (deep > best.depth) best = { depth: deep, point: [p[0] - n[0] * c.r, p[1] - n[1] * c.r, p[2]], normal: n };
    }
    return best;
  }

  private deepest(q: readonly number[], bottle: number, parts: (part: number) => boolean): number {
    const capsules = capsulesOf(linkPoses(jointsOf(q)));
    return Math.max(...capsules.filter((c) => parts(c.part)).map((c) => this.depth(c, bottle).depth));
  }

  /** Contact forces: the shell acts from the bottle's surface on, the core from the avatar's blocked digits on. @param open liquid may leave */
  private touch(dt: number, open: boolean): void {
    const q = [...this.qM];
    const near = this.liquids.findIndex((_, i) => Math.hypot(GEOMETRY.row_x - q[0] - GEOMETRY.grip[0], this.dispenserY(i) - q[1] - GEOMETRY.grip[1]) < 0.04);
    this.contacts = [];
    this.squeeze_n = this.flow_l_s = 0;
    const depths_m = [0, 0];
    this.palmDistance_m = 0.2;
    if (near >= 0) {
      const palm = this.deepest(q, near, (part) => part === 0);
      this.palmDistance_m = Math.max(0, -palm);
      if (palm > SKIN_M) q[0] -= Math.min(0.03, palm - SKIN_M);
      for (const [digit, axis] of [3, 5].entries()) {
        const deep_m = Math.max(0, this.deepest(q, near, (part) => (axis === 5 ? part === 5 : part >= 1 && part <= 4)) - SKIN_M);
        const inCore = Math.max(0, deep_m - GEOMETRY.soft) / DEEPER_M;
        q[axis] = Math.max(0, q[axis] - inCore);
        depths_m[digit] = Math.min(DEEPEST_M, LEVER_M * deep_m / DEEPER_M);
        this.squeeze_n += LEVER_M * CORE_N_M * inCore;
      }
    }
    this.press(dt, near, depths_m, open);
    // Smoothed over some steps: the search above moves in whole degrees.
    this.qS = q.map((v, i) => this.qS[i] + (v - this.qS[i]) * (1 - Math.exp(-dt * 30)));
    this.theta = jointsOf(this.qS);
    this.links = linkPoses(this.theta);
    if (near >= 0) this.findContacts(near);
    const engaged = near >= 0 && this.palmDistance_m < 0.02;
    if (engaged && this.engaged < 0) this.events.push({ name: 'engaged', index: near, value: 0 });
    if (!engaged && this.engaged >= 0) this.events.push({ name: 'disengaged', index: this.engaged, value: 0 });
    this.engaged = engaged ? near : -1;
    this.alpha = Math.max(0, Math.min(1, this.alpha + (engaged ? dt : -dt / 0.3)));
  }

  /** Compresses the cushions behind the digits; their lost volume flows out. @param depths_m depth of each digit at the tip */
  private press(dt: number, bottle: number, depths_m: readonly number[], open: boolean): void {
    const resistance = this.liquids[bottle]?.resistance_n_s_m ?? 1, opens = open && this.left_l[bottle] > 0;
    depths_m.forEach((depth_m, digit) => {
      const before_m = this.travel_m[digit], after_m = pressCushion(before_m, depth_m, resistance, opens, dt);
      this.travel_m[digit] = after_m;
      this.squeeze_n += this.alpha * Math.max(0, SHELL_N_M * (depth_m - after_m));
      this.flow_l_s += this.alpha * 1000 * AREA_M2 * Math.max(0, after_m - before_m) / dt;
    });
    this.pressed_l = 1000 * AREA_M2 * (this.travel_m[0] + this.travel_m[1]);
  }

  private findContacts(bottle: number): void {
    const found = capsulesOf(this.links).map((c, capsule) => ({ capsule, ...this.depth(c, bottle) })).filter((c) => c.depth > -0.0015);
    const sum = found.reduce((s, c) => s + c.depth + 0.002, 0);
    const total_n = Math.max(this.squeeze_n, 0.6 * found.length * 0.2);
    this.contacts = found.map((c) => {
      const share = total_n * (c.depth + 0.002) / sum;
      return { capsule: c.capsule, dispenser: bottle, point: c.point, force: [c.normal[0] * share, c.normal[1] * share, 0] };
    });
  }

  private pour(dt: number): void {
    const asked = this.steps[Math.min(this.step, this.steps.length - 1)];
    if (this.stage !== Stage.DrinkDone && this.stage !== Stage.LevelDone) { this.drinkTime_s += dt; this.rest_s = 0; } else this.rest_s += dt;
    if (this.isSpent(dt)) this.stage = Stage.Breathe;
    if (this.stage === Stage.Breathe && this.pressed_l <= BACK * this.spentAt_l) this.stage = Stage.Squeeze;
    if (this.engaged < 0 || this.flow_l_s === 0) {
      if (this.stage === Stage.LetGo && this.qM[0] < 0.03) this.stepDone();
      else if (this.stage === Stage.Pour) this.stage = Stage.Squeeze;
      else if ((this.stage === Stage.Squeeze || this.stage === Stage.Breathe) && this.engaged < 0) this.stage = Stage.Reach;
      else if (this.stage === Stage.Reach && this.engaged === this.target) this.stage = Stage.Squeeze;
      return;
    }
    const volume = Math.min(this.left_l[this.engaged], this.flow_l_s * dt);
    this.left_l[this.engaged] -= volume;
    const caught = this.engaged === this.target && (this.stage <= Stage.LetGo || this.stage === Stage.Breathe) && Math.abs(this.glass_y - this.dispenserY(this.engaged)) < 0.03;
    if (!caught) { this.spilt_l += volume; return; }
    if (this.poured_l === 0) this.events.push({ name: 'pour_began', index: this.engaged, value: 0 });
    if (this.stage < Stage.LetGo && this.flow_l_s > DRIP_L_S) this.stage = Stage.Pour;
    this.poured_l += volume;
    this.layers_l[this.step] += volume;
    if (this.stage < Stage.LetGo && this.poured_l >= asked.amount_l - asked.tolerance_l) {
      this.stage = Stage.LetGo;
      this.events.push({ name: 'line_reached', index: this.engaged, value: this.poured_l });
    }
  }

  /** Whether the stroke is spent: the hand must let go until air has returned into the bottle. */
  private isSpent(dt: number): boolean {
    if (this.pressed_l < LEAST_STROKE_L) this.fastest_l_s = 0;
    this.fastest_l_s = Math.max(this.fastest_l_s, this.flow_l_s);
    const fills = this.stage === Stage.Squeeze || this.stage === Stage.Pour, squeezes = this.squeeze_n >= SQUEEZE.threshold_n;
    const slow = fills && squeezes && this.pressed_l >= LEAST_STROKE_L && this.flow_l_s < SLOW * this.fastest_l_s;
    this.slow_s = slow ? this.slow_s + dt : 0;
    if (this.slow_s < SLOW_S) return false;
    this.spentAt_l = this.pressed_l;
    return true;
  }

  private stepDone(): void {
    const asked = this.steps[this.step];
    this.events.push({ name: 'step_done', index: this.step, value: this.poured_l - asked.amount_l });
    this.score = Math.max(this.score, Math.round(100 - 800 * Math.abs(this.poured_l - asked.amount_l)));
    if (this.step + 1 < this.steps.length) { this.beginStep(this.step + 1); return; }
    const last = this.drink + 1 >= this.drinks.length;
    this.stars = this.spilt_l < 0.005 ? 3 : 2;
    this.stage = last ? Stage.LevelDone : Stage.DrinkDone;
    this.events.push({ name: last ? 'level_done' : 'drink_done', index: this.drink, value: this.score });
  }
}
