import { Help, type ParameterT } from '../protocol';
import { fixed } from '../shared/format';
import { fill } from '../shared/i18n';
import { choice, h, setText, setAttribute } from './dom';
import { texts } from './i18n';
import type { ConsoleModel, Panel } from './model';
import { ParameterTarget, viewOf, type ParameterView } from './parameter_model';
import { niceStep } from './scale';

/** The most used parameters besides the help: of each line the first one that the exercise has. */
const SET_MOST = [['effort_limit_hand_tip_n'], ['squeeze_threshold_ratio', 'level_ratio', 'wall_stiffness_ratio'], ['viscosity_ratio'], ['reach_forward_m', 'line_tolerance_l', 'effort_limit_arm_n']] as const;
/** Maximum number of presses from one end of a range to the other. */
const PRESSES = 20;

/** The next multiple of the step above or below a value, within the range. */
export function stepped(shown: number, way: 1 | -1, { lower, upper }: Pick<ParameterView, 'lower' | 'upper'>, step: number): number {
  const next = way > 0 ? Math.floor(shown / step + 1e-6) + 1 : Math.ceil(shown / step - 1e-6) - 1;
  return Math.min(upper, Math.max(lower, Number((next * step).toPrecision(9))));
}

/** A value with a button for less and one for more. */
class Stepper {
  readonly element: HTMLElement;
  private readonly view: ParameterView;
  private readonly step: number;
  private readonly target: ParameterTarget;
  private readonly value = h('output', { class: 'num' });
  private readonly buttons: readonly HTMLButtonElement[];

  constructor(private readonly model: ConsoleModel, private readonly index: number, parameter: ParameterT) {
    const t = texts();
    const view = this.view = viewOf(parameter, t.parameters.names);
    this.step = niceStep(view.upper - view.lower, PRESSES);
    this.target = new ParameterTarget(model.state?.parameters[index] ?? parameter.initial);
    this.buttons = ([-1, 1] as const).map((way) => {
      const words = way < 0 ? t.big.less : t.big.more;
      return h('button', { type: 'button', class: 'b', 'aria-label': fill(words, { name: view.label }), 'data-testid': `${way < 0 ? 'less' : 'more'}-${view.name}`, onclick: () => void this.press(way) }, way < 0 ? '−' : '+');
    });
    this.element = h('div', { class: 'big', role: 'group', 'aria-label': view.label }, h('span', {}, view.label), this.buttons[0], this.value, this.buttons[1]);
    this.refresh();
  }

  refresh(): void {
    const { model, target, view, step, buttons: [less, more] } = this;
    target.onState(model.state?.parameters[this.index] ?? target.now, model.stated_ms);
    const shown = target.shown * view.factor, decimals = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
    setText(this.value, `${fixed(shown, decimals)} ${view.unit}`);
    setAttribute(less, 'aria-disabled', String(shown <= view.lower + step / 1e3));
    setAttribute(more, 'aria-disabled', String(shown >= view.upper - step / 1e3));
  }

  private async press(way: 1 | -1): Promise<void> {
    const { model, target, view } = this;
    const shown = target.shown * view.factor, wanted = stepped(shown, way, view, this.step);
    if (wanted === shown) return;
    target.ask(wanted / view.factor, model.stated_ms);
    this.refresh();
    const answer = await model.command(view.label, () => model.connection.setParameter(view.name, wanted / view.factor));
    if (!answer.accepted) target.refuse();
    this.refresh();
  }
}

/** Buttons for the help in the game. */
export function helpChoice(model: ConsoleModel): ReturnType<typeof choice> {
  const t = texts();
  const help = choice(t.setup.help, [Help.Unspecified, Help.Full, Help.Some, Help.None].map((key) => ({ key: String(key), name: t.setup.helps[key] })),
    String(Help.Unspecified), (key) => void model.command(t.setup.help, () => model.connection.setHelp(Number(key))));
  help.element.dataset.testid = 'set-help';
  return help;
}

/** The controls that a therapist uses most, each one press away. */
export class BigControls implements Panel {
  readonly element: HTMLElement;
  private readonly help: ReturnType<typeof choice>;
  private readonly steppers: readonly Stepper[];

  constructor(private readonly model: ConsoleModel) {
    const t = texts(), parameters = model.scene?.parameters ?? [];
    this.help = helpChoice(model);
    this.steppers = SET_MOST.flatMap((names) => {
      const index = names.map((name) => parameters.findIndex((parameter) => String(parameter.name) === name)).find((at) => at >= 0);
      return index === undefined ? [] : [new Stepper(model, index, parameters[index])];
    });
    this.element = h('section', { class: 'panel bigs', 'aria-label': t.big.title, 'data-testid': 'big-controls' },
      h('div', { class: 'big whole' }, h('span', { 'aria-hidden': 'true' }, t.setup.help), this.help.element), ...this.steppers.map(({ element }) => element));
    this.refresh();
  }

  refresh(): void {
    this.help.choose(String(this.model.state?.help ?? Help.Unspecified));
    for (const stepper of this.steppers) stepper.refresh();
  }
}
