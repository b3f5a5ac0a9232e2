// The game: what the program says becomes what the page shows; what the person presses becomes orders.
import type { Controls } from '../input/controls';
import type { Connection } from '../net/connection';
import { Act, HandPart, RunState, type EventT, type SceneT, type WorldStateT } from '../protocol';
import { h } from '../shared/dom';
import { language, nameOf, setLanguage, store, stored, text } from '../shared/i18n';
import { cueTowards, type Cue } from './cues';
import { absentCard, helpCard, lostCard, Overlay, praiseCard, restCard, stoppedCard, TONES, versionCard, welcomeCard, type HelpSection, type Tone } from './dialogs';
import { Hud, type Point } from './hud';
import type { Picture } from './picture';
import { figure, readScript, type Script } from './script';
import { Sound } from './sound';
import { changeLevel, letProgramPlay, openCamera, takeOver, type Known } from './takeover';
import {
  callOutOf, causeOf, hasHardware, instructionOf, isPlaying, meterOf, pageState, praiseOf, recipeOf, Stage, type PageState, type Situation,
} from './view';

const STORED = { tone: 'wholehand.tone', level: 'wholehand.level', way: 'wholehand.way' } as const;
export class Game {
  readonly hud: Hud;
  tone: Tone;
  private readonly overlay: Overlay;
  private readonly sound = new Sound();
  private readonly play: HTMLElement;
  private script: Script | null = null;
  private wish: Situation['wish'] = 'undecided';
  private palmLink = 0;
  private unit = 0;
  private blind = false;
  private loading = false;
  private followed: WorldStateT | null = null;
  private resting = false;
  private helpOpen = false;
  private drinkFollows = false;
  private praised = false;     // for the drink that is done now
  private everOpen = false;
  private hardware = false;
  private level = 1;
  private levels = 1;
  private way: string;
  private notice = '';
  private spiltBefore_l = 0;
  private drinkSeen = -1;
  private shown = '';          // state and all that its dialog depends on
  private state: PageState = 'welcome';

  constructor(
    root: HTMLElement, private readonly connection: Connection, private readonly controls: Controls, private picture: Picture | null, playElement: HTMLElement,
  ) {
    this.play = playElement;
    this.hud = new Hud(root, { help: () => this.toggleHelp(), sound: () => this.toggleSound(), stop: () => this.stop(), play: () => this.start() });
    this.overlay = new Overlay(root, this.hud.strip);
    const tone = stored(STORED.tone);
    this.tone = tone !== null && tone in TONES ? tone as Tone : 'honey';
    this.way = stored(STORED.way) ?? 'mouse';
    if (new URLSearchParams(location.search).has('watch')) this.wish = 'watch';
    connection.on('scene', (scene) => this.onScene(scene));
    connection.on('events', (events) => this.onEvents(events));
    controls.onRefused = (reason) => { this.notice = reason; };
    controls.onMode((way) => { if (way) this.way = way; });
    controls.onWebcam = (view) => this.hud.camera(view?.video ?? null, view && !view.seen ? controls.noHandText() : '');
    addEventListener('resize', () => { this.unit = 0; });
    this.hud.words(this.sound.on);
    this.overlayFor('welcome');
  }

  /** The picture came, or was found to be impossible (null): then the amount stands by itself. */
  setPicture(picture: Picture | null): void {
    this.picture = picture;
    this.blind = picture === null;
    picture?.setLook({ tone: this.tone, names: this.liquidNames() });
    if (picture && this.connection.scene) picture.setScene(this.connection.scene);
    this.shown = '';
  }

  /** Once a frame, and now and then where frames are slow. */
  frame(): void {
    const { latestState: state, status } = this.connection;
    this.everOpen ||= status === 'open';
    if (state && state !== this.followed) {
      this.followed = state;
      this.hardware = hasHardware(state);
      this.follow(state);
    }
    const now = pageState(this.situation(), this.script, state);
    this.enter(now);
    if (state) this.tell(now, state);
  }

  private situation(): Situation {
    const { status, problem, attempts, controls } = this.connection;
    return { status, problem, everOpen: this.everOpen, attempts, wish: this.wish, loading: this.loading, resting: this.resting, held: controls };
  }

