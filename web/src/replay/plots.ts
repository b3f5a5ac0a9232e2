import { h } from '../console/dom';
import { quantityWords } from '../shared/format';
import { texts as consoleTexts, type ConsoleTexts } from '../console/i18n';
import { PlotPanel } from '../console/plot_panel';
import { coordinateSpec, lookOf, plotSpecs, type PlotSpec, type SeriesSpec } from '../console/plot_specs';
import { axisChoice, legend, PlotColumn } from '../console/plots_panel';
import { displayUnits } from '../console/history';
import { readTheme } from '../console/theme';
import type { PlotHands } from '../console/time_plot';
import type { AxisT } from '../protocol';
import { labelOf } from '../exercises/panel';
import { fill } from '../shared/i18n';
import { ColumnList, type Column, type PerAxis } from './channels';
import { texts } from './i18n';
import type { ReplaySide } from './side';

const DASHED = [7, 5];
const DOTTED = [2, 3];

/** The chosen axis and exercise value. */
export interface PlotChoice { axis: string; value: string }

/** The axes of all recordings, those of the first one first, each name once. */
export function allAxes(sides: readonly ReplaySide[]): AxisT[] {
  const seen = new Map<string, AxisT>();
  for (const { scene } of sides) for (const axis of scene.axes) if (!seen.has(String(axis.name))) seen.set(String(axis.name), axis);
  return [...seen.values()];
}

/** Names of the exercise values of all recordings. */
function allValues(sides: readonly ReplaySide[]): string[] {
  return [...new Set(sides.flatMap(({ scene }) => scene.valueNames.map(String)))];
}

/** Specifies the plots of a page, the same ones in the same order for all recordings. */
export class PlotMaker {
  readonly axes: readonly AxisT[];
  readonly values: readonly string[];
  private readonly list = new ColumnList();
  private readonly t = texts();

  constructor(private readonly sides: readonly ReplaySide[], readonly chosen: PlotChoice) {
    this.axes = allAxes(sides);
    this.values = allValues(sides);
    const names = this.axes.map(({ name }) => String(name));
    for (const side of sides) side.setColumns(this.list, names);
    const [first, second] = sides;
    if (second) [first.history.fellow, second.history.fellow] = [second.history, first.history];
    if (!names.includes(chosen.axis)) chosen.axis = names[0] ?? '';
    if (!this.values.includes(chosen.value)) chosen.value = this.values.find((name) => /squeeze_n|force/.test(name)) ?? this.values[0] ?? '';
  }

  /** @param c texts of the console's plots */
  specs(c: ConsoleTexts): PlotSpec[] {
    const { t, axes } = this;
    const columns = this.sides[0].history;
    const axis = axes.findIndex(({ name }) => String(name) === this.chosen.axis);
    const specs = axis < 0 ? [] : plotSpecs({ axes: [...axes] }, columns, axis, c);
    const ofAxis = specs.findIndex(({ id }) => id === 'axis');
    if (ofAxis >= 0) specs.splice(ofAxis, 1, this.coordinate(axis, c), this.parts(axis, c));
    const alone = (id: string, title: string, unit: string, series: SeriesSpec[], leastSpan: number): PlotSpec => ({ id, title, unit, series, leastSpan, withZero: true });
    specs.push(
      alone('contact', t.plots.contact, 'N', [
        this.series({ of: 'contact_force_n' }, t.plots.force, '--ax-x', [], 1), this.series({ of: 'contact_count' }, t.plots.count, '--ax-a', DOTTED, 0)], 4),
      alone('palm', t.plots.palm, 'mm', [this.series({ of: 'palm_target_distance_m' }, t.plots.distance, '--ax-z', [], 0)], 40));
    if (this.chosen.value !== '') {
      specs.push({ ...alone('value', t.plots.value, '', [this.series({ of: 'value', name: this.chosen.value }, '', '--ax-y', [], 3)], 1e-3), withZero: false });
    }
    specs.push(alone('duration', t.plots.duration, 'µs', [this.series({ of: 'duration_s' }, t.plots.took, '--ax-t', [], 0)], 100));
    return specs;
  }

  /** The coordinate plot of the console with the intended position added. */
  private coordinate(axis: number, c: ConsoleTexts): PlotSpec {
    const spec = coordinateSpec({ axes: [...this.axes] }, this.sides[0].history, axis, c);
    const name = String(this.axes[axis].name);
    return { ...spec, series: [...spec.series, this.series({ of: 'intention', name }, this.t.plots.intention, '--ax-z', DOTTED, 0)] };
  }

