import { OWN_SIGNS } from '../exercises/info';
import type { AxisT } from '../protocol';
import { choice, h } from './dom';
import { texts, type ConsoleTexts } from './i18n';
import type { ConsoleModel, Panel } from './model';
import { PlotPanel } from './plot_panel';
import { coordinateSpec, plotSpecs } from './plot_specs';
import { readTheme } from './theme';

/** The meaning of the signs on the plots. */
export function legend({ legend: t }: ConsoleTexts): HTMLElement {
  const { title, ...lines } = t;
  return h('details', { class: 'legend', 'data-testid': 'legend' }, h('summary', { title, 'aria-label': title }, '?'), h('ul', {}, ...[...Object.values(lines), ...Object.values(OWN_SIGNS).map((own) => own.legend())].map((line) => h('li', {}, line))));
}

/** Buttons for the axis whose coordinate is shown. */
export function axisChoice(axes: readonly AxisT[], chosen: number, t: ConsoleTexts, onChoice: (axis: number) => void): HTMLElement {
  const options = axes.map((axis, i) => {
    const name = String(axis.name);
    return { key: String(i), name: t.axesKey[name] ?? name.slice(0, 2), title: t.axesLong[name] ?? name };
  });
  return choice(t.plots.axisChoice, options, String(chosen), (key) => onChoice(Number(key))).element;
}

/** Plots below each other. */
export class PlotColumn {
  protected plots: PlotPanel[] = [];

  draw(): void {
    for (const plot of this.plots) plot.draw();
  }

  /** Updates the numbers beside the names. */
  refresh(): void {
    const inTables = document.body.classList.contains('tables');
    for (const plot of this.plots) plot.refresh(inTables);
  }

  close(): void {
    for (const plot of this.plots) plot.close();
    this.plots = [];
  }
}

/** The column of live plots. */
export class PlotsPanel extends PlotColumn implements Panel {
  readonly element = h('div', { class: 'col', id: 'plots' });
  private axis: number;

  constructor(private readonly model: ConsoleModel, private wanted: string) {
    super();
    const axes = model.scene?.axes ?? [];
    this.axis = Math.max(0, axes.findIndex((axis) => axis.name === wanted));
    this.build();
  }

  /** The axis whose coordinate is shown. */
  get axisName(): string {
    return this.wanted;
  }

  private build(): void {
    const { scene } = this.model;
    if (!scene) return;
    const t = texts();
    const theme = readTheme();
    this.plots = plotSpecs(scene, this.model.history, this.axis, t)
      .map((spec) => new PlotPanel(this.model, spec, theme, t, spec.id === 'axis' ? this.axisChoice(t) : spec.id === 'ratios' ? legend(t) : undefined));
    this.element.replaceChildren(...this.plots.map((plot) => plot.element));
  }

  private axisChoice(t: ConsoleTexts): HTMLElement {
    return axisChoice(this.model.scene?.axes ?? [], this.axis, t, (axis) => this.showAxis(axis, t));
  }

  // Rebuilds only this plot; the keyboard focus stays on the chosen button.
  private showAxis(axis: number, t: ConsoleTexts): void {
    const { scene } = this.model;
    const at = this.plots.findIndex((plot) => plot.element.dataset.plot === 'axis');
    if (!scene || at < 0) return;
    this.axis = axis;
    this.wanted = String(scene.axes[axis].name);
    const old = this.plots[at];
    this.plots[at] = new PlotPanel(this.model, coordinateSpec(scene, this.model.history, axis, t), readTheme(), t, this.axisChoice(t));
    old.element.replaceWith(this.plots[at].element);
    old.close();
    this.plots[at].element.querySelector<HTMLElement>(`[data-key="${axis}"]`)?.focus();
  }
}