  // ---- what the program says

  private onScene(scene: SceneT): void {
    this.script = readScript(scene);
    this.levels = Math.max(1, scene.levels);
    const wanted = Number(new URLSearchParams(location.search).get('level') ?? stored(STORED.level) ?? 0);
    this.level = this.wish === 'undecided' && wanted >= 1 && wanted <= this.levels ? wanted : Math.max(1, scene.level);
    this.palmLink = scene.capsules.find((capsule) => capsule.part === HandPart.Palm)?.link ?? 0;
    this.picture?.setScene(scene);
    this.picture?.setLook({ names: this.liquidNames() });
    this.drinkSeen = -1;
    this.shown = '';
  }

  private onEvents(events: readonly EventT[]): void {
    for (const event of events) {
      const name = String(this.connection.scene?.eventNames[event.type] ?? '');
      if (name === 'line_reached') this.sound.line();
      if (name === 'step_done') this.sound.step();
      if (name === 'drink_done' || name === 'level_done') this.sound.done();
    }
  }

  /** What is remembered from one state to the next. */
  private follow(state: WorldStateT): void {
    this.picture?.setState(state);
    if (!this.script) return;
    const drink = figure(this.script, state, 'drink');
    const stage = figure(this.script, state, 'stage');
    const begins = figure(this.script, state, 'step') === 0 && figure(this.script, state, 'poured_l') === 0;
    if (drink !== this.drinkSeen && (begins || this.drinkSeen < 0) && stage !== Stage.DrinkDone && stage !== Stage.LevelDone) {
      this.drinkSeen = drink;
      this.spiltBefore_l = begins ? figure(this.script, state, 'spilt_l') : 0;
    }
    const capacity_l = 0.12;
    this.sound.pour(state.runState === RunState.Rendering ? figure(this.script, state, 'flow_l_s') : 0, figure(this.script, state, 'glass_l') / capacity_l);
  }

  // ---- what the page shows

  private enter(now: PageState): void {
    const { attempts, problem } = this.connection;
    const playing = now !== 'watching' && now !== 'welcome' && now !== 'loading' && isPlaying(this.situation(), this.connection.latestState);
    const key = [now, language(), attempts, problem?.theirs, this.connection.refusedWith, this.hardware, this.notice, this.helpOpen].join();
    if (key === this.shown) return;
    this.shown = key;
    this.state = now;
    if (now !== 'success' && now !== 'rest') this.praised = false;
    document.body.dataset.state = now;
    this.hud.words(this.sound.on);
    this.hud.play.hidden = now !== 'watching' || this.helpOpen;
    this.picture?.setLook({ names: this.liquidNames(), dimmed: now === 'welcome', grey: now === 'lost' || now === 'stopped' || now === 'absent', ghostHand: now === 'lost' });
    if (now === 'lost' || now === 'stopped') this.leavePlay();
    if (playing && !this.helpOpen) this.controls.enable(); else this.controls.disable();
    this.overlayFor(now);
  }

  /** What was begun must be begun again by the person: nothing takes the hand back by itself. */
  private leavePlay(): void {
    if (this.wish === 'play') this.wish = 'watch';
    this.resting = false;
    this.helpOpen = false;
  }

  private overlayFor(now: PageState): void {
    const { attempts, latestState, problem } = this.connection;
    if (now === 'version') this.overlay.open('low', versionCard(problem?.ours ?? 0, problem?.theirs ?? 0), { alone: true });
    else if (now === 'lost') this.overlay.open('low', lostCard(attempts, this.hardware), { alone: true });
    else if (now === 'absent') this.overlay.open('low', absentCard(attempts, this.connection.refusedWith), { alone: true });
    else if (now === 'stopped') this.overlay.open('stop', stoppedCard(latestState ? causeOf(this.script, latestState) : ''), { alone: true });
    else if (this.helpOpen) {
      const { card, first } = helpCard(this.ways(), () => this.toggleHelp());
      this.overlay.open('help-veil', card, { first, onEscape: () => this.toggleHelp() });
    } else if (now === 'welcome') this.openWelcome();
    else if (now === 'rest') {
      const { card, first } = restCard(() => { void this.goOn(); });
      this.overlay.open('pause', card, { first });
    } else if (now === 'success' && latestState) this.openPraise(latestState);
    else this.overlay.close(now === 'watching' ? this.hud.play : this.play);
  }

