// The page's display: picture, texts over it, and the card over both.
import { targetsOf } from '../exercises';
import type { GraspTargets, Play } from '../exercises/exercise';
import type { WebcamView } from '../input/webcam';
import type { GameBodyShown } from '../net/game_bodies';
import { RunState, type SceneT, type WorldStateT } from '../protocol';
import { alarmTitle, alarmWords } from '../shared/alarm';
import { language, text } from '../shared/i18n';
import { answerPresses, showPressed } from '../shared/pressed';
import { isRecorded } from '../shared/recorded';
import { CameraView } from './camera_view';
import { cueTowards, depthMarks, targetAndPalm, unit_px } from './cues';
import { Cards, type CardContext } from './cards';
import { stoppedWords } from './dialogs';
import { Hints, type HintLevel } from './hints';
import { Hud } from './hud';
import type { Picture } from './picture';
import { isFaded, isPlaying, type PageState } from './page_state';
import { palmOffsetOf, playWords } from './words';

/** States in which the person does not move the hand. */
const CARDS: ReadonlySet<PageState> = new Set<PageState>(['silent', 'watching', 'welcome', 'loading', 'left', 'rest', 'success', 'framing', 'unseen', 'ended']);

/** States in which an exercise without a card of its own shows its panel. */
const PANEL: ReadonlySet<PageState> = new Set<PageState>(['free', 'watching', 'loading']);

export class Screen {
  readonly hud: Hud;
  private readonly cameraView: CameraView;
  private picture: Picture | null = null;
  private blind = false;
  private readonly cards: Cards;
  private readonly hints = new Hints();
  private hint: HintLevel = 0;
  private shown_ms = 0;
  private shown = '';          // key of the state and of everything that its dialog depends on
  private givingBack = false;
  private targets: GraspTargets | null = null;

  constructor(root: HTMLElement, play: HTMLElement, private readonly behind: CardContext) {
    const { presses } = behind;
    this.hud = new Hud(root, {
      help: () => presses.help(), rest: () => this.rest(), stop: () => presses.stop(), play: () => presses.start(), answer: (chosen) => presses.answer(chosen),
    });
    this.cameraView = new CameraView({ again: () => presses.cameraAgain(), otherWay: () => presses.otherWay() });
    this.cards = new Cards(root, play, this.hud, this.cameraView, behind, { rest: () => this.rest(), tone: (wanted) => this.picture?.setLook({ tone: wanted }) });
    root.append(this.cameraView.mirror);
    // Browsers show a pad only once it was pressed, mostly after the page was loaded.
    for (const change of ['gamepadconnected', 'gamepaddisconnected']) addEventListener(change, () => { this.shown = ''; });
    answerPresses(document);
    this.hud.words();
    document.documentElement.dataset.text = behind.memory.textSize;
    behind.controls.help = behind.memory.help;
    this.cards.show('welcome');
  }

  /** Sets the picture; null where it cannot be drawn: the amount then stands by itself. */
  setPicture(picture: Picture | null): void {
    this.picture = picture;
    this.blind = picture === null;
    picture?.setLook({ tone: this.behind.memory.tone });
    if (picture && this.behind.connection.scene) picture.setScene(this.behind.connection.scene);
    picture?.setBodies(this.behind.connection.bodies);
    this.shown = '';
  }

  setScene(scene: SceneT): void {
    this.picture?.setScene(scene);
    this.targets = targetsOf(scene);
    document.body.dataset.hand = scene.rightHand ? 'right' : 'left';
    this.shown = '';
  }

  camera(view: WebcamView | undefined, reason: string): void {
    this.behind.memory.framing = view !== undefined && view.step !== 'play';
    this.cameraView.show(view, reason, this.behind.controls.cameraTexts());
  }

  setBodies(bodies: readonly GameBodyShown[]): void { this.picture?.setBodies(bodies); }

  setState(state: WorldStateT): void {
    this.picture?.setState(state);
    this.picture?.setMarks(this.behind.memory.play?.marks?.());
  }

