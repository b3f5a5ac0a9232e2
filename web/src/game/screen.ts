// What the page shows: picture, words over it, and the card that lies over both.
import type { Controls } from '../input/controls';
import type { WebcamView } from '../input/webcam';
import type { Connection } from '../net/connection';
import { RunState, type SceneT, type WorldStateT } from '../protocol';
import type { ExercisePanel } from '../shared/exercise_panel';
import { inSentence, language, nameOf, setLanguage, text } from '../shared/i18n';
import { answerPresses, showPressed } from '../shared/pressed';
import { CameraView } from './camera_view';
import { bottleAndPalm, cueTowards, depthMarks, unit_px } from './cues';
import { absentCard, effortText, helpCard, leftCard, lostCard, Overlay, panelPraiseCard, praiseCard, restCard, stoppedCard, unseenCard, versionCard, welcomeCard, type HelpSection } from './dialogs';
import { Hints, type HintLevel } from './hints';
import { Hud } from './hud';
import { gripWord } from './effort';
import type { Memory } from './memory';
import type { Picture } from './picture';
import type { Presses } from './presses';
import { figure, type Script } from './script';
import type { Sound } from './sound';
import { Speech } from './speech';
import { callOutOf, causeOf, currentDrink, praiseStage, instructionOf, isFaded, isPaused, isPlaying, meterOf, panelMeter, praiseOf, recipeOf, Stage, taskOf, type PageState } from './view';
import { besideOf, playWords } from './words';

/** While one of these is shown the person does not move the hand. */
const CARDS: ReadonlySet<PageState> = new Set<PageState>(['watching', 'welcome', 'loading', 'left', 'rest', 'success', 'framing', 'unseen']);

/** What is seen of an exercise without a script is its panel, while one plays or watches. */
const PANEL: ReadonlySet<PageState> = new Set<PageState>(['free', 'watching', 'loading']);

