// Free grasping in the game: four objects to be held, in any order.
import type { WorldStateT } from '../../protocol';
import type { Bells, Chime, ExerciseWords, FlowSound, Marks, Phase, Play, Prompt, TaskCard, TaskStep } from '../exercise';
import type { ExercisePanel } from '../panel';
import { Grasps, HOLD_S } from './grasps';
import { text } from './i18n';
import { stepPicture, thingDisc } from './pictures';
import type { Thing } from './things';

/** Each held object sounds one tone higher. */
const TONES_HZ = [523, 587, 659, 784] as const;
const ALL: Bells = { tones_hz: [523, 659, 784, 1047], apart_s: 0.24 };
/** Force of a firm hold, for the sound [N]. */
const FIRM_N = 6;

export class GraspPlay implements Play {
  readonly panel = null;
  readonly chimes: Readonly<Record<string, Chime>> = {};
  readonly words: ExerciseWords;
  private readonly grasps: Grasps;
  private session: unknown = undefined;
  private chime: Chime | undefined;

  constructor(private readonly things: readonly Thing[], private readonly shown: ExercisePanel) {
    this.grasps = new Grasps(things.map(({ body }) => body));
    this.words = {
      title: () => shown.title, lead: () => text('welcome.lead'), levelName: () => '', oneButton: () => undefined,
      steps: (skin) => ([1, 2, 3] as const).map((n) => ({ picture: stepPicture(n, skin), title: text(`welcome.step${n}`), more: text(`welcome.step${n}More`) })),
    };
  }

  follow(state: WorldStateT): boolean {
    const begins = state.session !== this.session;
    this.session = state.session;
    if (begins) this.grasps.begin();
    const news = this.grasps.look(state.contacts, Number(state.sentMonotonicNs) / 1e9);
    if (news === 'all') this.chime = ALL;
    if (news === 'held') this.chime = { tones_hz: [TONES_HZ[(this.grasps.count - 1) % TONES_HZ.length]!], apart_s: 0.2 };
    return begins;
  }

  phase(): Phase { return 'free'; }
  atStart(): boolean { return this.grasps.count === 0; }
  isPaused(): boolean { return false; }

  prompt(): Prompt {
    const { grasps, things } = this, proposed = things[grasps.proposed], inHand = things[grasps.now];
    if (grasps.all) return { title: text('all'), more: text('allMore') };
    if (inHand && grasps.held[grasps.now]) return { title: text('letGo'), more: text('letGoMore') };
    const x = proposed ? text(`the.${proposed.kind}`) : '';
    return inHand ? { title: text('keep', { x }), more: text('keepMore') } : { title: text('take', { x }), more: text('takeMore') };
  }

  donePrompt(): Prompt { return { title: '', more: '' }; }
  watchedTitle(): string { return this.prompt().title; }
  todo(): string { return ''; }
  goal(): null { return null; }
  meter(): null { return null; }
  praise(): null { return null; }

  card(): TaskCard {
    const { grasps, things } = this;
    const steps = things.map(({ kind, color }, i): TaskStep => ({
      key: kind, name: text(kind), is: grasps.held[i] ? 'done' : i === grasps.proposed ? 'now' : 'later',
      done: Math.round(100 * grasps.share(i)), asked: 100, askedWords: grasps.held[i] ? text('wasHeld') : text('hold', { a: HOLD_S }),
      doneWords: text('heldOf', { a: Math.round(100 * grasps.share(i)) }), picture: () => thingDisc(kind, color),
    }));
    return { label: this.shown.title, count: text('count', { n: grasps.count, m: things.length }), title: this.shown.title, steps };
  }

  /** A tone while something is in the hand, higher with each lit star. */
  flow(state: WorldStateT): { rate: number; level: number; sound: FlowSound } {
    const force_n = state.contacts.reduce((sum, { forceN }) => sum + (forceN ? Math.hypot(forceN.x, forceN.y, forceN.z) : 0), 0);
    return { rate: this.grasps.now >= 0 ? force_n / FIRM_N : 0, level: this.grasps.count / this.things.length, sound: 'tone' };
  }

  takeChime(): Chime | undefined {
    const { chime } = this;
    this.chime = undefined;
    return chime;
  }

  marks(): Marks { return { proposed: this.grasps.proposed, held: [...this.grasps.held] }; }
}
