// A page of charts: parsing of the program's data, and the shown words and numbers.
import { describe, expect, it } from 'vitest';
import { readChartPage } from '../src/charts/chart_page_data';
import { shortNumber } from '../src/charts/chart';
import { logarithmicNumbers, timeNumbers } from '../src/charts/chart_range';
import { de } from '../src/charts/i18n/de';
import { en } from '../src/charts/i18n/en';
import { fr } from '../src/charts/i18n/fr';
import { wordsOf } from '../src/charts/words';
import { asProblem } from '../src/replay/problem';

const PAGE = { page: 'charts', version: 1 };

function kindOf(data: Record<string, unknown>): string {
  try {
    readChartPage(data);
    return 'none';
  } catch (thrown) {
    return asProblem(thrown).kind;
  }
}

describe('the data of a page of charts', () => {
  it('is refused for another page or another version', () => {
    expect([{ ...PAGE, page: 'report' }, { ...PAGE, version: 2 }, {}, PAGE].map(kindOf)).toEqual(['nonsense', 'nonsense', 'nonsense', 'none']);
  });

  it('is read in any shape: missing values and ends are NaN, colours are custom properties', () => {
    const { charts: [chart], tables: [table] } = readChartPage({
      ...PAGE, charts: [{ title: 7, x: { from: null, to: 2 }, lines: [{ color: 'red;}', x: [1, 2], y: [1, null] }, 'x'], marks: null }],
      tables: [{ rows: [['a', { sentence: 'axis', with: { axes: 'x' } }, { interval: [0.5, null], most: 2 }], 3] }],
    });
    expect(chart).toMatchObject({ title: '', height_px: 150, x: { from: NaN, to: 2 }, marks: [], names_x: true });
    expect(chart.lines.map(({ color, y }) => [color, y])).toEqual([['--ink', [1, NaN]], ['--ink', []]]);
    expect(table.rows).toEqual([['a', { sentence: 'axis', with: { axes: 'x' } }, { from: 0.5, to: NaN, most: 2 }], []]);
  });
});

describe('the texts of a page of charts', () => {
  it('have the same placeholders in every language', () => {
    const places = (text: string): string[] => [...text.matchAll(/\{(\w+)\}/g)].map(([, name]) => name).sort();
    for (const [name, text] of Object.entries(en.sentences)) {
      for (const other of [de, fr]) expect(places((other.sentences as Record<string, string>)[name]), name).toEqual(places(text));
    }
  });

  it('translate names of axes, and leave names of files unchanged', () => {
    const sentenceWords = (sentence: string, places: Record<string, string>): string => wordsOf({ sentence, with: places });
    expect(sentenceWords('axis', { axes: 'finger_flexion' })).toBe('Fingers');
    expect(sentenceWords('axis', { axes: 'x, y, z' })).toBe('x, y, z');
    expect(sentenceWords('certificate.walls', { exercise: '<b>{rate}</b>' })).toBe('With the walls of <b>{rate}</b>.');
    expect(wordsOf('{axes}')).toBe('{axes}');
  });
});

describe('labels of a time axis', () => {
  it('use clock steps, without 0:50 or 1:40', () => {
    expect(timeNumbers(0, 326.2, 8)).toEqual([0, 60, 120, 180, 240, 300]);
    expect(timeNumbers(0, 40, 8)).toEqual([0, 10, 20, 30, 40]);
    expect(timeNumbers(3.1, 5.2, 8)).toEqual([3.5, 4, 4.5, 5]);
    expect(timeNumbers(0, 0.3, 8)).toEqual([0, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3]);
    for (const to_s of [0.07, 1, 9, 61, 333, 4000, 86_400, 1e6]) expect(timeNumbers(0, to_s, 8).length).toBeLessThanOrEqual(8);
  });
});

describe('a large label of a logarithmic axis', () => {
  it('is abbreviated', () => {
    expect([1, 1000, 10_000, 100_000].map(shortNumber)).toEqual(['1', '1000', '10k', '100k']);
  });
});

describe('labels of a logarithmic axis', () => {
  it('are 1, 2 and 5 within its ends, and only powers of ten over many decades', () => {
    expect(logarithmicNumbers(0.7, 60)).toEqual([1, 2, 5, 10, 20, 50]);
    expect(logarithmicNumbers(0.002, 0.02)).toEqual([0.002, 0.005, 0.01, 0.02]);
    expect(logarithmicNumbers(1e-4, 100)).toEqual([1e-4, 1e-3, 0.01, 0.1, 1, 10, 100]);
  });
});
