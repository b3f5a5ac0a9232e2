// What must be told apart is so without colour vision: by words, patterns, signs and dashes, and by lightness.
// Simulation: Machado, Oliveira and Fernandes 2009, severity 1, in linear RGB. Contrast: WCAG 2.2.
import { readFileSync } from 'node:fs';
import { describe, expect, it } from 'vitest';
import { de } from '../src/shared/i18n/de';
import { en } from '../src/shared/i18n/en';
import { fr } from '../src/shared/i18n/fr';
import { de as consoleDe } from '../src/console/i18n/de';
import { en as consoleEn } from '../src/console/i18n/en';
import { fr as consoleFr } from '../src/console/i18n/fr';
import { plotSpecs } from '../src/console/plot_specs';
import { liquidLook } from '../src/exercises/cocktail_bar/liquids';

type Rgb = readonly [number, number, number];

const SIGHT: Readonly<Record<string, readonly Rgb[]>> = {
  usual: [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
  protanopia: [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
  deuteranopia: [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]],
  tritanopia: [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.303900]],
};

const linear = (hex: string): Rgb => [1, 3, 5].map((at) => {
  const part = parseInt(hex.slice(at, at + 2), 16) / 255;
  return part <= 0.04045 ? part / 12.92 : ((part + 0.055) / 1.055) ** 2.4;
}) as unknown as Rgb;
const seen = (hex: string, sight: string): Rgb => SIGHT[sight].map((row) => Math.min(1, Math.max(0, row.reduce((sum, weight, i) => sum + weight * linear(hex)[i], 0)))) as unknown as Rgb;
const luminance = ([r, g, b]: Rgb): number => 0.2126 * r + 0.7152 * g + 0.0722 * b;

function contrast(a: string, b: string, sight: string): number {
  const [x, y] = [a, b].map((hex) => luminance(seen(hex, sight)) + 0.05);
  return Math.max(x, y) / Math.min(x, y);
}

const read = (path: string) => readFileSync(new URL(path, import.meta.url), 'utf8');
const game = read('../src/game/game.css'), tokens = read('../src/shared/tokens.css'), consoleCss = read('../src/console/console.css');

/** The first colour that the pattern's group captures; #FFF is expanded. */
function colour(css: string, pattern: RegExp): string {
  const hex = css.match(pattern)?.[1] ?? '';
  expect(hex, String(pattern)).toMatch(/^#([0-9A-F]{3}|[0-9A-F]{6})$/i);
  return hex.length === 4 ? `#${[...hex.slice(1)].map((digit) => digit + digit).join('')}` : hex;
}

const BAR = colour(tokens, /--bar: (#\w+)/);
const TRACK = colour(game, /\.meter \.track \{[^}]*background: (#\w+)/);
const ZONE = colour(game, /\.meter \.zone \{[^}]*background: (#\w+)/);
const ZONE_EDGE = colour(game, /\.meter \.zone \{[^}]*box-shadow: 0 0 0 2px (#\w+)/);
const MARK = colour(game, /\.meter \.mark \{[^}]*background: (#\w+)/);

it('the simulation keeps grey, and maps red and green of one lightness to similar colours', () => {
  for (const sight of Object.keys(SIGHT)) for (const part of seen('#808080', sight)) expect(part).toBeCloseTo(linear('#808080')[0], 5);
  const apart = (sight: string) => Math.hypot(...seen('#C04040', sight).map((part, i) => part - seen('#5E7A2E', sight)[i]));
  expect(apart('deuteranopia')).toBeLessThan(0.4 * apart('usual'));
});

describe.each(Object.keys(SIGHT))('with %s sight', (sight) => {
  it('the band of the squeeze meter, its edge and the mark have contrast', () => {
    expect(contrast(MARK, ZONE, sight)).toBeGreaterThanOrEqual(3);
    expect(contrast(MARK, TRACK, sight)).toBeGreaterThanOrEqual(3);
    expect(contrast(ZONE_EDGE, TRACK, sight)).toBeGreaterThanOrEqual(3);
    expect(contrast(TRACK, BAR, sight)).toBeLessThan(contrast(ZONE_EDGE, BAR, sight));
  });

  it('the words of the meter are readable', () => {
    const words = [/\.meter b \{ color: (#\w+)/, /\.meter b\[data-zone=right\] \{ color: (#\w+)/, /\.meter b:is\(\[data-zone=strong\][^{]*\{ color: (#\w+)/, /\.meter b\[data-zone=stop\] \{ color: (#\w+)/];
    for (const pattern of words) expect(contrast(colour(game, pattern), BAR, sight), String(pattern)).toBeGreaterThanOrEqual(4.5);
  });

  it.each([['light', ':root {'], ['dark', '[data-theme=dark] {']])('the limits of the console have contrast, %s', (_theme, start) => {
    const block = consoleCss.slice(consoleCss.indexOf(start), consoleCss.indexOf('}', consoleCss.indexOf(start)));
    const of = (name: string) => colour(block, new RegExp(`--${name}: (#\\w+)`));
    for (const bar of ['ink-2', 'warn', 'bad']) expect(contrast(of(bar), of('line'), sight), bar).toBeGreaterThanOrEqual(3);
    for (const [words, ground] of [['accent', 'accent-soft'], ['warn', 'warn-soft'], ['bad', 'bad-soft']]) expect(contrast(of(words), of(ground), sight), words).toBeGreaterThanOrEqual(4.5);
  });
});

describe('information that does not depend on colour', () => {
  it('every two liquids differ in pattern and symbol', () => {
    const looks = ['lemon', 'cherry', 'blueberry', 'coconut'].map(liquidLook);
    for (const part of ['pattern', 'symbol'] as const) expect(new Set(looks.map((look) => look[part])).size).toBe(looks.length);
  });

  it('every two lines of a plot differ in their dashes', () => {
    const names = ['x', 'y', 'z', 'roll', 'pitch', 'yaw', 'finger_flexion', 'thumb_circumduction', 'thumb_flexion'];
    const axes = names.map((name) => ({ name, unit: ['x', 'y', 'z'].includes(name) ? 'm' : 'rad' })) as never;
    const columns = { column: () => 0, alphaColumn: 0 } as never;
    for (const { id, series } of plotSpecs({ axes }, columns, 0, consoleEn)) expect(new Set(series.map(({ dash }) => dash.join())).size, id).toBe(series.length);
  });

  it.each([['en', en], ['fr', fr], ['de', de]])('every zone of the meter has its own word, %s', (_language, texts) => {
    for (const zones of [['none', 'soft', 'right', 'strong', 'stop', 'wrong'], ['low', 'right', 'high']] as const) {
      const words = zones.map((zone) => (texts as Record<string, string>)[`game.zone.${zone}`]);
      expect(new Set(words).size).toBe(zones.length);
    }
  });

  it.each([['en', consoleEn], ['fr', consoleFr], ['de', consoleDe]])('every state of the console has its own word, %s', (_language, texts) => {
    const words = Object.values(texts.states);
    expect(new Set(words).size).toBe(words.length);
  });

  it('a force at its limit has a sign, and the current step of the recipe a bar beside it', () => {
    expect(consoleCss).toMatch(/\.lim:has\(\.tr\.over\) \.num::before \{ content: "▲ "/);
    expect(game).toMatch(/\.row\.now \{[^}]*inset calc\(8 \* var\(--u\)\) 0 var\(--ink\)/);
  });
});
