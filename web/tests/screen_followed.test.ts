// A simulated person who reads the strip and follows it with keys only, on the simulated clock, against the
// program's hand and bar, at a page of 60 frames per second and at one of three.
import { afterEach, beforeEach, expect, it, vi } from 'vitest';
import { cueTowards } from '../src/game/cues';
import { Hints, type HintLevel } from '../src/game/hints';
import { targetsOf } from '../src/exercises';
import { barOf } from '../src/exercises/cocktail_bar/bar';
import { en as bar } from '../src/exercises/cocktail_bar/i18n/en';
import { BarPlay } from '../src/exercises/cocktail_bar/play';
import type { GraspTargets } from '../src/exercises/exercise';
import type { PageState } from '../src/game/page_state';
import { palmOffsetOf, playWords } from '../src/game/words';
import { AimModel } from '../src/input/aim_model';
import { Keys } from '../src/input/keys';
import type { Help } from '../src/input/wish';
import type { SceneT } from '../src/protocol';
import { fill } from '../src/shared/i18n';
import { en } from '../src/shared/i18n/en';
import { LOOK_S, SteeredHand } from './steered_hand';

/** Issue 13: a drink by a script that does only what the screen says. */
const DRINK_S = 90;
/** Reaction time, and duration of a press [s]. */
const REACTS_S = 0.4;
const PRESS_S = 0.15;
/** A person who has pressed as instructed presses again when the same instruction is still shown after this time [s]. */
const AGAIN_S = 6;
/** Like the page: the person counts as active for this long after a move of the aim [s], and the smallest move. */
const MOVING_S = 0.5;
const MOVES = 0.01;

const WINDOW = new EventTarget();
beforeEach(() => {
  vi.stubGlobal('addEventListener', WINDOW.addEventListener.bind(WINDOW));
  vi.stubGlobal('removeEventListener', WINDOW.removeEventListener.bind(WINDOW));
  vi.stubGlobal('Element', class {});
});
const open: SteeredHand[] = [];
afterEach(() => {
  for (const hand of open.splice(0)) hand.stop();
  vi.unstubAllGlobals();
});

/** The screen of a page, drawn every `frame_looks` steps of the clock. */
class Page {
  title = '';
  more = '';
  sign: '' | 'left' | 'right' = '';
  readonly keys = new Keys();
  readonly model: AimModel;
  private readonly play: BarPlay;
  private readonly targets: GraspTargets;
  private readonly scene: SceneT;
  private readonly hints = new Hints();
  private hint: HintLevel = 0;
  private still_s = 0;

  constructor(readonly hand: SteeredHand, private readonly help: Help) {
    this.scene = Object.assign(hand.scene, { level: 1, faultNames: [] });
    this.play = new BarPlay(barOf(this.scene)!, this.scene);
    this.targets = targetsOf(this.scene);
    this.model = new AimModel(hand.axes, { help });
    this.model.begin(hand.now.q_m);
    this.keys.enable();
  }

  get now(): PageState { return this.play.phase(this.hand.state); }

  frame(dt_s: number): void {
    const { hand: { state, perceiver }, model, play, targets, scene, now } = this;
    const before = [...model.aim];
    model.advance(this.keys.wish(), perceiver.onState(state), dt_s);
    this.still_s = model.aim.some((q, i) => Math.abs(q - before[i]!) > MOVES * dt_s) ? 0 : this.still_s + dt_s;
    play.follow(state);
    const palm = scene.capsules[0]!.link;
    const hint = this.hints.look(model.onItsWay || this.still_s < MOVING_S ? '' : play.todo(state), Math.min(0.25, dt_s));
    if (hint === 3 && this.hint < 3) model.show();
    this.hint = hint;
    const prompt = playWords(play, state, {
      now, help: this.help, hint, oneButton: true, onItsWay: model.onItsWay, outOfReach: model.outOfReach, closing: model.squeeze > 0, acts: model.acts, beside: palmOffsetOf(targets, true, state, palm),
    });
    this.title = prompt.title;
    this.more = prompt.more;
    const bottle = state.bodies[this.hand.bodyOf(this.hand.value('target_dispenser'))]?.positionM;
    const cue = now === 'reach' && bottle ? cueTowards(state.links[palm]!.positionM!.y, bottle.y, true, { x_px: 0, y_px: 0 }, 1) : null;
    this.sign = cue ? (cue.left ? 'left' : 'right') : '';
  }
}

