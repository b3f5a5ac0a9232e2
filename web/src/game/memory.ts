// The page's memory: the person's choices and current activity, and earlier reports of the program.
import { playOf } from '../exercises';
import type { Play } from '../exercises/exercise';
import type { Connection } from '../net/connection';
import { HandPart, Help as HelpSet, RunState, type SceneT, type WorldStateT } from '../protocol';
import { store, stored, text } from '../shared/i18n';
import { TONES, type ToneName as Tone } from '../hand/tones';
import { Credit } from './credit';
import { Stars } from './stars';
import type { PlayContext, Press } from './takeover';
import { hasHardware } from '../shared/hardware';
import { isFaded, type RestState, type Situation, type PictureLoss } from './page_state';
import { HELPS, type Help } from '../input/wish';

const STORED = { text: 'wholehand.text', tone: 'wholehand.tone', level: 'wholehand.level', way: 'wholehand.way', help: 'wholehand.help' } as const;

function storedTone(): Tone {
  const tone = stored(STORED.tone);
  return tone !== null && tone in TONES ? tone as Tone : 'honey';
}

/** The help that the therapist has set; without an entry the player chooses. */
const SET: Partial<Record<HelpSet, Help>> = { [HelpSet.Full]: 'full', [HelpSet.Some]: 'some', [HelpSet.None]: 'none' };

function storedHelp(): Help {
  const wanted = new URLSearchParams(location.search).get('help') ?? stored(STORED.help);
  return HELPS.find((help) => help === wanted) ?? 'full';
}

/** The session that was played in this tab: a reload continues it. */
const PLAYED = 'wholehand.played';

function playedSession(): number {
  try { return Number(sessionStorage.getItem(PLAYED) ?? -1); } catch { return -1; }
}

/** The part that was under way in this tab was the person's. */
const OWN = 'wholehand.own';

function ownPart(): boolean {
  try { return sessionStorage.getItem(OWN) === 'true'; } catch { return false; }
}

export type Side = 'right' | 'left';

/** Sizes of the text. Text that must be read during play is always large (game.css). */
export const TEXT_SIZES = ['normal', 'far'] as const;
export type TextSize = typeof TEXT_SIZES[number];

/** Names of a hand of either side, where the program has both. */
function bothSides({ handName, hands, rightHand }: Pick<SceneT, 'handName' | 'hands' | 'rightHand'>): Record<Side, string> | undefined {
  const own = String(handName ?? ''), other = rightHand ? own.replace('right', 'left') : own.replace('left', 'right');
  if (other === own || !hands.map(String).includes(other)) return undefined;
  return rightHand ? { right: own, left: other } : { right: other, left: own };
}

export class Memory {
  // Choices of the person, from this visit or an earlier one.
  tone: Tone = storedTone();
  way = stored(STORED.way) ?? (matchMedia('(pointer: coarse)').matches ? 'touch' : 'mouse');
  level = 1;
  hand: string | undefined;    // chosen for the next load; undefined: the loaded one
  private chosenHelp: Help = storedHelp();
  textSize: TextSize = stored(STORED.text) === 'far' ? 'far' : 'normal';

  // Current activity of the person.
  wish: Situation['wish'] = new URLSearchParams(location.search).has('watch') ? 'watch' : 'undecided';
  press: Press | null = null;  // the press whose orders are under way
  endingsShown = 0;            // the newest ending of the program that is on the screen
  basisShown = 0;              // the number of the person, hand, level and limits on the screen
  resting: RestState = 'no';
  playedBeforeRest = false;
  isTheirs = true;             // the current part is played by the program or another client
  helpOpen = false;
  unseen: PictureLoss = 'no';
  framing = false;             // the camera waits for a hand in its frame before it steers
  notice = '';                 // why an order was refused

  // Reports of the program.
  play: Play | null = null;
  levels = 1;
  /** The loaded hand and its mirror image; undefined where there is none. */
  hands: { readonly right: string; readonly left: string } | undefined;
  private rightHand = true;
  palmLink = 0;
  hardware = false;
  setHelp: Help | undefined;   // set by the therapist
  everOpen = false;

  // The current part of the exercise.
  partFollows = false;         // another part comes after it
  praised = false;             // the current part was praised
  readonly credit = new Credit();
  readonly stars = new Stars();
  /** The page has seen a visit of the clinic, and it has not been followed by a session without one. */
  private inVisit = false;
  private visitOver = false;
  private starsCounted = false;   // the stars of this part were added
  private restSeen = false;    // the program has reported this rest
  private readonly playedBefore = playedSession();
  private readonly ownBefore = ownPart();
  private ownStored: boolean | undefined;
  private loadedLevel = 1;
  private session = 0;            // number of the newest session: a program that was started again counts from 1

