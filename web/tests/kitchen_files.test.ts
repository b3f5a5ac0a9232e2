// The files of the shipped kitchen tasks: console, report and replay show the values of their panels.
import { readdirSync, readFileSync } from 'node:fs';
import { join, resolve } from 'node:path';
import { describe, expect, it } from 'vitest';

const FOLDER = resolve(__dirname, '../../config/exercises');
const TASKS = readdirSync(FOLDER).map((name) => ({ name, toml: readFileSync(join(FOLDER, name), 'utf8') })).filter(({ toml }) => /^exercise = "kitchen"/m.test(toml));
const tablesOf = (toml: string, name: string): string[] => toml.split(/^\[/m).filter((table) => table.startsWith(`[${name}]]`));

it('there are as many as the manual states', () => { expect(TASKS.length).toBeGreaterThanOrEqual(6); });

describe.each(TASKS)('$name', ({ toml }) => {
  it('has texts for every step and for the end, in three languages', () => {
    const words = tablesOf(toml, 'panel.instructions');
    expect(words).toHaveLength(tablesOf(toml, 'steps').length + 1);
    for (const table of words) for (const language of ['en', 'fr', 'de']) expect(table).toMatch(new RegExp(`^${language} = ".+"`, 'm'));
    expect(toml).not.toMatch(/ß/);
  });

  it('shows the force at the handle and the time, and reports time and score', () => {
    const values = tablesOf(toml, 'panel.values').map((table) => ({ name: /^name = "(\w+)"/m.exec(table)?.[1], result: /^result = true/m.test(table) }));
    expect(values.map(({ name }) => name)).toEqual(expect.arrayContaining(['handle_n', 'time_s', 'score']));
    expect(values.filter(({ result }) => result).map(({ name }) => name)).toEqual(expect.arrayContaining(['time_s', 'score']));
  });
});
