import { infoOf } from '../exercises/info';
import type { ExerciseInfo } from '../exercises/exercise_info';
import { ExercisePanel } from '../exercises/panel';
import { Act, RunState, Steering } from '../protocol';
import { fill, language, LANGUAGES, setLanguage, type Language } from '../shared/i18n';
import { FreshButtons } from '../shared/fresh_buttons';
import { deviceLines } from './device_status';
import { h, setText, setAttribute, setClass } from './dom';
import { texts } from './i18n';
import { icon, type IconName } from './icons';
import type { ConsoleModel, Panel } from './model';
import { toggleTheme } from './theme';
import { exerciseWords, personWords } from './title_words';

const LANGUAGE_NAMES: Readonly<Record<Language, string>> = { de: 'Deutsch', fr: 'Français', en: 'English' };
const PILL_ICON: Readonly<Record<string, IconName>> = {
  rendering: 'ok', disarmed: 'wait', connecting: 'wait', paused: 'wait', stopping: 'wait', stopped: 'wait', faulted: 'bad', lost: 'bad', silent: 'bad',
};

/** Header content that another page provides, and its condition for Start. */
export interface HeaderOwn {
  /** Two lines each, instead of the scene's patient and exercise. */
  readonly who: () => readonly [string, string];
  readonly what: () => readonly [string, string];
  /** Whether Start may be pressed, in addition to the program's state; undefined: this screen has no Start. */
  readonly startable: () => boolean | undefined;
}

/** Shows patient, exercise and state; start, pause and emergency stop are buttons that keep their places. */
export class Header implements Panel {
  readonly element: HTMLElement;
  private readonly t = texts();
  private readonly info: ExerciseInfo;
  private readonly who = pair();
  private readonly what = pair();
  private readonly pillName = h('b');
  private readonly pillCause = h('small');
  private readonly pillIcon = h('span', { class: 'pill-icon' });
  private readonly pill: HTMLElement;
  private readonly arm: HTMLButtonElement;
  private readonly pause: HTMLButtonElement;
  private readonly resume: HTMLButtonElement;
  private readonly freshResume: FreshButtons;
  /** The newest stop and basis that the page showed beside "Start", and those at the moment of the press. */
  private shown = { endings: 0, basis: 0 };
  private pressed: { readonly endings: number; readonly basis: number } | undefined;

  constructor(private readonly model: ConsoleModel, private readonly rebuild: () => void, engineer: boolean, private readonly own?: HeaderOwn) {
    const { t } = this;
    this.info = infoOf(model.scene);
    this.pill = h('div', { class: 'pill', role: 'status', 'data-testid': 'state' },
      this.pillIcon, h('span', {}, this.pillName, this.pillCause));
    this.arm = h('button', { type: 'button', class: 'b go', 'data-testid': 'arm' }, icon('play'), t.arm);
    for (const press of ['pointerdown', 'keydown']) this.arm.addEventListener(press, () => { this.pressed = this.shown; });
    this.arm.addEventListener('click', () => this.start());
    // Space pauses, wherever the focus is, and never starts.
    this.arm.addEventListener('keyup', (event) => { if (event.code === 'Space') event.preventDefault(); });
    this.pause = h('button', { type: 'button', class: 'b', 'data-testid': 'pause' }, icon('pause'), t.pause, h('kbd', { class: 'pause-key' }, t.space));
    this.pause.addEventListener('click', () => this.pauseNow());
    this.resume = h('button', { type: 'button', class: 'b', 'data-testid': 'resume', hidden: true }, icon('play'), t.resume);
    this.freshResume = new FreshButtons(this.resume);
    this.resume.addEventListener('click', () => void model.command(t.resume, () => model.connection.act(Act.Resume)));
    // Emergency stop works without a connection, too: it is sent as soon as there is one (PendingStop).
    const stop = h('button', { type: 'button', class: 'b stop', 'data-testid': 'emergency-stop' },
      icon('stop'), t.emergency, h('kbd', {}, t.esc));
    stop.addEventListener('click', () => void model.emergencyStop());
    this.element = h('header', { class: 'top live' },
      h('h1', { class: 'brand' }, icon('logo'), 'Wholehand'), this.who.element, this.what.element, this.pill,
      h('span', { class: 'sp' }), this.languageChoice(), ...(engineer ? [this.tablesButton()] : []), this.themeButton(), this.arm, this.pause, this.resume, stop);
    this.refresh();
  }

  /** Pauses, by the button or by Space; it never starts. */
  pauseNow(): void {
    const { model, t } = this;
    if (!this.pause.hidden && !this.pause.disabled) void model.command(t.pause, () => model.connection.act(Act.Pause));
  }

  private start(): void {
    const { model, t } = this;
    const { endings, basis } = this.pressed ?? this.shown;
    this.pressed = undefined;
    void model.command(t.arm, () => model.connection.arm(endings, basis));
  }

  refresh(): void {
    this.refreshWho();
    this.refreshPill();
    this.refreshButtons();
  }