  /** Facts that orders read again while they are under way, because they change them. */
  readonly known = (): PlayContext => ({ play: this.play, hardware: this.hardware });

  situation({ status, problem, attempts, controls, loss }: Connection): Situation {
    const { everOpen, wish, resting, framing, unseen } = this;
    const loading = this.press?.holds ?? false;
    const visit = this.visitOver ? 'over' : this.inVisit ? 'open' : 'none';
    return { status, problem, everOpen, attempts, wish, loading, resting, framing, unseen, loss, held: controls, visit };
  }

  /** What the end of an exercise of a visit means for the person. */
  get visitWords(): string { return this.visitOver ? text('ended.over') : text('ended.next'); }

  chooseTone(wanted: Tone): void { this.tone = wanted; store(STORED.tone, wanted); }
  chooseWay(wanted: string): void { this.way = wanted; store(STORED.way, wanted); }
  chooseHelp(wanted: Help): void { this.chosenHelp = wanted; store(STORED.help, wanted); }
  chooseHand(wanted: Side): void { this.hand = this.hands?.[wanted]; }
  get side(): Side { return (this.hand === undefined ? this.rightHand : this.hand === this.hands?.right) ? 'right' : 'left'; }
  get help(): Help { return this.setHelp ?? this.chosenHelp; }
  chooseLevel(wanted: number): void { this.level = wanted; store(STORED.level, String(wanted)); }

  chooseTextSize(wanted: TextSize): void { this.textSize = wanted; store(STORED.text, wanted); }

  /** Whether the measured grip is the person's own: with full help the page squeezes. */
  get ownGrip(): boolean { return this.hardware || this.help !== 'full'; }

  /** The person's stars, including those of this part, which are added once. */
  countStars(won: number): number {
    if (this.starsCounted) return this.stars.count;
    this.starsCounted = true;
    return this.stars.add(won);
  }

  /** Ends the play. Only a press of the person begins it again. */
  leavePlay(): void {
    if (this.wish === 'play') this.wish = 'watch';
    this.resting = 'no';
    this.helpOpen = false;
  }

  /** Records that this page plays now. */
  remember(state: WorldStateT | null): void {
    try { sessionStorage.setItem(PLAYED, String(state?.session ?? -1)); } catch { /* without storage a reload starts anew */ }
  }

  /** Records whose the present part is, for a reload. */
  rememberCredit(): void {
    if (this.credit.own === this.ownStored) return;
    this.ownStored = this.credit.own;
    try { sessionStorage.setItem(OWN, String(this.ownStored)); } catch { /* without storage a reload credits nothing */ }
  }

  /** Begins a rest, in which the device is released. It is over when the device renders again, or when another stop happens. */
  beginRest(): void {
    this.resting = 'off';
    this.restSeen = false;
  }

  takeScene(scene: SceneT): void {
    this.play = playOf(scene, this.play);
    this.levels = Math.max(1, scene.levels);
    if (Number(scene.visit ?? 0) > 0 || !this.inVisit) this.stars.belongTo(scene.visit ?? 0, String(scene.profile ?? ''));
    this.visitOver = Number(scene.visit ?? 0) === 0 && this.inVisit;
    this.inVisit ||= Number(scene.visit ?? 0) > 0;
    const wanted = Number(new URLSearchParams(location.search).get('level') ?? stored(STORED.level) ?? 0);
    this.level = this.wish === 'undecided' && wanted >= 1 && wanted <= this.levels ? wanted : Math.max(1, scene.level);
    this.loadedLevel = Math.max(1, scene.level);
    this.rightHand = scene.rightHand;
    this.hands = bothSides(scene);
    this.hand = undefined;
    this.palmLink = scene.capsules.find((capsule) => capsule.part === HandPart.Palm)?.link ?? 0;
  }

  takeState(state: WorldStateT): void {
    this.hardware = hasHardware(state);
    if (state.session < this.session && this.wish === 'play') this.notice = text('watch.restarted');
    this.session = state.session;
    this.setHelp = SET[state.help];
    this.restSeen ||= state.rested;
    if (this.resting === 'off' && this.restSeen && state.runState === RunState.Rendering) this.resting = 'no';
    if (this.play?.follow(state)) this.starsCounted = false;
    if (this.play) this.credit.follow(state, this.play);
    if (this.visitOver && state.runState === RunState.Rendering) this.visitOver = this.inVisit = false;
    // Nobody has played since this tab did, so its play continues.
    if (this.wish !== 'undecided' || !this.isTheirs || state.session !== this.playedBefore || !isFaded(state)) return;
    this.isTheirs = false;
    this.credit.own = this.ownBefore;
    this.level = this.loadedLevel;
  }
}
