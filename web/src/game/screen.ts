// What the page shows: picture, words over it, and the card that lies over both.
import type { Controls } from '../input/controls';
import type { Connection } from '../net/connection';
import { RunState, type SceneT, type WorldStateT } from '../protocol';
import { language, nameOf, setLanguage, text } from '../shared/i18n';
import { cueTowards, type Cue } from './cues';
import { absentCard, helpCard, leftCard, lostCard, Overlay, praiseCard, restCard, stoppedCard, versionCard, welcomeCard, type HelpSection } from './dialogs';
import { Hud, type Point } from './hud';
import type { Memory } from './memory';
import type { Picture } from './picture';
import type { Presses } from './presses';
import { figure, type Script } from './script';
import type { Sound } from './sound';
import { callOutOf, causeOf, instructionOf, isFaded, isPlaying, meterOf, praiseOf, recipeOf, Stage, type PageState } from './view';

/** While one of these is shown the person does not move the hand. */
const CARDS: ReadonlySet<PageState> = new Set<PageState>(['watching', 'welcome', 'loading', 'left', 'rest', 'success']);

/** What the screen shows, and what its buttons do. */
export interface Behind {
  readonly connection: Connection;
  readonly controls: Controls;
  readonly memory: Memory;
  readonly presses: Presses;
  readonly sound: Sound;
}

export class Screen {
  readonly hud: Hud;
  private picture: Picture | null = null;
  private blind = false;
  private readonly overlay: Overlay;
  private unit = 0;
  private shown = '';          // state and all that its dialog depends on
  private state: PageState = 'welcome';

  constructor(root: HTMLElement, private readonly play: HTMLElement, private readonly behind: Behind) {
    const { presses } = behind;
    this.hud = new Hud(root, { help: () => presses.help(), sound: () => this.toggleSound(), stop: () => this.stop(), play: () => presses.start() });
    this.overlay = new Overlay(root, this.hud.strip);
    addEventListener('resize', () => { this.unit = 0; });
    this.hud.words(behind.sound.on);
    this.overlayFor('welcome');
  }

  /** The picture came, or was found to be impossible (null): then the amount stands by itself. */
  setPicture(picture: Picture | null): void {
    this.picture = picture;
    this.blind = picture === null;
    picture?.setLook({ tone: this.behind.memory.tone, names: this.liquidNames() });
    if (picture && this.behind.connection.scene) picture.setScene(this.behind.connection.scene);
    this.shown = '';
  }

  setScene(scene: SceneT): void {
    this.picture?.setScene(scene);
    this.picture?.setLook({ names: this.liquidNames() });
    this.shown = '';
  }

  setState(state: WorldStateT): void { this.picture?.setState(state); }

  show(now: PageState, state: WorldStateT | null): void {
    this.enter(now);
    this.hud.alarm(this.behind.connection.stopUnconfirmed);
    if (state) this.tell(now, state);
  }

  private enter(now: PageState): void {
    const { connection, controls, memory, sound } = this.behind;
    const { attempts, problem } = connection;
    const playing = !CARDS.has(now) && isPlaying(memory.situation(connection), connection.latestState);
    const key = [now, language(), attempts, problem?.theirs, connection.refusedWith, connection.loss, memory.hardware, memory.notice, memory.helpOpen].join();
    if (key === this.shown) return;
    this.shown = key;
    this.state = now;
    if (now !== 'success' && now !== 'rest') memory.praised = false;
    document.body.dataset.state = now;
    this.hud.words(sound.on);
    this.hud.play.hidden = now !== 'watching' || memory.helpOpen;
    this.picture?.setLook({ names: this.liquidNames(), dimmed: now === 'welcome', grey: now === 'lost' || now === 'stopped' || now === 'absent' || now === 'left', ghostHand: now === 'lost' });
    if (now === 'lost' || now === 'stopped') memory.leavePlay();
    // Whoever starts it again, at the console perhaps, may command.
    if (now === 'stopped' && connection.controls.heldByYou) void connection.releaseControls();
    if (playing && !memory.helpOpen) controls.enable(); else controls.disable();
    this.overlayFor(now);
  }

  // ---- the card over the play

  private overlayFor(now: PageState): void {
    const { connection, memory, presses } = this.behind;
    const { attempts, latestState, problem } = connection;
    if (now === 'version') this.overlay.open('low', versionCard(problem?.ours ?? 0, problem?.theirs ?? 0));
    else if (now === 'lost') this.overlay.open('low', lostCard(attempts, memory.hardware));
    else if (now === 'absent') this.overlay.open('low', absentCard(attempts, connection.refusedWith));
    else if (now === 'stopped') this.overlay.open('stop', stoppedCard(latestState ? causeOf(memory.script, latestState) : ''), { alone: true });
    else if (memory.helpOpen) {
      const { card, first } = helpCard(this.ways(), () => presses.help());
      this.overlay.open('help-veil', card, { first, onEscape: () => presses.help() });
    } else if (now === 'welcome') this.openWelcome();
    else if (now === 'left' && connection.loss !== '') {
      const { card, first } = leftCard(connection.loss, memory.notice, () => presses.start());
      this.overlay.open('pause', card, { first });
    }
    else if (now === 'rest') {
      const { card, first } = restCard(() => { void presses.goOn(); });
      this.overlay.open('pause', card, { first });
    } else if (now === 'success' && latestState) this.openPraise(latestState);
    else this.overlay.close(now === 'watching' ? this.hud.play : this.play);
  }

