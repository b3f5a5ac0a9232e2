// Chooses the card over the play, fills it, and connects its buttons.
import { FIRST } from '../exercises';
import type { ExerciseWords, Praise } from '../exercises/exercise';
import type { Controls } from '../input/controls';
import type { Connection } from '../net/connection';
import { RunState, type WorldStateT } from '../protocol';
import { setLanguage, text } from '../shared/i18n';
import type { ToneName as Tone } from '../hand/tones';
import type { CameraView } from './camera_view';
import { absentCard, endedCard, helpCard, leftCard, lostCard, Overlay, praiseCard, restCard, stoppedCard, unseenCard, versionCard, welcomeCard, type HelpSection, type LettingGo } from './dialogs';
import type { Hud } from './hud';
import type { Memory, TextSize } from './memory';
import { causeOf, type PageState } from './page_state';
import type { Presses } from './presses';
import type { Sound } from './sound';
import { Speech } from './speech';

/** The parts of the page that cards show and act on. */
export interface CardContext {
  readonly connection: Connection;
  readonly controls: Controls;
  readonly memory: Memory;
  readonly presses: Presses;
  readonly sound: Sound;
}

/** Remembers the focused choice, and finds it again in a rebuilt card. */
function focusedChoice(): (card: HTMLElement) => HTMLElement | null {
  const [name, value] = Object.entries(document.activeElement instanceof HTMLElement ? { ...document.activeElement.dataset } : {})[0] ?? [];
  if (!name || name === 'testid') return () => null;
  const attribute = name.replace(/[A-Z]/g, (letter) => `-${letter.toLowerCase()}`);
  return (card) => card.querySelector<HTMLElement>(`[data-${attribute}="${value}"]`);
}

/** What is said of a part that the program moved, wholly or partly: results would be its own. */
const uncredited = (praise: Praise): Praise => ({ ...praise, stars: undefined, figures: [], effort: text('success.notYours') });

const helped = (praise: Praise): Praise => ({ ...praise, effort: [praise.effort, text('success.withHelp')].filter(Boolean).join(' ') });

export interface CardActions { rest(): void; tone(wanted: Tone): void }

export class Cards {
  readonly speech = new Speech(() => { if (this.behind.memory.helpOpen) this.show(this.state); });
  private readonly overlay: Overlay;
  private state: PageState = 'welcome';

  constructor(
    root: HTMLElement, private readonly play: HTMLElement, private readonly hud: Hud, private readonly camera: CameraView,
    private readonly behind: CardContext, private readonly actions: CardActions,
  ) {
    this.overlay = new Overlay(root, hud.strip, () => actions.rest());
  }

  /** The state of a rest in which the device is released. */
  get restState(): LettingGo {
    const { connection: { latestState }, memory } = this.behind;
    return memory.resting === 'off' ? this.letting(latestState) : '';
  }

  /** What is known of a stop: only heard, obeyed, or at its end. */
  letting(state: WorldStateT | null): LettingGo {
    if (state?.stopPending) return 'heard';
    return state?.runState === RunState.Stopped || state?.runState === RunState.Faulted ? 'let' : 'letting';
  }

  showAttempts(attempts: number): void { this.overlay.showAttempts(attempts); }

