// A clinic's plans offer every exercise that ships, with all of its levels.
import { readdirSync, readFileSync } from 'node:fs';
import { join, resolve } from 'node:path';
import { describe, expect, it } from 'vitest';
import { exerciseWords } from '../src/console/title_words';
import { LANGUAGES, setLanguage } from '../src/shared/i18n';

const CONFIG = resolve(__dirname, '../../config');
const FOLDER = join(CONFIG, 'exercises');
/** The scene of games of other makers: it asks for nothing. */
const NO_EXERCISE = ['game-scene'];
const presets = readFileSync(join(CONFIG, 'clinic/presets.toml'), 'utf8');
const planned = new Map([...presets.matchAll(/^\[\[exercises\]\]\nid = "([\w-]+)"\nlevels = (\d+)/gm)].map(([, id, levels]) => [id!, Number(levels)]));
const shipped = readdirSync(FOLDER).filter((name) => name.endsWith('.toml')).map((name) => ({
  id: name.replace('.toml', ''), levels: Math.max(1, [...readFileSync(join(FOLDER, name), 'utf8').matchAll(/^\[\[levels\]\]/gm)].length),
})).filter(({ id }) => !NO_EXERCISE.includes(id));

// setLanguage() needs a page.
Object.assign(globalThis, { document: { documentElement: {} } });

describe.each(shipped)('$id', ({ id, levels }) => {
  it('can be planned with each of its levels', () => { expect(planned.get(id)).toBe(levels); });
  it('has a name in every language', () => {
    for (const language of LANGUAGES) {
      setLanguage(language);
      expect(exerciseWords(id, 0, 'unnamed')).not.toBe('unnamed');
    }
  });
});

it('nothing else can be planned', () => { expect([...planned.keys()].sort()).toEqual(shipped.map(({ id }) => id).sort()); });