  show(now: PageState, state: WorldStateT | null): void {
    this.enter(now);
    this.hud.alarm(this.behind.connection.stopUnconfirmed);
    if (state) this.writeWords(now, state);
  }

  private enter(now: PageState): void {
    const { connection, controls, memory } = this.behind;
    const { attempts, problem } = connection;
    const playing = !CARDS.has(now) && isPlaying(memory.situation(connection), connection.latestState);
    const key = [
      now, language(), connection.connected, problem?.theirs, connection.refusedWith, connection.loss, connection.controls.led, memory.hardware, memory.notice, memory.helpOpen, memory.unseen, memory.setHelp, memory.level, now === 'ended' && memory.visitWords,
      now === 'rest' && this.cards.restState, now === 'stopped' && this.cards.letting(connection.latestState),
    ].join();
    this.cards.showAttempts(attempts);
    // After a stop the controls are given back, so that the next person to start may command.
    if ((now === 'stopped' || now === 'ended') && connection.controls.heldByYou && !this.givingBack) void this.giveBack();
    if (key === this.shown) return;
    this.shown = key;
    if (now !== 'success' && now !== 'rest') memory.praised = false;
    document.body.dataset.state = now;
    this.hud.words();
    this.hud.play.hidden = now !== 'watching' || memory.helpOpen;
    this.hud.rest.disabled = connection.status !== 'open';
    this.picture?.setLook({ dimmed: now === 'welcome', grey: now === 'lost' || now === 'stopped' || now === 'absent' || now === 'left' || now === 'silent', ghostHand: now === 'lost' });
    if (now === 'lost' || now === 'stopped' || now === 'ended') {
      memory.leavePlay();
      controls.stopWebcam();
    }
    if (playing && !memory.helpOpen) controls.enable(); else controls.disable();
    this.cards.show(now);
  }

  private rest(): void {
    showPressed(this.hud.rest);
    void this.behind.presses.rest();
  }

  private async giveBack(): Promise<void> {
    this.givingBack = true;
    await this.behind.connection.releaseControls();
    this.givingBack = false;
  }

  // ---- the texts over the picture

  /** Updates instruction, card, meter, amount and cues. */
  private writeWords(now: PageState, state: WorldStateT): void {
    const { play } = this.behind.memory;
    const own = play !== null && play.panel === null;
    // The labels are read before anything is written: otherwise the browser would compute the layout again.
    const labels = own ? this.picture?.labels() : undefined;
    this.hint = this.hintNow(now, state);
    const words = this.words(now, state);
    this.hud.writeInstruction(...words);
    this.speak(now, words);
    this.hud.record(isRecorded(this.behind.connection.scene, state));
    const panel = PANEL.has(now) ? play?.panel ?? null : null;
    this.hud.panel.show(panel, state, performance.now());
    const shown = own && now !== 'silent' && now !== 'welcome' && now !== 'framing' && now !== 'unseen' ? play : null;
    const metered = panel ? play : now !== 'success' && now !== 'rest' && now !== 'ended' ? shown : null;
    this.hud.show(shown?.card(state) ?? null, metered?.meter(state) ?? null, shown?.goal(state) ?? null);
    if (own && labels) this.placeWords(play, state, now, labels);
    else if (this.blind) this.hud.place({ x_px: 0, y_px: 0 }, null);
  }

  /** Speaks the text on the screen. */
  private speak(now: PageState, [title, more]: [string, string]): void {
    const { memory } = this.behind;
    const spoken: Partial<Record<PageState, [string, string]>> = {
      stopped: [text('stopped.title'), text(stoppedWords(this.cards.letting(this.behind.connection.latestState)))], silent: [alarmWords(this.behind.connection.latestState), ''], lost: [text('lost.title'), text('lost.what')], rest: [text('rest.title'), ''],
      welcome: ['', ''], ended: [memory.visitWords, ''], success: [text('success.title'), now === 'success' ? [title, this.effort()].filter(Boolean).join(' ') : ''],
    };
    this.cards.speech.onInstruction(...(spoken[now] ?? [title, more]), performance.now());
  }

