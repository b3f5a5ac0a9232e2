// The data that the program wrote into the page: src/files/page/chart_page.hpp. It is parsed once and never trusted.
import type { Json } from '../embedded/page_data';
import { Problem } from '../replay/problem';

const VERSION = 1;

/** A text, or a sentence key with values for its placeholders. */
export type PageText = string | { readonly sentence: string; readonly with: Readonly<Record<string, string>> };
/** A bar from one value to another on a scale from 0 to `most`. */
export interface Interval { readonly from: number; readonly to: number; readonly most: number }

export interface PageLine {
  readonly name: PageText; readonly color: string; readonly dash_px: readonly number[]; readonly width_px: number; readonly axis: string;
  readonly dot_px: number; readonly stepped: boolean; readonly filled: boolean; readonly x: readonly number[]; readonly y: readonly number[];
}
export interface Scale { readonly unit: string; readonly from: number; readonly to: number; readonly logarithmic: boolean; readonly numbers_at: readonly number[] }
export interface PageChart {
  readonly title: PageText; readonly height_px: number; readonly x: Scale; readonly y: Scale; readonly names_x: boolean; readonly below_previous: boolean;
  readonly lines: readonly PageLine[]; readonly bands: readonly { readonly from: number; readonly to: number }[];
  readonly marks: readonly { readonly at: number; readonly label: PageText; readonly bad: boolean }[];
}
export interface PageTable { readonly title: PageText; readonly heads: readonly PageText[]; readonly rows: readonly (readonly (PageText | Interval)[])[] }
export interface ChartPageData {
  readonly title: PageText; readonly notes: readonly PageText[]; readonly legend: readonly PageLine[]; readonly columns: number;
  readonly charts: readonly PageChart[]; readonly tables: readonly PageTable[];
}

const asJson = (value: unknown): Json => (typeof value === 'object' && value !== null && !Array.isArray(value) ? (value as Json) : {});
const list = (value: unknown): unknown[] => (Array.isArray(value) ? value : []);
const objects = (value: unknown): Json[] => list(value).map(asJson);
/** NaN for a missing value: a gap in a line, or an end that follows from the values. */
const number = (value: unknown): number => (typeof value === 'number' && Number.isFinite(value) ? value : NaN);
const numbers = (value: unknown): number[] => list(value).map(number);
const plain = (value: unknown): string => (typeof value === 'string' ? value : '');

function text(value: unknown): PageText {
  const said = asJson(value);
  if (typeof said.sentence !== 'string') return plain(value);
  return { sentence: said.sentence, with: Object.fromEntries(Object.entries(asJson(said.with)).map(([place, word]) => [place, plain(word)])) };
}

function cell(value: unknown): PageText | Interval {
  const { interval, most } = asJson(value);
  if (!Array.isArray(interval)) return text(value);
  const [from, to] = numbers(interval);
  return { from, to, most: number(most) };
}

const line = (said: Json): PageLine => ({
  name: text(said.name), color: /^--[\w-]+$/.test(plain(said.color)) ? plain(said.color) : '--ink', dash_px: numbers(said.dash_px), width_px: number(said.width_px) || 1.5,
  axis: plain(said.axis), dot_px: number(said.dot_px) || 0, stepped: said.stepped === true, filled: said.filled === true, x: numbers(said.x), y: numbers(said.y),
});

const scale = (said: Json): Scale => ({ unit: plain(said.unit), from: number(said.from), to: number(said.to), logarithmic: said.logarithmic === true, numbers_at: numbers(said.numbers_at) });

const chart = (said: Json): PageChart => ({
  title: text(said.title), height_px: number(said.height_px) || 150, x: scale(asJson(said.x)), y: scale(asJson(said.y)), names_x: said.names_x !== false, below_previous: said.below_previous === true,
  lines: objects(said.lines).map(line), bands: objects(said.bands).map((band) => ({ from: number(band.from), to: number(band.to) })),
  marks: objects(said.marks).map((mark) => ({ at: number(mark.at), label: text(mark.label), bad: mark.bad === true })),
});

/** Parses the data of a page; throws a Problem if nothing in it can be shown. */
export function readChartPage(data: Json): ChartPageData {
  if (data.page !== 'charts') throw new Problem('nonsense', 'the page carries no charts');
  if (data.version !== VERSION) throw new Problem('nonsense', `data of version ${String(data.version)}, page of version ${VERSION}`);
  return {
    title: text(data.title), notes: list(data.notes).map(text), legend: objects(data.legend).map(line), columns: data.columns === 2 ? 2 : 1, charts: objects(data.charts).map(chart),
    tables: objects(data.tables).map((table) => ({ title: text(table.title), heads: list(table.heads).map(text), rows: list(table.rows).map((row) => list(row).map(cell)) })),
  };
}
