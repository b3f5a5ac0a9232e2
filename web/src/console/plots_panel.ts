import { choice, h, say, svg } from './dom';
import { fixed } from './format';
import { texts, type ConsoleTexts } from './i18n';
import { LivePlot } from './live_plot';
import type { ConsoleModel, Panel } from './model';
import { coordinateSpec, limitOf, plotSpecs, type PlotSpec, type SeriesSpec } from './plot_specs';
import { readTheme, type Theme } from './theme';
import { fill } from '../shared/i18n';

/** Numbers in a text table: latest, least, most. */
interface Row {
  series: SeriesSpec;
  legend: HTMLElement;
  cells: HTMLElement[];
}

/** A plot with its title, legend with live numbers, and the same as a table. */
class PlotPanel {
  readonly element: HTMLElement;
  private readonly plot: LivePlot;
  private readonly rows: Row[];

  constructor(private readonly model: ConsoleModel, private readonly spec: PlotSpec, theme: Theme, t: ConsoleTexts, extra?: HTMLElement) {
    const host = h('div', { class: 'canvas', role: 'img', 'aria-label': fill(t.plots.image, { name: spec.title }) });
    this.rows = spec.series.map((series) => ({
      series, legend: h('b', {}, '–'), cells: [h('td'), h('td'), h('td')],
    }));
    const unit = spec.unit === '' ? null : h('span', { class: 'u' }, ` ${spec.unit}`);
    this.element = h('section', { class: 'panel plot', 'aria-label': spec.title, 'data-plot': spec.id },
      h('div', { class: 'hd' }, h('h2', {}, spec.title, unit), extra ?? null,
        h('div', { class: 'leg' }, ...this.rows.map((row) => h('span', {}, swatch(row.series), row.series.name, row.legend)))),
      host, this.table(t));
    this.plot = new LivePlot(host, spec, theme, t.plots);
  }

  draw(): void {
    const { model, spec } = this;
    const limit = model.scene ? limitOf(spec.id, model.scene, (name) => model.parameter(name)) : undefined;
    this.plot.draw(model.history, model.marks.list, limit);
  }

  refresh(inTables: boolean): void {
    const { samples } = this.model.history;
    if (samples.length === 0) return;
    for (const { series, legend, cells } of this.rows) {
      const latest = fixed(samples.latest(series.column), series.decimals);
      say(legend, latest);
      if (!inTables) continue;
      const values = samples.column(series.column, this.model.history.count());
      say(cells[0], latest);
      say(cells[1], fixed(values.reduce((a, b) => Math.min(a, b), Infinity), series.decimals));
      say(cells[2], fixed(values.reduce((a, b) => Math.max(a, b), -Infinity), series.decimals));
    }
  }

  close(): void {
    this.plot.close();
  }

  private table(t: ConsoleTexts): HTMLElement {
    const heads = [t.plots.series, t.plots.latest, t.plots.least, t.plots.most].map((name) => h('th', { scope: 'col' }, name));
    const body = this.rows.map(({ series, cells }) => h('tr', {}, h('th', { scope: 'row' }, series.name), ...cells));
    return h('div', { class: 'numbers', tabindex: 0, role: 'group', 'aria-label': this.spec.title }, h('table', {},
      h('caption', {}, fill(t.plots.tableCaption, { name: `${this.spec.title} ${this.spec.unit}`.trim() })),
      h('thead', {}, h('tr', {}, ...heads)), h('tbody', {}, ...body)));
  }
}

function swatch(series: SeriesSpec): SVGElement {
  const path = svg('path', { d: 'M0 3h20', 'stroke-width': 3, 'stroke-dasharray': series.dash.map((v) => Math.min(v, 9)).join(' ') || undefined });
  path.style.stroke = `var(${series.color})`;
  return svg('svg', { width: 20, height: 6, 'aria-hidden': 'true' }, path);
}

/** What the signs on the plots mean. */
function legend({ legend: t }: ConsoleTexts): HTMLElement {
  const { title, ...lines } = t;
  return h('details', { class: 'legend', 'data-testid': 'legend' }, h('summary', { title, 'aria-label': title }, '?'), h('ul', {}, ...Object.values(lines).map((line) => h('li', {}, line))));
}

/** The column of live plots. */
export class PlotsPanel implements Panel {
  readonly element = h('div', { class: 'col', id: 'plots' });
  private plots: PlotPanel[] = [];
  private axis: number;

  constructor(private readonly model: ConsoleModel, private wanted: string) {
    const axes = model.scene?.axes ?? [];
    this.axis = Math.max(0, axes.findIndex((axis) => axis.name === wanted));
    this.build();
  }

  /** The axis whose coordinate is shown. */
  get axisName(): string {
    return this.wanted;
  }

  draw(): void {
    for (const plot of this.plots) plot.draw();
  }

  refresh(): void {
    const inTables = document.body.classList.contains('tables');
    for (const plot of this.plots) plot.refresh(inTables);
  }

  close(): void {
    for (const plot of this.plots) plot.close();
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
    const options = (this.model.scene?.axes ?? []).map((axis, i) => {
      const name = String(axis.name);
      return { key: String(i), name: t.axesKey[name] ?? name.slice(0, 2), title: t.axesLong[name] ?? name };
    });
    return choice(t.plots.axisChoice, options, String(this.axis), (key) => this.showAxis(Number(key), t)).element;
  }

  // Only this plot is built anew; the keyboard stays on the chosen button.
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
