// The pages' stand-in for the bar, aimed like the program's hand: no program is needed.
import { targetsOf } from '../src/exercises';
import { AXES, FakeBar } from '../fake/fake_bar';
import { describeBar, fillBar } from '../fake/fake_messages';
import { Perceiver } from '../src/input/perceiver';
import { HAND, type Triple } from '../fake/fake_hand';
import { pose, vec } from '../fake/fake_shapes';
import { AxisT, CapsuleT, SceneT, WorldStateT } from '../src/protocol';
import type { PlayedHand } from './player';
import { LOOK_S, type RigSnapshot } from './steered_hand';

export class StandInHand implements PlayedHand {
  readonly axes = AXES;
  readonly scene = new SceneT();
  readonly perceiver: Perceiver;
  readonly bar: FakeBar;
  state!: WorldStateT;
  now!: RigSnapshot;

  constructor(level: number) {
    const { scene } = this, bar = this.bar = new FakeBar(level);
    scene.capsules = HAND.capsules.map((c) => new CapsuleT(c.name, c.part, c.link, vec(c.a as unknown as Triple), vec(c.b as unknown as Triple), c.r));
    scene.axes = AXES.map((a) => new AxisT(a.name, a.unit, a.lower, a.upper));
    scene.rightHand = true;
    describeBar(scene, bar);
    this.perceiver = new Perceiver(scene, targetsOf(scene));
    this.look();
  }

  /** Advances one step with the given aim. */
  async aim(q: readonly number[], restart = false): Promise<void> {
    const { bar } = this;
    if (restart) bar.restart();
    AXES.forEach((_, i) => { bar.intention[i] = q[i]!; });
    bar.advance(LOOK_S, false, true);
    this.look();
  }

  value(name: string): number { return this.state.values[this.scene.valueNames.indexOf(name)] ?? NaN; }

  bodyOf(dispenser: number): number {
    return this.scene.bodies.findIndex(({ name }) => name === `dispenser_${this.bar.liquids[dispenser]?.name}`);
  }

  private look(): void {
    const { bar } = this, state = this.state = new WorldStateT();
    fillBar(state, bar);
    state.qM = [...bar.qM];
    state.qS = [...bar.qS];
    state.links = bar.links.map((link) => pose(link.p, link.q));
    state.sentMonotonicNs = BigInt(Math.round(1e9 * bar.time_s));
    this.now = {
      q_m: state.qM, q_s: state.qS, palm: [0, 0, 0], faults: 0, bodies: [], turns_xyzw: [], values: state.values,
      contacts: bar.contacts.map(({ capsule, force: [x, y, z] }) => [0, capsule, [x, y, z]]),
    };
  }
}
