import { texts as consoleTexts } from '../console/i18n';
import { lookOfName } from '../console/plot_specs';
import { h, table } from '../shared/dom';
import { significant } from '../shared/format';
import { chart, legend, type ChartLine } from './chart';
import type { ChartPageData, Interval, PageChart, PageLine, PageTable } from './chart_page_data';
import { wordsOf } from './words';

function lineOf({ name, color, dash_px, width_px, axis, dot_px, stepped, filled, x, y }: PageLine): ChartLine {
  const [axis_color, axis_dash] = lookOfName(axis);
  return {
    name: wordsOf(name) || (axis === '' ? '' : consoleTexts().axes[axis] ?? axis), color: `var(${axis === '' ? color : axis_color})`, dash: axis === '' ? dash_px : axis_dash,
    width: width_px, dots: dot_px, stepped, filled, x, values: y,
  };
}

/** The ends of a scale: given ones, else those of the values. */
function endsOf({ from, to }: { readonly from: number; readonly to: number }, values: Iterable<number>): [number, number] {
  let [low, high] = [Infinity, -Infinity];
  for (const value of values) {
    if (value < low) low = value;
    if (value > high) high = value;
  }
  return [Number.isFinite(from) ? from : low, Number.isFinite(to) ? to : high];
}

function figureOf({ title, height_px, x, y, names_x, lines, bands, marks }: PageChart): HTMLElement {
  const drawn = lines.map(lineOf);
  const range_x = endsOf(x, lines.flatMap((line) => line.x));
  const given = Number.isFinite(y.from) && Number.isFinite(y.to);
  return chart({
    title: wordsOf(title), unit: '', height_px, range_x, lines: drawn, bands: bands.map((band) => ({ ...band, color: 'var(--band)' })),
    marks: marks.map(({ at, label, bad }) => ({ at, label: wordsOf(label), bad })), nameOfX: names_x ? significant : undefined, unit_x: x.unit,
    logarithmic_x: x.logarithmic, logarithmic_y: y.logarithmic, range_y: given ? [y.from, y.to] : undefined, numbers_y: y.numbers_at.length > 0 ? y.numbers_at : undefined,
  });
}

function intervalBar({ from, to, most }: Interval): HTMLElement {
  const share = (value: number): number => 100 * Math.min(1, Math.max(0, value / most));
  return h('span', { class: 'interval', role: 'img', 'aria-label': `${significant(from)} – ${significant(to)}`, style: `--one: ${100 / most}%` },
    h('i', { style: `left: ${share(from)}%; width: ${Math.max(0.6, share(to) - share(from))}%` }));
}

function tableOf({ title, heads, rows }: PageTable): HTMLElement {
  return h('section', { class: 'figures' }, h('h2', {}, wordsOf(title)), table(heads.map(wordsOf), rows.map((cells) => cells.map((cell) => (typeof cell === 'object' && 'most' in cell ? intervalBar(cell) : h('bdi', {}, wordsOf(cell)))))));
}

/** Charts that belong together share a cell of the grid. */
function places(charts: readonly PageChart[]): HTMLElement[] {
  const out: HTMLElement[] = [];
  for (const each of charts) {
    if (each.below_previous && out.length > 0) out[out.length - 1].append(figureOf(each));
    else out.push(h('div', { class: 'place' }, figureOf(each)));
  }
  return out;
}

export function chartSheet(data: ChartPageData): HTMLElement {
  return h('article', { class: 'paper', 'data-testid': 'charts' },
    h('header', {}, h('p', {}, 'Wholehand'), h('h1', {}, h('bdi', {}, wordsOf(data.title))), ...data.notes.map((note) => h('p', { class: 'note' }, h('bdi', {}, wordsOf(note))))),
    data.legend.length > 0 ? legend(data.legend.map(lineOf)) : null,
    h('div', { class: `grid columns-${data.columns}` }, ...places(data.charts)), ...data.tables.map(tableOf));
}