  /** The sent effort with its parts from the exercise and from damping. */
  private parts(axis: number, c: ConsoleTexts): PlotSpec {
    const { t } = this;
    const name = String(this.axes[axis].name);
    const [color] = lookOf(this.axes[axis]);
    const unit = displayUnits(this.axes[axis]).effortUnit;
    const series = (of: PerAxis, words: string, look: string, dash: readonly number[]): SeriesSpec =>
      this.series({ of, name }, words, look, dash, unit === 'Nm' ? 2 : 1);
    return {
      id: 'parts', title: fill(t.plots.parts, { axis: c.axesLong[name] ?? name }), unit, leastSpan: unit === 'Nm' ? 0.2 : 4, withZero: true,
      series: [series('sent', t.plots.sent, color, []), series('exercise_effort', t.plots.exercise, '--ax-a', DASHED), series('damping', t.plots.damping, '--ax-c', DOTTED)],
    };
  }

  private series(column: Column, name: string, color: string, dash: readonly number[], decimals: number): SeriesSpec {
    return { name, color, dash, decimals, column: this.list.numberOf(column) };
  }
}

/** The plots of one recording. */
export class ReplayPlots extends PlotColumn {
  readonly element = h('div', { class: 'plots' });

  /** @param onChoice called when another axis or value was chosen */
  constructor(private readonly side: ReplaySide, private readonly maker: PlotMaker, private readonly hands: PlotHands, private readonly onChoice: () => void) {
    super();
    this.build();
  }

  build(): void {
    const focused = this.element.contains(document.activeElement) ? document.activeElement : undefined;
    const place = focused?.closest<HTMLElement>('[data-plot]')?.dataset.plot;
    const key = focused instanceof HTMLElement ? focused.dataset.key : undefined;
    this.close();
    const words = consoleTexts();
    const own = texts().plots;
    const c: ConsoleTexts = { ...words, plots: { ...words.plots, tableCaption: own.tableCaption, latest: own.latest, image: own.image } };
    const theme = readTheme();
    this.plots = this.maker.specs(c).map((spec) => new PlotPanel(this.side, spec, theme, c, this.extra(spec.id, c), this.hands));
    this.element.replaceChildren(...this.plots.map(({ element }) => element));
    if (place) this.element.querySelector<HTMLElement>(`[data-plot="${place}"] ${key === undefined ? 'select' : `[data-key="${key}"]`}`)?.focus();
  }

  placeHead(time_s: number): void {
    for (const plot of this.plots) plot.placeHead(time_s);
  }

  private extra(id: string, c: ConsoleTexts): HTMLElement | undefined {
    const { maker } = this;
    if (id === 'axis') {
      const now = maker.axes.findIndex(({ name }) => String(name) === maker.chosen.axis);
      return axisChoice(maker.axes, now, c, (axis) => this.choose({ axis: String(maker.axes[axis].name) }));
    }
    if (id === 'value') return this.valueChoice();
    return id === 'ratios' ? legend(c) : undefined;
  }

  private valueChoice(): HTMLElement {
    const { maker, side } = this;
    const option = (name: string): HTMLElement => h('option', { value: name, selected: name === maker.chosen.value }, valueWords(side, name));
    const [named, others] = namedFirst(maker.values, side);
    const select = h('select', { 'aria-label': texts().plots.valueChoice }, ...named.map(option), others.length === 0 ? null : h('optgroup', { label: texts().plots.valueOthers }, ...others.map(option)));
    select.addEventListener('change', () => this.choose({ value: select.value }));
    return select;
  }

  private choose(choice: Partial<PlotChoice>): void {
    Object.assign(this.maker.chosen, choice);
    this.onChoice();
  }
}

/** The values that the exercise's panel names, in its words; then the others, for engineers. */
export const namedFirst = (values: readonly string[], side: Pick<ReplaySide, 'scene'>): readonly [named: string[], others: string[]] =>
  [values.filter((name) => labelOf(side.scene, name) !== ''), values.filter((name) => labelOf(side.scene, name) === '')];

/** The name of a value in the exercise's panel, else its own name as words. */
function valueWords(side: ReplaySide, name: string): string {
  return labelOf(side.scene, name) || quantityWords(name);
}