/** A choice builds its card anew: finds in the new card what had the focus in the old one. */
function focusedChoice(): (card: HTMLElement) => HTMLElement | null {
  const [name, value] = Object.entries(document.activeElement instanceof HTMLElement ? { ...document.activeElement.dataset } : {})[0] ?? [];
  if (!name || name === 'testid') return () => null;
  const attribute = name.replace(/[A-Z]/g, (letter) => `-${letter.toLowerCase()}`);
  return (card) => card.querySelector<HTMLElement>(`[data-${attribute}="${value}"]`);
}

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
  private readonly cameraView: CameraView;
  private picture: Picture | null = null;
  private blind = false;
  private readonly overlay: Overlay;
  private readonly hints = new Hints();
  private hint: HintLevel = 0;
  private told_ms = 0;
  private shown = '';          // state and all that its dialog depends on
  private state: PageState = 'welcome';
  private givingBack = false;
  private readonly speech = new Speech(() => { if (this.behind.memory.helpOpen) this.overlayFor(this.state); });

  constructor(root: HTMLElement, private readonly play: HTMLElement, private readonly behind: Behind) {
    const { presses } = behind;
    this.hud = new Hud(root, {
      help: () => presses.help(), rest: () => this.rest(), stop: () => presses.stop(), play: () => presses.start(),
    });
    this.overlay = new Overlay(root, this.hud.strip, () => this.rest());
    this.cameraView = new CameraView({ again: () => presses.cameraAgain(), otherWay: () => presses.otherWay() });
    root.append(this.cameraView.mirror);
    answerPresses(document);
    this.hud.words();
    document.documentElement.dataset.text = behind.memory.textSize;
    behind.controls.help = behind.memory.help;
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

  camera(view: WebcamView | undefined, reason: string): void {
    this.behind.memory.framing = view !== undefined && view.step !== 'play';
    this.cameraView.show(view, reason, this.behind.controls.cameraTexts());
  }

  setState(state: WorldStateT): void { this.picture?.setState(state); }

  show(now: PageState, state: WorldStateT | null): void {
    this.enter(now);
    this.hud.alarm(this.behind.connection.stopUnconfirmed);
    if (state) this.tell(now, state);
  }

  private enter(now: PageState): void {
    const { connection, controls, memory } = this.behind;
    const { attempts, problem } = connection;
    const playing = !CARDS.has(now) && isPlaying(memory.situation(connection), connection.latestState);
    const key = [
      now, language(), problem?.theirs, connection.refusedWith, connection.loss, connection.controls.led, memory.hardware, memory.notice, memory.helpOpen, memory.unseen, memory.setHelp,
      now === 'rest' && this.restState(),
    ].join();
    this.overlay.showAttempts(attempts);
    // Whoever starts it again, at the console perhaps, may command. Asked again while an order of ours is on its way.
    if (now === 'stopped' && connection.controls.heldByYou && !this.givingBack) void this.giveBack();
    if (key === this.shown) return;
    this.shown = key;
    this.state = now;
    if (now !== 'success' && now !== 'rest') memory.praised = false;
    document.body.dataset.state = now;
    this.hud.words();
    this.hud.play.hidden = now !== 'watching' || memory.helpOpen;
    this.hud.rest.disabled = connection.status !== 'open';
    this.picture?.setLook({ names: this.liquidNames(), dimmed: now === 'welcome', grey: now === 'lost' || now === 'stopped' || now === 'absent' || now === 'left', ghostHand: now === 'lost' });
    if (now === 'lost' || now === 'stopped') {
      memory.leavePlay();
      controls.stopWebcam();
    }
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
      this.openHelp();
    } else if (now === 'framing') this.overlay.open('pause', this.cameraView.card, { first: this.cameraView.otherWay, onEscape: () => presses.otherWay() });
    else if (now === 'welcome') this.openWelcome();
    else if (now === 'left' && connection.loss !== '') {
      const { card, first } = leftCard(connection.loss, memory.notice, () => presses.start());
      this.overlay.open('pause', card, { first });
    }
    else if (now === 'unseen') {
      const back = memory.unseen === 'back';
      if (!back) presses.hold();
      const { card, first } = unseenCard(back, () => presses.seeAgain());
      this.overlay.open('pause', card, { first });
    } else if (now === 'rest') {
      const { card, first } = restCard(this.restState(), memory.notice, () => { void presses.goOn(); });
      this.overlay.open('pause', card, { first });
    } else if (now === 'success' && latestState) this.openPraise(latestState);
    else this.overlay.close(now === 'watching' ? this.hud.play : this.play);
  }

  private openHelp(): void {
    const { memory, presses, sound } = this.behind;
    const again = focusedChoice(), close = () => presses.help();
    const { card, first } = helpCard(this.ways(), { sounds: sound.on, music: sound.musicVolume, speech: this.speech.on, voice: this.speech.hasVoice, textSize: memory.textSize }, {
      sounds: () => this.choose(() => { sound.toggle(); }),
      music: (wanted) => this.choose(() => sound.setMusic(wanted)),
      speech: () => this.choose(() => this.speech.toggle()),
      textSize: (wanted) => this.choose(() => { memory.chooseTextSize(wanted); document.documentElement.dataset.text = wanted; }),
    }, close);
    this.overlay.open('help-veil', card, { first: again(card) ?? first, onEscape: close });
  }

  private openWelcome(): void {
    const { memory, presses } = this.behind;
    const { way, levels, level, tone, notice } = memory;
    const again = focusedChoice();
    const { card, start } = welcomeCard({ ways: this.ways(), way, robot: memory.hardware, levels: this.behind.connection.controls.led ? 0 : levels, level, tone, help: memory.setHelp ? null : memory.help, notice, panel: memory.panel }, {
      help: (wanted) => this.choose(() => { memory.chooseHelp(wanted); this.behind.controls.help = wanted; }),
      start: () => presses.start(),
      watch: () => { void presses.watch(); },
      language: (wanted) => this.choose(() => { setLanguage(wanted); this.picture?.setLook({ names: this.liquidNames() }); }),
      way: (wanted) => this.choose(() => memory.chooseWay(wanted)),
      level: (wanted) => this.choose(() => memory.chooseLevel(wanted)),
      tone: (wanted) => this.choose(() => { memory.chooseTone(wanted); this.picture?.setLook({ tone: wanted }); }),
    });
    this.overlay.open('welcome-veil', card, { first: again(card) ?? start });
  }

  private choose(change: () => void): void {
    change();
    this.hud.words();
    this.overlayFor(this.state);
  }

  private openPraise(state: WorldStateT): void {
    const { memory, presses } = this.behind;
    if (memory.panel) {
      const { card, first } = panelPraiseCard(memory.panel, state, { again: () => presses.again(), rest: () => { void presses.rest(); } });
      this.overlay.open('success', card, { first });
      return;
    }
    const praise = memory.script ? praiseOf(memory.script, state, memory.spiltBefore_l) : null;
    if (!praise) return;
    memory.drinkFollows = !praise.levelDone;
    if (memory.drinkFollows && !memory.praised) presses.hold();
    memory.praised = true;
    const { card, first } = praiseCard(praise, memory.level < memory.levels && !this.behind.connection.controls.led, this.effort(state), memory.countStars(praise.stars), {
      next: () => { void presses.goOn(); },
      nextLevel: () => { void presses.load(memory.level + 1); },
      again: () => presses.again(),
      rest: () => { void presses.restBetween(); },
    });
    this.overlay.open('success', card, { first });
  }

  private effort(state: WorldStateT): string {
    const { script, effort, ownGrip } = this.behind.memory;
    const drink = script && currentDrink(script, state);
    if (!drink) return '';
    return effortText(drink, drink.steps.map((_, i) => figure(script, state, `layer_l/${i}`)), gripWord(effort.grip(), ownGrip));
  }

  private ways(): HelpSection[] {
    const { controls, memory } = this.behind;
    const touch = matchMedia('(pointer: coarse)').matches;
    const pads = navigator.getGamepads?.().some((pad) => pad?.mapping === 'standard') ?? false;
    return controls.helpEntries().filter(({ way }) => (way !== 'touch' || touch) && (way !== 'gamepad' || pads || memory.helpOpen));
  }

  private rest(): void {
    showPressed(this.hud.rest);
    void this.behind.presses.rest();
  }

  /** Of the device that this person let go. */
  private restState(): '' | 'letting' | 'let' {
    const { connection, memory } = this.behind;
    if (memory.resting !== 'off') return '';
    return connection.latestState?.runState === RunState.Stopped ? 'let' : 'letting';
  }

  private async giveBack(): Promise<void> {
    this.givingBack = true;
    await this.behind.connection.releaseControls();
    this.givingBack = false;
  }

  // ---- the words over the picture

  /** Instruction, recipe, meter, amount, signs. */
  private tell(now: PageState, state: WorldStateT): void {
    const { script } = this.behind.memory;
    // Asked before anything is written: afterwards it would cost a layout.
    const labels = script ? this.picture?.labels() : undefined;
    this.hint = this.hintNow(now, state);
    const said = this.words(now, state);
    this.hud.say(...said);
    this.speak(now, said);
    const { panel } = this.behind.memory;
    const visible = script !== null && now !== 'welcome' && now !== 'framing' && now !== 'unseen';
    const shown = PANEL.has(now) ? panel : null;
    this.hud.panel.show(shown, state, performance.now());
    this.hud.show(visible ? recipeOf(script, state) : null, visible && now !== 'success' && now !== 'rest' ? meterOf(script, state) : shown && panelMeter(shown, state), visible ? callOutOf(script, state) : null);
    if (script && labels) this.placeWords(script, state, now, labels);
    else if (this.blind) this.hud.place({ x_px: 0, y_px: 0 }, null);
  }

  /** The same words as are read. */
  private speak(now: PageState, [title, more]: [string, string]): void {
    const told: Partial<Record<PageState, [string, string]>> = {
      stopped: [text('stopped.title'), text('stopped.what')], lost: [text('lost.title'), text('lost.what')], rest: [text('rest.title'), ''],
      welcome: ['', ''], success: [text('success.title'), [title, this.behind.connection.latestState ? this.effort(this.behind.connection.latestState) : ''].filter(Boolean).join(' ')],
    };
    this.speech.tell(...(told[now] ?? [title, more]), performance.now());
  }

  /** How much of a hint is due; at the last one the hand shows what to do. */
  private hintNow(now: PageState, state: WorldStateT): HintLevel {
    const { controls, memory } = this.behind;
    const now_ms = performance.now(), dt_s = Math.min(0.25, (now_ms - this.told_ms) / 1000);
    this.told_ms = now_ms;
    const busy = memory.helpOpen || controls.onItsWay || controls.moving;
    const level = this.hints.look(memory.script && !busy ? taskOf(now, memory.script, state) : '', dt_s);
    if (level === 3 && this.hint < 3) controls.show();
    return level;
  }

  private words(now: PageState, state: WorldStateT): [string, string] {
    const { connection: { controls, scene }, memory } = this.behind;
    const { script, notice } = memory;
    if (now === 'watching') {
      const kind = controls.held && !controls.heldByYou ? 'other' : state.runState === RunState.Rendering ? 'program' : 'idle';
      if (state.runState === RunState.Rendering && isPaused(script, state)) return [text('watch.paused'), text('watch.pausedMore')];
      if (kind === 'program' && isFaded(state)) return [text('watch.program'), text('watch.fadedMore')];
      // The same steps in the same words as when playing.
      if (kind === 'program' && script && !notice) {
        if (praiseStage(script, state)) return [text('success.guest'), text('watch.programMore')];
        const { title, liquid } = instructionOf(script, state);
        return [text(title, { x: inSentence(liquid) }), text('watch.programMore')];
      }
      return [text(`watch.${kind}`), notice ? text('welcome.refused', { x: notice }) : text(`watch.${kind}More`)];
    }
    if (now === 'success' || now === 'rest') {
      const recipe = script ? recipeOf(script, state) : null;
      return [now === 'success' && recipe ? text('success.guest') : '', now === 'success' && recipe ? text('game.drinkOf', { n: recipe.drink, m: recipe.drinks }) : ''];
    }
    if (now === 'loading') return [text('game.moment'), ''];
    if (now === 'free') return this.behind.memory.panel ? this.panelWords(this.behind.memory.panel, state) : [text('game.free'), text('game.freeMore')];
    if (!script || now === 'welcome' || now === 'framing' || now === 'unseen' || now === 'left' || now === 'lost') return ['', ''];
    if (isPaused(script, state)) return [text('watch.paused'), text('watch.pausedMore')];
    const { controls: aim } = this.behind;
    const { title, more, liquid } = playWords(script, state, {
      now, help: memory.help, hint: this.hint, wrong: memory.wrong, oneButton: memory.way !== 'webcam' && !memory.hardware,
      onItsWay: aim.onItsWay, outOfReach: aim.outOfReach, closing: aim.squeeze > 0, beside: scene && besideOf(script, scene, state, memory.palmLink),
    });
    const x = inSentence(liquid);
    return [text(title, { x }), text(more, { x })];
  }

  /** What to do now; where the exercise does not say, what it is about. */
  private panelWords(panel: ExercisePanel, state: WorldStateT): [string, string] {
    const now = panel.instruction(state);
    return now ? [now, ''] : [panel.title, panel.lead];
  }

  private placeWords(script: Script, state: WorldStateT, now: PageState, { fillLine, target }: ReturnType<Picture['labels']>): void {
    const reaching = now === 'reach' || (now === 'watching' && figure(script, state, 'stage') === Stage.Reach);
    const { connection: { scene }, memory } = this.behind, { picture } = this;
    const both = bottleAndPalm(script, state, scene, memory.palmLink);
    this.hud.place(fillLine, both && reaching && target ? cueTowards(both.palm.y, both.bottle.y, scene?.rightHand !== false, target, unit_px()) : null);
    this.hud.depth(both && picture && this.hint >= 2 && now === 'reach' ? depthMarks(script, both, scene?.rightHand !== false, (at) => picture.project(at)) : null);
  }

  private liquidNames(): Record<string, string> {
    return Object.fromEntries((this.behind.memory.script?.dispensers ?? []).map(({ liquid }) => [liquid, nameOf('liquid', liquid)]));
  }
}