  private openWelcome(): void {
    const { memory, presses } = this.behind;
    const { way, levels, level, tone, notice } = memory;
    const focused = document.activeElement instanceof HTMLElement ? { ...document.activeElement.dataset } : {};
    const { card, start } = welcomeCard({ ways: this.ways(), way, robot: memory.hardware, levels, level, tone, notice }, {
      start: () => presses.start(),
      watch: () => { void presses.watch(); },
      language: (wanted) => this.choose(() => { setLanguage(wanted); this.picture?.setLook({ names: this.liquidNames() }); }),
      way: (wanted) => this.choose(() => memory.chooseWay(wanted)),
      level: (wanted) => this.choose(() => memory.chooseLevel(wanted)),
      tone: (wanted) => this.choose(() => { memory.chooseTone(wanted); this.picture?.setLook({ tone: wanted }); }),
    });
    // A choice builds the card anew: the focus stays on what was chosen.
    const [name, value] = Object.entries(focused)[0] ?? [];
    const again = name && name !== 'testid' ? card.querySelector<HTMLElement>(`[data-${name}="${value}"]`) : null;
    this.overlay.open('welcome-veil', card, { first: again ?? start });
  }

  private choose(change: () => void): void {
    change();
    this.hud.words(this.behind.sound.on);
    this.overlayFor(this.state);
  }

  private openPraise(state: WorldStateT): void {
    const { memory, presses } = this.behind;
    const praise = memory.script ? praiseOf(memory.script, state, memory.spiltBefore_l) : null;
    if (!praise) return;
    memory.drinkFollows = !praise.levelDone;
    if (memory.drinkFollows && !memory.praised) presses.hold();
    memory.praised = true;
    const { card, first } = praiseCard(praise, memory.level < memory.levels, {
      next: () => { void presses.goOn(); },
      nextLevel: () => { void presses.load(memory.level + 1); },
      again: () => presses.again(),
      rest: () => { void presses.rest(); },
    });
    this.overlay.open('success', card, { first });
  }

  private ways(): HelpSection[] {
    const { controls, memory } = this.behind;
    const touch = matchMedia('(pointer: coarse)').matches;
    const pads = navigator.getGamepads?.().some((pad) => pad?.mapping === 'standard') ?? false;
    return controls.helpEntries().filter(({ way }) => (way !== 'touch' || touch) && (way !== 'gamepad' || pads || memory.helpOpen));
  }

  private toggleSound(): void {
    this.behind.sound.toggle();
    this.hud.words(this.behind.sound.on);
  }

  private stop(): void {
    this.hud.stop.classList.add('pressed');
    setTimeout(() => this.hud.stop.classList.remove('pressed'), 400);
    this.behind.presses.stop();
  }

  // ---- the words over the picture

  /** Instruction, recipe, meter, amount, signs. */
  private tell(now: PageState, state: WorldStateT): void {
    const { script } = this.behind.memory;
    // Asked before anything is written: afterwards it would cost a layout.
    const labels = script ? this.picture?.labels() : undefined;
    this.hud.say(...this.words(now, state));
    const visible = script !== null && now !== 'welcome';
    this.hud.show(visible ? recipeOf(script, state) : null, visible && now !== 'success' && now !== 'rest' ? meterOf(script, state) : null, visible ? callOutOf(script, state) : null);
    if (script && labels) this.placeWords(script, state, now, labels);
    else if (this.blind) this.hud.place({ x_px: 0, y_px: 0 }, null);
  }

  private words(now: PageState, state: WorldStateT): [string, string] {
    const { connection: { controls }, memory: { script, notice } } = this.behind;
    if (now === 'watching') {
      const kind = controls.held && !controls.heldByYou ? 'other' : state.runState === RunState.Rendering ? 'program' : 'idle';
      if (kind === 'program' && isFaded(state)) return [text('watch.program'), text('watch.fadedMore')];
      return [text(`watch.${kind}`), notice ? text('welcome.refused', { x: notice }) : text(`watch.${kind}More`)];
    }
    if (now === 'success' || now === 'rest') {
      const recipe = script ? recipeOf(script, state) : null;
      return ['', now === 'success' && recipe ? text('game.drinkOf', { n: recipe.drink, m: recipe.drinks }) : ''];
    }
    if (now === 'loading') return [text('game.moment'), ''];
    if (now === 'free') return [text('game.free'), text('game.freeMore')];
    if (!script || now === 'welcome' || now === 'left' || now === 'lost') return ['', ''];
    const { title, more, liquid } = instructionOf(script, state);
    const x = nameOf('liquid', liquid);
    return [text(title, { x }), text(more, { x })];
  }

  private placeWords(script: Script, state: WorldStateT, now: PageState, { fillLine, target }: ReturnType<Picture['labels']>): void {
    const reaching = now === 'reach' || (now === 'watching' && figure(script, state, 'stage') === Stage.Reach);
    this.hud.place(fillLine, reaching && target ? this.cue(script, state, target) : null);
  }

  private cue(script: Script, state: WorldStateT, target: Point): Cue | null {
    const { connection, memory } = this.behind;
    const wanted = script.dispensers[figure(script, state, 'target_dispenser', -1)]?.body;
    const body = connection.scene?.bodies.findIndex((b) => String(b.name) === wanted) ?? -1;
    const bottle = state.bodies[body]?.positionM;
    const palm = state.links[memory.palmLink]?.positionM;
    return bottle && palm ? cueTowards(palm.y, bottle.y, target, this.unit_px()) : null;
  }

  private liquidNames(): Record<string, string> {
    return Object.fromEntries((this.behind.memory.script?.dispensers ?? []).map(({ liquid }) => [liquid, nameOf('liquid', liquid)]));
  }

  /** 1u of game.css; measured anew when the screen changes, as asking for it costs a layout. */
  private unit_px(): number {
    this.unit ||= this.hud.stop.getBoundingClientRect().height / 68;
    return this.unit;
  }
}