  /** Shows the card of a state; none while the person plays or watches. */
  show(now: PageState): void {
    this.state = now;
    const { connection, memory, presses } = this.behind;
    const { attempts, latestState, problem } = connection;
    if (now === 'version') this.overlay.open('low', versionCard(problem?.ours ?? 0, problem?.theirs ?? 0));
    else if (now === 'lost') this.overlay.open('low', lostCard(attempts, memory.hardware));
    else if (now === 'absent') this.overlay.open('low', absentCard(attempts, connection.refusedWith));
    else if (now === 'stopped') this.overlay.open('stop', stoppedCard(this.letting(latestState), latestState ? causeOf(connection.scene, latestState) : ''), { alone: true });
    else if (now === 'ended') this.overlay.open('pause', endedCard(memory.visitWords, memory.stars.count));
    else if (memory.helpOpen) {
      this.openHelp();
    } else if (now === 'framing') this.overlay.open('pause', this.camera.card, { first: this.camera.otherWay, onEscape: () => presses.otherWay() });
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
      const { card, first } = restCard(this.restState, memory.notice, () => { void presses.goOn(); });
      this.overlay.open('pause', card, { first });
    } else if (now === 'success' && latestState) this.openPraise(latestState);
    else this.overlay.close(now === 'watching' ? this.hud.play : this.play);
  }

  private openHelp(): void {
    const { memory, presses, sound } = this.behind;
    const again = focusedChoice(), close = () => presses.help();
    const { card, first } = helpCard(this.ways(), { help: memory.setHelp || !this.exerciseWords.oneButton() ? null : memory.help, levels: this.behind.connection.controls.led ? 0 : memory.levels, level: memory.level, hand: this.behind.connection.controls.led || memory.hardware || !memory.hands ? null : memory.side, recordings: !this.behind.connection.controls.led, sounds: sound.on, music: sound.musicVolume, speech: this.speech.on, voice: this.speech.hasVoice, textSize: memory.textSize }, {
      language: (wanted) => this.choose(() => setLanguage(wanted)),
      help: (wanted) => this.choose(() => { memory.chooseHelp(wanted); this.behind.controls.help = wanted; }),
      level: (wanted) => this.chooseLoaded(() => memory.chooseLevel(wanted)),
      hand: (wanted) => this.chooseLoaded(() => memory.chooseHand(wanted)),
      sounds: () => this.choose(() => { sound.toggle(); }),
      music: (wanted) => this.choose(() => sound.setMusic(wanted)),
      speech: () => this.choose(() => this.speech.toggle()),
      textSize: (wanted) => this.chooseTextSize(wanted),
    }, close);
    this.overlay.open('help-veil', card, { first: again(card) ?? first, onEscape: close });
  }

  private openWelcome(): void {
    const { memory, presses } = this.behind;
    const { way, levels, level, tone, notice } = memory;
    const again = focusedChoice();
    const { card, start } = welcomeCard({ ways: this.ways(), way, robot: memory.hardware, levels: this.behind.connection.controls.led ? 0 : levels, level, tone, textSize: memory.textSize, help: memory.setHelp || !this.exerciseWords.oneButton() ? null : memory.help, connected: this.behind.connection.connected, notice, words: this.exerciseWords }, {
      help: (wanted) => this.choose(() => { memory.chooseHelp(wanted); this.behind.controls.help = wanted; }),
      start: () => presses.start(),
      watch: () => { void presses.watch(); },
      language: (wanted) => this.choose(() => setLanguage(wanted)),
      way: (wanted) => this.choose(() => memory.chooseWay(wanted)),
      level: (wanted) => this.choose(() => memory.chooseLevel(wanted)),
      textSize: (wanted) => this.chooseTextSize(wanted),
      tone: (wanted) => this.choose(() => { memory.chooseTone(wanted); this.actions.tone(wanted); }),
    });
    this.overlay.open('welcome-veil', card, { first: again(card) ?? start });
  }

  private chooseTextSize(wanted: TextSize): void {
    this.choose(() => { this.behind.memory.chooseTextSize(wanted); document.documentElement.dataset.text = wanted; });
  }

  /** A level or a hand: loaded at once where the person plays, else with Start. */
  private chooseLoaded(change: () => void): void {
    const { memory, presses } = this.behind;
    if (memory.wish !== 'play') return this.choose(change);
    change();
    presses.help();
    void presses.load();
  }

  private choose(change: () => void): void {
    change();
    this.hud.words();
    this.show(this.state);
  }

  private openPraise(state: WorldStateT): void {
    const { memory, presses } = this.behind;
    const praise = memory.play?.praise(state, memory.ownGrip);
    if (!praise) return;
    memory.partFollows = !praise.levelDone;
    if (memory.partFollows && !memory.praised) presses.hold();
    memory.praised = true;
    const more = memory.level < memory.levels && !this.behind.connection.controls.led;
    const { card, first } = praiseCard(!memory.credit.own ? uncredited(praise) : memory.ownGrip ? praise : helped(praise), more, praise.stars === undefined || !memory.credit.own ? 0 : memory.countStars(praise.stars), {
      next: () => { void presses.goOn(); },
      nextLevel: () => { memory.chooseLevel(memory.level + 1); void presses.load(); },
      again: () => presses.again(),
      rest: () => this.restAfter(praise),
    });
    this.overlay.open('success', card, { first });
  }

  /** Rests after praise. An exercise without stars has no parts: there the device is released. */
  private restAfter({ stars }: Praise): void {
    const { presses } = this.behind;
    void (stars === undefined ? presses.rest() : presses.restBetween());
  }

  /** The texts of the loaded exercise, or of the one that will be loaded. */
  private get exerciseWords(): ExerciseWords { return (this.behind.memory.play ?? FIRST).words; }

  private ways(): HelpSection[] {
    const { controls, memory } = this.behind;
    const touch = matchMedia('(pointer: coarse)').matches;
    const pads = navigator.getGamepads?.().some((pad) => pad?.mapping === 'standard') ?? false;
    return controls.helpEntries(this.exerciseWords.oneButton()).filter(({ way }) => (way !== 'touch' || touch) && (way !== 'gamepad' || pads || memory.helpOpen));
  }
}