  private openWelcome(): void {
    const content = { ways: this.ways(), way: this.way, robot: this.hardware, levels: this.levels, level: this.level, tone: this.tone, notice: this.notice };
    const focused = document.activeElement instanceof HTMLElement ? { ...document.activeElement.dataset } : {};
    const { card, start } = welcomeCard(content, {
      start: () => this.start(),
      watch: () => { void this.watch(); },
      language: (wanted) => this.choose(() => { setLanguage(wanted); this.picture?.setLook({ names: this.liquidNames() }); }),
      way: (wanted) => this.choose(() => this.chooseWay(wanted)),
      level: (wanted) => this.choose(() => { this.level = wanted; store(STORED.level, String(wanted)); }),
      tone: (wanted) => this.choose(() => { this.tone = wanted; store(STORED.tone, wanted); this.picture?.setLook({ tone: wanted }); }),
    });
    // A choice builds the card anew: the focus stays on what was chosen.
    const [name, value] = Object.entries(focused)[0] ?? [];
    const again = name && name !== 'testid' ? card.querySelector<HTMLElement>(`[data-${name}="${value}"]`) : null;
    this.overlay.open('welcome-veil', card, { first: again ?? start });
  }

  private choose(change: () => void): void {
    change();
    this.hud.words(this.sound.on);
    this.overlayFor(this.state);
  }

  private openPraise(state: WorldStateT): void {
    const praise = this.script ? praiseOf(this.script, state, this.spiltBefore_l) : null;
    if (!praise) return;
    this.drinkFollows = !praise.levelDone;
    // Praise stays as long as the person likes: the bar would go on to the next drink by itself.
    if (this.drinkFollows && !this.praised) void this.connection.act(Act.Pause);
    this.praised = true;
    const { card, first } = praiseCard(praise, this.level < this.levels, {
      next: () => { void this.goOn(); },
      nextLevel: () => { void this.load(this.level + 1); },
      again: () => { void this.connection.act(Act.Restart); },
      rest: () => { void this.rest(); },
    });
    this.overlay.open('success', card, { first });
  }

  private ways(): HelpSection[] {
    const touch = matchMedia('(pointer: coarse)').matches;
    const pads = navigator.getGamepads?.().some((pad) => pad !== null) ?? false;
    return this.controls.helpEntries().filter(({ way }) => (way !== 'touch' || touch) && (way !== 'gamepad' || pads || this.helpOpen));
  }

  /** Instruction, recipe, meter, amount, signs. */
  private tell(now: PageState, state: WorldStateT): void {
    const { script } = this;
    // Asked before anything is written: afterwards it would cost a layout.
    const labels = script ? this.picture?.labels() : undefined;
    this.hud.say(...this.words(now, state));
    const visible = script !== null && now !== 'welcome';
    this.hud.show(visible ? recipeOf(script, state) : null, visible && now !== 'success' && now !== 'rest' ? meterOf(script, state) : null, visible ? callOutOf(script, state) : null);
    if (script && labels) this.placeWords(script, state, now, labels);
    else if (this.blind) this.hud.place({ x_px: 0, y_px: 0 }, null);
  }

  private words(now: PageState, state: WorldStateT): [string, string] {
    const { script } = this;
    if (now === 'watching') {
      const kind = this.connection.controls.held && !this.connection.controls.heldByYou ? 'other' : state.runState === RunState.Rendering ? 'program' : 'idle';
      return [text(`watch.${kind}`), this.notice ? text('welcome.refused', { x: this.notice }) : text(`watch.${kind}More`)];
    }
    if (now === 'success' || now === 'rest') {
      const recipe = script ? recipeOf(script, state) : null;
      return ['', now === 'success' && recipe ? text('game.drinkOf', { n: recipe.drink, m: recipe.drinks }) : ''];
    }
    if (now === 'loading') return [text('game.moment'), ''];
    if (now === 'free') return [text('game.free'), text('game.freeMore')];
    if (!script || now === 'welcome') return ['', ''];
    const { title, more, liquid } = instructionOf(script, state);
    const x = nameOf('liquid', liquid);
    return [text(title, { x }), text(more, { x })];
  }