/** The keys that the text on the screen asks for: held, or `press`ed once; "a little" is a `nudge`. */
function askedBy({ title, more, sign }: Page): { hold?: string; press?: string; nudge?: string } {
  if (title === bar.letGo || title === bar.drawBack || title.startsWith(bar.wrong.replace('{x}', ''))) return { hold: 'ArrowDown' };
  if (['hint.press', 'hint.again', 'hint.goOn'].some((key) => more === fill(en[key as keyof typeof en], { x: en['hint.pressOnce'] }))) return { press: 'Space' };
  if ([en['game.onItsWay'], en['game.closing'], en['game.letsGo'], en['game.doesIt'], en['hint.shows']].includes(more as never)) return {};
  if (title === bar.squeeze) return { hold: 'Space' };
  if (more === en['hint.back']) return { hold: 'ArrowDown' };
  if (sign !== '') return { hold: sign === 'left' ? 'ArrowLeft' : 'ArrowRight' };
  if (more === en['hint.left']) return { nudge: 'ArrowLeft' };
  if (more === en['hint.right']) return { nudge: 'ArrowRight' };
  if (more === en['hint.forward'] || more === bar.reachMore) return { hold: 'ArrowUp' };
  return {};
}

/** The duration of a drink, and the texts that were read. */
async function drink(help: Help, frame_looks: number): Promise<{ took_s: number; stars: number; log: string[] }> {
  const hand = await SteeredHand.start(1);
  open.push(hand);
  const page = new Page(hand, help);
  const dispatch = (type: 'keydown' | 'keyup', code: string): void => { WINDOW.dispatchEvent(Object.assign(new Event(type), { code })); };
  const log: string[] = [];
  let held = '', pressed = '', read = '', read_s = 0, pressed_s = -Infinity, t = 0;
  for (let look = 0; t < DRINK_S && page.now !== 'success'; look += 1, t += LOOK_S) {
    if (look % frame_looks === 0) page.frame(frame_looks * LOOK_S);
    await hand.aim([...page.model.aim]);
    const words = `${page.title} · ${page.more} ${page.sign}`;
    if (words !== read) {
      [read, read_s] = [words, t];
      log.push(`${t.toFixed(1)} s: ${words} (${hand.now.q_m.slice(0, 2).map((v) => v.toFixed(3)).join(' ')})`);
    }
    if (pressed && t - pressed_s >= PRESS_S) {
      dispatch('keyup', pressed);
      pressed = '';
    }
    if (t - read_s < REACTS_S) continue;
    const { hold = '', press = '', nudge = '' } = askedBy(page);
    if (hold !== held) {
      if (held) dispatch('keyup', held);
      if (hold) dispatch('keydown', hold);
      held = hold;
    }
    const due = press ? read_s > pressed_s || t - pressed_s > AGAIN_S : t - pressed_s > PRESS_S + REACTS_S;
    if ((press || nudge) && !pressed && due) {
      pressed = press || nudge;
      pressed_s = t;
      dispatch('keydown', pressed);
    }
  }
  page.keys.disable();
  return { took_s: t, stars: hand.value('stars'), log };
}

/** A page that draws slowly is read later: the time limit grows by this share of a drink's time. */
const SLOWER = 1.5;

it.each([['full', [1, 20]], ['some', [4]], ['none', [1, 12]]] as const)('a person who does only what the screen says finishes a drink, however slowly the page draws: help %s', async (help, pages) => {
  const took_s: number[] = [];
  for (const frame_looks of pages) {
    const made = await drink(help, frame_looks);
    console.log(`figure: a drink by what the screen says, help ${help}, ${(1 / (frame_looks * LOOK_S)).toFixed(0)} frames/s: ${made.took_s.toFixed(1)} s, ${made.stars} stars`);
    expect(made.took_s, made.log.slice(-30).join('\n')).toBeLessThan(DRINK_S);
    took_s.push(made.took_s);
  }
  expect(took_s.at(-1)!).toBeLessThan(SLOWER * took_s[0]!);
}, 240_000);
