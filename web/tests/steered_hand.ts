// The program's hand and bar on the simulated clock, for tests: tests/experiments/steered_hand.cpp.
import { spawn, type ChildProcessWithoutNullStreams } from 'node:child_process';
import { existsSync } from 'node:fs';
import { resolve } from 'node:path';
import { createInterface } from 'node:readline';
import { targetsOf } from '../src/exercises';
import { Perceiver } from '../src/input/perceiver';
import type { AimAxis } from '../src/input/aim_model';
import { HandPart, type SceneT, type WorldStateT } from '../src/protocol';

/** Time between two looks [s]. */
export const LOOK_S = 0.016;
const FILE = resolve(process.env.WHOLEHAND_STEERED_HAND ?? resolve(__dirname, '../../build/release/steered_hand'));

interface SceneReport { right_hand: boolean; palm_link: number; axes: AimAxis[]; bodies: string[]; values: string[]; exercise: string }
type Vec = [number, number, number];
export interface RigSnapshot {
  /** Faults that stopped the loop. */
  q_m: number[]; q_s: number[]; palm: Vec; faults: number;
  bodies: Vec[]; turns_xyzw: [number, number, number, number][]; contacts: [body: number, capsule: number, force_n: Vec][]; values: number[];
}

const xyz = ([x, y, z]: Vec): { x: number; y: number; z: number } => ({ x, y, z });

export class SteeredHand {
  axes: readonly AimAxis[] = [];
  scene!: SceneT;
  state!: WorldStateT;
  perceiver!: Perceiver;
  now!: RigSnapshot;
  private reported!: SceneReport;
  private readonly lines: string[] = [];
  private onLine: (() => void) | undefined;
  private ended = '';

  private constructor(private readonly program: ChildProcessWithoutNullStreams) {
    createInterface({ input: program.stdout }).on('line', (line) => { this.lines.push(line); this.onLine?.(); });
    program.stderr.on('data', (words) => { this.ended += String(words); });
    program.on('close', () => { this.ended ||= 'it ended'; this.onLine?.(); });
  }

  static async start(level: number, exercise = 'cocktail-bar', hand = 'adult-median-right'): Promise<SteeredHand> {
    if (!existsSync(FILE)) throw new Error(`${FILE} is not there: ninja -C build/release steered_hand`);
    const out = new SteeredHand(spawn(FILE, [exercise, String(level), hand]));
    const reported = out.reported = JSON.parse(await out.line()) as SceneReport;
    out.axes = reported.axes;
    out.scene = {
      axes: reported.axes, bodies: reported.bodies.map((name) => ({ name, shapes: [] })), valueNames: reported.values, exerciseJson: reported.exercise,
      rightHand: reported.right_hand, capsules: [{ part: HandPart.Palm, link: reported.palm_link }],
    } as unknown as SceneT;
    out.perceiver = new Perceiver(out.scene, targetsOf(out.scene));
    out.take(await out.line());
    return out;
  }

  /** Advances one look with the given aim. */
  async aim(q: readonly number[], restart = false): Promise<void> {
    this.program.stdin.write(`${q.join(' ')}${restart ? ' restart' : ''}\n`);
    this.take(await this.line());
  }

  value(name: string): number { return this.now.values[this.reported.values.indexOf(name)] ?? NaN; }

  bodyOf(dispenser: number): number {
    const { dispensers } = JSON.parse(this.reported.exercise) as { dispensers: { body: string }[] };
    return this.reported.bodies.indexOf(dispensers[dispenser]?.body ?? '');
  }

  stop(): void { this.program.kill(); }

  private take(line: string): void {
    const now = this.now = JSON.parse(line) as RigSnapshot;
    const links: unknown[] = [];
    links[this.reported.palm_link] = { positionM: xyz(now.palm) };
    this.state = {
      qM: now.q_m, qS: now.q_s, links, bodies: now.bodies.map((p, i) => { const [x, y, z, w] = now.turns_xyzw[i]!; return { positionM: xyz(p), orientationXyzw: { x, y, z, w } }; }), values: now.values,
      contacts: now.contacts.map(([body, capsule, force]) => ({ body, capsule, forceN: xyz(force) })),
    } as unknown as WorldStateT;
  }

  private async line(): Promise<string> {
    while (this.lines.length === 0) {
      if (this.ended) throw new Error(`steered_hand: ${this.ended}`);
      await new Promise<void>((go) => { this.onLine = go; });
    }
    return this.lines.shift()!;
  }
}