  private placeWords(script: Script, state: WorldStateT, now: PageState, { fillLine, target }: ReturnType<Picture['labels']>): void {
    const reaching = now === 'reach' || (now === 'watching' && figure(script, state, 'stage') === Stage.Reach);
    this.hud.place(fillLine, reaching && target ? this.cue(script, state, target) : null);
  }

  private cue(script: Script, state: WorldStateT, target: Point): Cue | null {
    const wanted = script.dispensers[figure(script, state, 'target_dispenser', -1)]?.body;
    const body = this.connection.scene?.bodies.findIndex((b) => String(b.name) === wanted) ?? -1;
    const bottle = state.bodies[body]?.positionM;
    const palm = state.links[this.palmLink]?.positionM;
    return bottle && palm ? cueTowards(palm.y, bottle.y, target, this.unit_px()) : null;
  }

  private liquidNames(): Record<string, string> {
    return Object.fromEntries((this.script?.dispensers ?? []).map(({ liquid }) => [liquid, nameOf('liquid', liquid)]));
  }

  /** 1u of game.css; measured anew when the screen changes, as asking for it costs a layout. */
  private unit_px(): number {
    this.unit ||= this.hud.stop.getBoundingClientRect().height / 68;
    return this.unit;
  }

  // ---- what the person presses

  private start(): void {
    this.sound.unlock();
    void this.begin();
  }

  private async begin(): Promise<void> {
    if (this.connection.status !== 'open') { this.notice = text('welcome.connecting'); return; }
    const camera = await openCamera(this.controls, this.way);
    if (!camera.accepted) { this.notice = camera.reason; return; }
    const outcome = await this.busy(takeOver(this.connection, this.known, { way: this.way, level: this.level, fresh: this.wish === 'undecided' }));
    this.notice = outcome.is === 'refused' ? outcome.reason : '';
    if (outcome.is === 'playing') this.wish = 'play';
    // Somebody else plays: there is nothing to do about it here but to watch, and that is said.
    if (outcome.is === 'another plays') this.wish = 'watch';
  }

  private readonly known = (): Known => ({ script: this.script, hardware: this.hardware });

  /** While orders are on their way: a run that is stopped to load a level is no stop to speak of. */
  private async busy<Result>(orders: Promise<Result>): Promise<Result> {
    this.loading = true;
    try {
      return await orders;
    } finally {
      this.loading = false;
    }
  }

  private async watch(): Promise<void> {
    await letProgramPlay(this.connection);
    this.wish = 'watch';
  }

  private chooseWay(way: string): void {
    this.way = way;
    store(STORED.way, way);
  }

  private async load(level: number): Promise<void> {
    this.level = level;
    store(STORED.level, String(level));
    const answer = await this.busy(changeLevel(this.connection, this.known, level));
    this.notice = answer.reason;
  }

  private async rest(): Promise<void> {
    await this.connection.act(Act.Pause);
    this.resting = true;
  }

  private async goOn(): Promise<void> {
    await this.connection.act(Act.Resume);
    if (this.drinkFollows) await this.connection.act(Act.Next);
    this.resting = false;
  }

  private stop(): void {
    this.hud.stop.classList.add('pressed');
    setTimeout(() => this.hud.stop.classList.remove('pressed'), 400);
    this.loading = false;
    void this.connection.emergencyStop();
  }

  private toggleSound(): void {
    this.sound.toggle();
    this.hud.words(this.sound.on);
  }

  private toggleHelp(): void {
    this.sound.unlock();
    this.helpOpen = !this.helpOpen;
  }
}

/** Said where the bar cannot be drawn; the words go on. */
export function noPictureCard(): HTMLElement {
  return h('section', { class: 'card nopicture', role: 'note', 'data-testid': 'nopicture' }, h('h2', { class: 't-l' }, text('webgl.title')), h('p', { class: 't-s' }, text('webgl.what')));
}