  private effort(): string {
    const { memory, connection: { latestState } } = this.behind;
    return (latestState && memory.play?.praise(latestState, memory.ownGrip)?.effort) ?? '';
  }

  /** The current hint; with the last one the hand shows the task. */
  private hintNow(now: PageState, state: WorldStateT): HintLevel {
    const { controls, memory } = this.behind;
    const now_ms = performance.now(), dt_s = Math.min(0.25, (now_ms - this.shown_ms) / 1000);
    this.shown_ms = now_ms;
    const busy = memory.helpOpen || controls.onItsWay || controls.moving;
    const level = this.hints.look(memory.play && !busy && now === memory.play.phase(state) ? memory.play.todo(state) : '', dt_s);
    if (level === 3 && this.hint < 3) controls.show();
    return level;
  }

  private words(now: PageState, state: WorldStateT): [string, string] {
    const { connection: { scene }, controls, memory } = this.behind;
    const { play } = memory;
    if (now === 'silent') return alarmTitle(state);
    if (now === 'watching') return this.watchingWords(play, state);
    if (now === 'loading') return [text('game.moment'), ''];
    if (now === 'free' && !play) return [text('game.free'), text('game.freeMore')];
    if (!play || now !== play.phase(state)) return ['', ''];
    if (now === 'success') {
      const { title, more } = play.donePrompt(state);
      return [title, more];
    }
    if (play.isPaused(state)) return [text('watch.paused'), text('watch.pausedMore')];
    const { title, more } = playWords(play, state, {
      now, help: memory.help, hint: this.hint, oneButton: memory.way !== 'webcam' && !memory.hardware,
      onItsWay: controls.onItsWay, outOfReach: controls.outOfReach, closing: controls.squeeze > 0, acts: controls.acts, press: controls.pressName, letGo: controls.letGoWords, inVain: controls.holdWords,
      beside: scene && this.targets && palmOffsetOf(this.targets, scene.rightHand, state, memory.palmLink),
    });
    return [title, more];
  }

  /** The text while somebody else plays; the virtual patient's steps have the same text as a person's. */
  private watchingWords(play: Play | null, state: WorldStateT): [string, string] {
    const { connection: { controls }, memory: { notice } } = this.behind, { led } = controls;
    const renders = state.runState === RunState.Rendering;
    const kind = controls.held && !controls.heldByYou ? 'other' : renders ? 'program' : 'idle';
    if (renders && play?.isPaused(state)) return [text('watch.paused'), text('watch.pausedMore')];
    if (kind === 'program' && isFaded(state)) return [text('watch.program'), text('watch.fadedMore')];
    const title = kind === 'program' && !notice ? play?.watchedTitle(state) : '';
    if (title) return [title, text('watch.programMore')];
    if (notice) return [text(`watch.${kind}`), notice === text('watch.restarted') ? notice : text('welcome.refused', { x: notice })];
    return kind === 'idle' && led ? [play?.words.title() || text('watch.idle'), text('watch.ledMore')] : [text(`watch.${kind}`), text(`watch.${kind}More`)];
  }

  private placeWords(play: Play, state: WorldStateT, now: PageState, { goal, target }: ReturnType<Picture['labels']>): void {
    const reaching = now === 'reach' || (now === 'watching' && play.phase(state) === 'reach');
    const { connection: { scene }, memory } = this.behind, { picture, targets } = this;
    const right = scene?.rightHand !== false;
    const both = targets && targetAndPalm(targets, state, memory.palmLink);
    this.hud.place(goal, both && reaching && target && !targets.met?.(state, targets.wanted(state))?.pushes ? cueTowards(both.palm.y, both.target.y, right, target, unit_px()) : null);
    this.hud.depth(both && picture && this.hint >= 2 && now === 'reach' ? depthMarks(both, targets.counter_z_m, right, (at) => picture.project(at)) : null);
  }
}
