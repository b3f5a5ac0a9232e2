import { Act, Help, Role, RunState, Steering } from '../protocol';
import { infoOf } from '../exercises/info';
import { helpChoice } from './big_controls';
import { choice, h, setText, setAttribute, setClass } from './dom';
import { asWords } from '../shared/format';
import { texts } from './i18n';
import type { ConsoleModel, Panel } from './model';
import { ProfileRow } from './profile_row';
import { exerciseWords } from './title_words';

/**
 * The levels that may be chosen for an exercise. The number of levels of another exercise is known once it is loaded;
 * every exercise has a first level.
 */
export function levelsOf(chosen: string, loaded: Readonly<{ exercise: string; levels: number }>): number[] {
  const count = chosen === loaded.exercise ? Math.max(1, loaded.levels) : 1;
  return Array.from({ length: count }, (_, k) => k + 1);
}

/** Chooses exercise, level and hand, and who plays; shows who holds the controls. */
export class SetupPanel implements Panel {
  readonly element: HTMLElement;
  private readonly t = texts();
  private readonly exercise = h('select', { id: 'exercise', 'data-testid': 'exercise' });
  private readonly level = h('select', { id: 'level', 'data-testid': 'level' });
  private readonly hand = h('select', { id: 'hand', 'data-testid': 'hand' });
  private readonly holder = h('span', { class: 'holder', 'data-testid': 'holder' });
  private readonly take: HTMLButtonElement;
  private readonly stop: HTMLButtonElement;
  private readonly who: ReturnType<typeof choice>;
  private readonly help: ReturnType<typeof choice>;
  private readonly profile: ProfileRow;

  /** @param withHelp the help is set in this panel */
  constructor(private readonly model: ConsoleModel, withHelp: boolean) {
    const { t } = this;
    this.profile = new ProfileRow(model);
    this.take = button(t.setup.take, 'take-controls', () => void this.takeOrGive());
    this.stop = button(t.stop, 'stop', () => void model.command(t.stop, () => model.connection.stop()));
    const load = button(t.setup.load, 'load', () => void this.load());
    const restart = button(t.setup.restart, 'restart', () => void model.command(t.setup.restart, () => model.connection.act(Act.Restart)));
    const next = button(t.setup.next, 'next', () => void model.command(t.setup.next, () => model.connection.act(Act.Next)));
    this.who = choice(t.setup.steering, [
      { key: String(Steering.VirtualPatient), name: t.setup.virtual }, { key: String(Steering.Person), name: t.setup.person },
    ], String(Steering.VirtualPatient), (key) => void model.command(t.setup.steering, () => model.connection.steer(Number(key)), { steers: true }));
    this.help = helpChoice(model);
    this.element = h('section', { class: 'panel setup', 'aria-label': t.setup.title },
      h('div', { class: 'hd' }, h('h2', {}, t.setup.title), this.holder, this.take),
      this.profile.element, h('div', { class: 'fields' },
        field(t.setup.exercise, this.exercise), field(t.setup.level, this.level), field(t.setup.hand, this.hand), load),
      withHelp ? h('div', { class: 'row given-help' }, h('span', { class: 'name', 'aria-hidden': 'true' }, t.setup.help), this.help.element) : null,
      h('div', { class: 'row who-plays' }, this.who.element), h('div', { class: 'row' }, restart, next, this.stop));
    this.fillChoices();
    this.exercise.addEventListener('change', () => this.fillLevels());
    this.refresh();
  }

  refresh(): void {
    const { t, model } = this;
    const { heldByYou, held, holder } = model.connection.controls;
    const theirs = holder === Role.Player ? t.setup.players : holder === Role.Therapist ? t.setup.therapists : t.setup.others;
    setText(this.holder, heldByYou ? t.setup.yours : held ? theirs : t.setup.free);
    setText(this.take, heldByYou ? t.setup.giveBack : t.setup.takeShort);
    setAttribute(this.take, 'title', heldByYou ? t.setup.giveBack : t.setup.take);
    setClass(this.take, 'go', !heldByYou);
    this.who.choose(String(model.state?.steering ?? Steering.VirtualPatient));
    this.help.choose(String(model.state?.help ?? Help.Unspecified));
    this.profile.refresh();
    this.stop.disabled = model.state?.runState !== RunState.Rendering;
  }

  private fillChoices(): void {
    const { scene } = this.model;
    if (!scene) return;
    const { t } = this;
    const now = String(scene.exerciseName ?? '');
    const exercises = scene.exercises.length > 0 ? scene.exercises : [now];
    this.exercise.append(...exercises.map((name) => h('option', { value: name, selected: name === now }, exerciseWords(name))));
    const hands = scene.hands.length > 0 ? scene.hands : [String(scene.handName)];
    this.hand.append(...hands.map((name) => h('option', { value: name, selected: name === scene.handName }, t.hands[name] ?? asWords(name))));
    this.fillLevels();
  }

  private fillLevels(): void {
    const { scene } = this.model;
    if (!scene) return;
    const loaded = String(scene.exerciseName ?? '');
    const isLoaded = this.exercise.value === loaded;
    const levels = levelsOf(this.exercise.value, { exercise: loaded, levels: scene.levels });
    const info = infoOf(isLoaded ? scene : null);
    this.level.replaceChildren(...levels.map((n) => h('option', { value: n, selected: isLoaded && n === scene.level }, `${n} ${info.levelName(n)}`.trim())));
    this.level.disabled = levels.length < 2;
  }

  private async load(): Promise<void> {
    const { model, t } = this;
    // Level 0 keeps the present one. Another exercise starts at its first level, since it may not have the present one.
    const isLoaded = this.exercise.value === String(model.scene?.exerciseName ?? '');
    const level = isLoaded && this.level.disabled ? 0 : Number(this.level.value);
    await model.command(t.setup.load, () => model.connection.loadExercise(this.exercise.value, level, this.hand.value));
  }

  private async takeOrGive(): Promise<void> {
    const { model, t } = this;
    if (model.connection.controls.heldByYou) await model.connection.releaseControls();
    else {
      const answer = await model.connection.takeControls();
      if (!answer.accepted) model.onRefused(t.setup.take, answer.reason);
    }
    this.refresh();
  }
}

function button(name: string, id: string, onClick: () => void): HTMLButtonElement {
  const element = h('button', { type: 'button', class: 'b small', 'data-testid': id }, name);
  element.addEventListener('click', onClick);
  return element;
}

function field(name: string, select: HTMLSelectElement): HTMLElement {
  return h('label', {}, h('span', {}, name), select);
}
