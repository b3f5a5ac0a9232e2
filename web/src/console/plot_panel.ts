import { fill } from '../shared/i18n';
import { columns, h, setText, svg } from './dom';
import { fixed } from '../shared/format';
import type { ConsoleTexts } from './i18n';
import type { Mark } from './marks';
import type { PlotSource } from './plot_source';
import { limitsOf, type Axes, type PlotSpec, type SeriesSpec } from './plot_specs';
import type { Theme } from './theme';
import { TimePlot, type PlotHands } from './time_plot';

/** A row of a text table: latest, least and largest value. */
interface Row {
  series: SeriesSpec;
  legend: HTMLElement;
  cells: HTMLElement[];
}

/** The data of a plot, and the sources of its limits and marks. */
export interface PlotsModel {
  readonly scene: Axes | null;
  readonly history: PlotSource;
  readonly marks: { readonly list: readonly Mark[] };
  /** Present value of a live parameter; undefined where there is none. */
  parameter(name: string): number | undefined;
}

/** A plot with its title, a legend with current numbers, and the same data as a table. */
export class PlotPanel {
  readonly element: HTMLElement;
  private readonly plot: TimePlot;
  private readonly rows: Row[];

  constructor(
    private readonly model: PlotsModel, private readonly spec: PlotSpec, theme: Theme, private readonly t: ConsoleTexts,
    extra?: HTMLElement, hands?: PlotHands,
  ) {
    const host = h('div', { class: 'canvas', role: 'img', 'aria-label': fill(t.plots.image, { name: spec.title }) });
    this.rows = spec.series.map((series) => ({
      series, legend: h('b', {}, '–'), cells: [h('td'), h('td'), h('td')],
    }));
    const unit = spec.unit === '' ? null : h('span', { class: 'u' }, ` ${spec.unit}`);
    this.element = h('section', { class: 'panel plot', 'aria-label': spec.title, 'data-plot': spec.id },
      h('div', { class: 'hd' }, h('h2', {}, spec.title, unit), extra ?? null,
        h('div', { class: 'leg' }, ...this.rows.map((row) => h('span', {}, swatch(row.series), row.series.name, row.legend)))),
      host, this.table());
    this.plot = new TimePlot(host, spec, theme, t.plots, hands);
  }

  draw(): void {
    const { model, spec } = this;
    const limits = model.scene ? limitsOf(spec.id, model.scene, model.history, (name) => model.parameter(name), this.t) : [];
    this.plot.draw(model.history, model.marks.list, limits);
  }

  refresh(inTables: boolean): void {
    const { history } = this.model;
    for (const { series, legend, cells } of this.rows) {
      const current = fixed(history.current(series.column), series.decimals);
      setText(legend, current);
      if (!inTables) continue;
      const [least, most] = history.extremes([series.column]);
      setText(cells[0], current);
      setText(cells[1], fixed(least, series.decimals));
      setText(cells[2], fixed(most, series.decimals));
    }
  }

  placeHead(time_s: number): void {
    this.plot.placeHead(time_s);
  }

  close(): void {
    this.plot.close();
  }

  private table(): HTMLElement {
    const { t } = this;
    const body = this.rows.map(({ series, cells }) => h('tr', {}, h('th', { scope: 'row' }, series.name), ...cells));
    return h('div', { class: 'numbers', tabindex: 0, role: 'group', 'aria-label': this.spec.title }, h('table', {},
      h('caption', {}, fill(t.plots.tableCaption, { name: `${this.spec.title} ${this.spec.unit}`.trim() })),
      columns([t.plots.series, t.plots.latest, t.plots.least, t.plots.most]), h('tbody', {}, ...body)));
  }
}

function swatch(series: SeriesSpec): SVGElement {
  const path = svg('path', { d: 'M0 3h20', 'stroke-width': 3, 'stroke-dasharray': series.dash.map((v) => Math.min(v, 9)).join(' ') || undefined });
  path.style.stroke = `var(${series.color})`;
  return svg('svg', { width: 20, height: 6, 'aria-hidden': 'true' }, path);
}
