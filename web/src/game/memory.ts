// What the page remembers: what the person chose and is about, and what the program told before.
import type { Connection } from '../net/connection';
import { HandPart, type SceneT, type WorldStateT } from '../protocol';
import { store, stored } from '../shared/i18n';
import { TONES, type Tone } from './dialogs';
import { figure, readScript, type Script } from './script';
import type { Known, Press } from './takeover';
import { hasHardware, Stage, type Situation } from './view';

const STORED = { tone: 'wholehand.tone', level: 'wholehand.level', way: 'wholehand.way' } as const;

function storedTone(): Tone {
  const tone = stored(STORED.tone);
  return tone !== null && tone in TONES ? tone as Tone : 'honey';
}

export class Memory {
  // Chosen, here or at an earlier visit.
  tone: Tone = storedTone();
  way = stored(STORED.way) ?? (matchMedia('(pointer: coarse)').matches ? 'touch' : 'mouse');
  level = 1;

  // What the person is about.
  wish: Situation['wish'] = new URLSearchParams(location.search).has('watch') ? 'watch' : 'undecided';
  press: Press | null = null;  // whose orders are on their way
  endingsShown = 0;            // of the program's endings, the last one that is on the screen
  resting = false;
  helpOpen = false;
  notice = '';                 // why something was refused

  // Told by the program.
  script: Script | null = null;
  levels = 1;
  palmLink = 0;
  hardware = false;
  everOpen = false;

  // The drink that is mixed.
  drinkFollows = false;
  praised = false;             // for the drink that is done now
  spiltBefore_l = 0;
  private drinkSeen = -1;

  /** For orders, which change it while they are on their way. */
  readonly known = (): Known => ({ script: this.script, hardware: this.hardware });

  situation({ status, problem, attempts, controls, loss }: Connection): Situation {
    const { everOpen, wish, resting } = this;
    const loading = this.press?.holds ?? false;
    return { status, problem, everOpen, attempts, wish, loading, resting, loss, held: controls };
  }

  chooseTone(wanted: Tone): void { this.tone = wanted; store(STORED.tone, wanted); }
  chooseWay(wanted: string): void { this.way = wanted; store(STORED.way, wanted); }
  chooseLevel(wanted: number): void { this.level = wanted; store(STORED.level, String(wanted)); }

  /** What was begun must be begun again by the person: nothing takes the hand back by itself. */
  leavePlay(): void {
    if (this.wish === 'play') this.wish = 'watch';
    this.resting = false;
    this.helpOpen = false;
  }

  takeScene(scene: SceneT): void {
    this.script = readScript(scene);
    this.levels = Math.max(1, scene.levels);
    const wanted = Number(new URLSearchParams(location.search).get('level') ?? stored(STORED.level) ?? 0);
    this.level = this.wish === 'undecided' && wanted >= 1 && wanted <= this.levels ? wanted : Math.max(1, scene.level);
    this.palmLink = scene.capsules.find((capsule) => capsule.part === HandPart.Palm)?.link ?? 0;
    this.drinkSeen = -1;
  }

  takeState(state: WorldStateT): void {
    this.hardware = hasHardware(state);
    if (!this.script) return;
    const drink = figure(this.script, state, 'drink');
    const stage = figure(this.script, state, 'stage');
    const begins = figure(this.script, state, 'step') === 0 && figure(this.script, state, 'poured_l') === 0;
    if (drink === this.drinkSeen || (!begins && this.drinkSeen >= 0) || stage === Stage.DrinkDone || stage === Stage.LevelDone) return;
    this.drinkSeen = drink;
    this.spiltBefore_l = begins ? figure(this.script, state, 'spilt_l') : 0;
  }
}
