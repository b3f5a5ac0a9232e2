// A page of charts: what it reads of the program's data, and the words and numbers that it shows.
import { describe, expect, it } from 'vitest';
import { readChartPage } from '../src/charts/chart_page_data';
import { logarithmicNumbers } from '../src/charts/chart_range';
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
  it('is refused where it is another page, or another version', () => {
    expect([{ ...PAGE, page: 'report' }, { ...PAGE, version: 2 }, {}, PAGE].map(kindOf)).toEqual(['nonsense', 'nonsense', 'nonsense', 'none']);
  });

  it('of any shape is read: gaps and ends that are not given are NaN, colours are names of properties', () => {
    const { charts: [chart], tables: [table] } = readChartPage({
      ...PAGE, charts: [{ title: 7, x: { from: null, to: 2 }, lines: [{ color: 'red;}', x: [1, 2], y: [1, null] }, 'x'], marks: null }],
      tables: [{ rows: [['a', { sentence: 'axis', with: { axes: 'x' } }, { interval: [0.5, null], most: 2 }], 3] }],
    });
    expect(chart).toMatchObject({ title: '', height_px: 150, x: { from: NaN, to: 2 }, marks: [], names_x: true });
    expect(chart.lines.map(({ color, y }) => [color, y])).toEqual([['--ink', [1, NaN]], ['--ink', []]]);
    expect(table.rows).toEqual([['a', { sentence: 'axis', with: { axes: 'x' } }, { from: 0.5, to: NaN, most: 2 }], []]);
  });
});

describe('the words of a page of charts', () => {
  it('have the same places in every language', () => {
    const places = (text: string): string[] => [...text.matchAll(/\{(\w+)\}/g)].map(([, name]) => name).sort();
    for (const [name, text] of Object.entries(en.sentences)) {
      for (const other of [de, fr]) expect(places((other.sentences as Record<string, string>)[name]), name).toEqual(places(text));
    }
  });

  it('name axes as people do, and leave names of files as they are', () => {
    const say = (sentence: string, places: Record<string, string>): string => wordsOf({ sentence, with: places });
    expect(say('axis', { axes: 'finger_flexion' })).toBe('Fingers');
    expect(say('axis', { axes: 'x, y, z' })).toBe('x, y, z');
    expect(say('certificate.walls', { exercise: '<b>{rate}</b>' })).toBe('With the walls of <b>{rate}</b>.');
    expect(wordsOf('{axes}')).toBe('{axes}');
  });
});

describe('numbers of a logarithmic axis', () => {
  it('are 1, 2 and 5 within its ends, and powers of ten alone over many decades', () => {
    expect(logarithmicNumbers(0.7, 60)).toEqual([1, 2, 5, 10, 20, 50]);
    expect(logarithmicNumbers(0.002, 0.02)).toEqual([0.002, 0.005, 0.01, 0.02]);
    expect(logarithmicNumbers(1e-4, 100)).toEqual([1e-4, 1e-3, 0.01, 0.1, 1, 10, 100]);
  });
});