  private refreshWho(): void {
    const { model, t, own } = this;
    const { scene } = model;
    if (own) return this.writeOwn(own);
    if (!scene) return;
    const side = scene.rightHand ? t.hand.right : t.hand.left;
    const profile = String(scene.profile ?? ''), simulated = deviceLines(model.state?.device, t) === undefined;
    setText(this.who.first, personWords(profile, String(scene.patientName ?? ''), simulated) || fill(t.profile.profile, { name: t.profile.noProfile }));
    const plays = profile !== '' && simulated && model.state?.runState === RunState.Rendering && model.state.steering === Steering.VirtualPatient;
    setText(this.who.second, [fill(t.session, { n: model.state?.session ?? scene.session }), side, ...(plays ? [t.virtualPlays] : []),
      ...(model.recorded === undefined ? [] : [model.recorded ? t.recordings.on : t.recordings.off])].join(', '));
    setAttribute(this.who.element, 'title', `${String(scene.deviceName ?? '')}, ${String(scene.handName ?? '')}`);
    const exercise = String(scene.exerciseName ?? '');
    setText(this.what.first, exercise === '' ? t.noExercise : exerciseWords(exercise, 0, ExercisePanel.of(scene)?.title));
    const level = scene.levels > 0 ? fill(t.level, { n: scene.level }) : '';
    const progress = this.info.progress((name) => model.value(name));
    setText(this.what.second, progress === '' ? level : `${level}, ${progress}`);
  }

  private writeOwn(own: HeaderOwn): void {
    for (const [pair, [first, second]] of [[this.who, own.who()], [this.what, own.what()]] as const) {
      setText(pair.first, first);
      setText(pair.second, second);
      pair.element.hidden = first === '' && second === '';
    }
  }

  private refreshPill(): void {
    const { model, t } = this;
    const { name, bad, short } = model.status;
    const limited = name === 'rendering' && model.limited;
    if (this.pill.dataset.name !== name) {
      this.pill.dataset.name = name;
      this.pillIcon.replaceChildren(icon(PILL_ICON[name]));
    }
    setClass(this.pill, 'bad', bad);
    setClass(this.pill, 'warn', limited || name === 'stopping' || name === 'stopped' || name === 'paused');
    setText(this.pillName, t.states[name]);
    setText(this.pillCause, limited ? t.pill.limited : short ?? t.pill[name]);
  }

  private refreshButtons(): void {
    const { model, t } = this;
    const { name } = model.status;
    this.shown = { endings: model.connection.endings, basis: model.connection.basis };
    const here = this.own ? this.own.startable() : true;
    this.arm.disabled = !model.startable || !here;
    this.arm.hidden = here === undefined;
    if (this.arm.disabled && document.activeElement === this.arm) this.arm.blur();
    const word = name === 'stopped' || name === 'faulted' ? t.armAgain : t.arm;
    if (this.arm.lastChild?.textContent !== word) this.arm.replaceChildren(icon('play'), word);
    this.pause.disabled = name !== 'rendering';
    const paused = name === 'paused';
    // A screen without Start shows Pause only while there is something to pause.
    const idle = here === undefined && this.pause.disabled;
    if (idle && !paused) {
      this.pause.hidden = this.resume.hidden = true;
      return;
    }
    if (this.pause.hidden === paused && this.resume.hidden !== paused) return;
    const focused = document.activeElement === (paused ? this.pause : this.resume);
    this.pause.hidden = paused;
    this.resume.hidden = !paused;
    if (paused) this.freshResume.changed();
    if (focused) (paused ? this.resume : this.pause).focus();
  }

  private languageChoice(): HTMLElement {
    const select = h('select', { 'aria-label': this.t.language, 'data-testid': 'language', class: 'lang' },
      ...LANGUAGES.map((key) => h('option', { value: key, selected: key === language(), lang: key, 'aria-label': `${key.toUpperCase()} ${LANGUAGE_NAMES[key]}` }, key.toUpperCase())));
    select.addEventListener('change', () => setLanguage(select.value as Language));
    return select;
  }

  private themeButton(): HTMLElement {
    const button = h('button', { type: 'button', class: 'b icon', 'aria-label': this.t.theme, title: this.t.theme, 'data-testid': 'theme' }, icon('theme'));
    button.addEventListener('click', () => {
      toggleTheme();
      this.rebuild();
      document.querySelector<HTMLElement>('[data-testid=theme]')?.focus();
    });
    return button;
  }

  private tablesButton(): HTMLElement {
    const pressed = document.body.classList.contains('tables');
    const button = h('button', {
      type: 'button', class: 'b icon', 'aria-label': this.t.tables, title: this.t.tables, 'aria-pressed': String(pressed), 'data-testid': 'tables',
    }, icon('table'));
    button.addEventListener('click', () => {
      const on = document.body.classList.toggle('tables');
      button.setAttribute('aria-pressed', String(on));
    });
    return button;
  }
}

function pair(): { element: HTMLElement; first: HTMLElement; second: HTMLElement } {
  const first = h('b');
  const second = h('span');
  return { element: h('div', { class: 'who' }, first, second), first, second };
}
