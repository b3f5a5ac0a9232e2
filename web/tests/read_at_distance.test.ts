// Text that must be read in play is readable at 2 m: capitals of at least 16 minutes of arc on a 24 inch screen.
import { readFileSync } from 'node:fs';
import { describe, expect, it } from 'vitest';
import { unitOf } from '../src/scene/camera';

const css = readFileSync(new URL('../src/game/game.css', import.meta.url), 'utf8');
const hud = readFileSync(new URL('../src/game/hud.ts', import.meta.url), 'utf8') + readFileSync(new URL('../src/game/panel_card.ts', import.meta.url), 'utf8');

/** 24 inch, 16:9. The letter height is that of a capital without accents, as defined by ISO 9241-303. */
const SCREEN = { width_mm: 531, width_px: 1920, height_px: 1080 } as const;
const DISTANCE_MM = 2000;
const LEAST_ARCMIN = 16;
/** Height of H relative to the font size: Atkinson Hyperlegible Next (Chromium measures 672 of 1000 at weight 700). */
const CAPITAL_EM = 0.67;

/** 1u of game.css on that screen [px]: min(100vh / 800, 100vw / 1280). */
const UNIT_PX = Math.min(SCREEN.height_px / 800, SCREEN.width_px / 1280);

/** The rules of a single selector, outside of any other block. */
function rule(selector: string): string {
  const start = css.indexOf(`${selector} {`);
  expect(start, selector).toBeGreaterThanOrEqual(0);
  return css.slice(css.indexOf('{', start) + 1, css.indexOf('}', start));
}

/** A size that the root defines by name [u]. */
function size(name: string, root: string): number {
  const found = rule(root).match(new RegExp(`--size-${name}: ([\\d.]+)`)) ?? rule(':root').match(new RegExp(`--size-${name}: ([\\d.]+)`));
  return Number(found?.[1]);
}

function arcmin(kind: string, root: string): number {
  expect(rule(`.t-${kind}`)).toContain(`font-size: calc(var(--size-${kind}) * var(--t))`);
  const capital_mm = size(kind, root) * UNIT_PX * CAPITAL_EM * SCREEN.width_mm / SCREEN.width_px;
  return Math.atan(capital_mm / DISTANCE_MM) * 180 / Math.PI * 60;
}

describe('at 2 m', () => {
  it('16 minutes of arc are 9.3 mm, 33.7 px of a 24 inch screen', () => {
    const needed_mm = DISTANCE_MM * Math.tan(LEAST_ARCMIN / 60 * Math.PI / 180);
    expect(needed_mm).toBeCloseTo(9.31, 2);
    expect(needed_mm * SCREEN.width_px / SCREEN.width_mm).toBeCloseTo(33.7, 1);
  });

  it.each(['l', 'read'])('text of kind %s is large enough, in both sizes', (kind) => {
    expect(arcmin(kind, ':root')).toBeGreaterThanOrEqual(LEAST_ARCMIN);
    expect(arcmin(kind, ':root[data-text=far]')).toBeGreaterThanOrEqual(LEAST_ARCMIN);
  });

  it.each(['m', 's'])('with large text the other texts of kind %s are large enough, too', (kind) => {
    expect(arcmin(kind, ':root[data-text=far]')).toBeGreaterThanOrEqual(LEAST_ARCMIN);
  });

  it.each([
    ['what to do now', /title = h\('b', \{ class: 't-(\w+)', 'data-testid': 'instruction'/],
    ['the hint beside it', /more = h\('span', \{ class: 't-(\w+)'/],
    ['the meter\'s word', /word = h\('b', \{ class: 't-(\w+)'/],
    ['the amount in the glass', /amount = h\('b', \{ class: 't-(\w+)'/],
    ['a panel\'s figure', /number = h\('b', \{ class: 't-(\w+)'/],
    ['Stop', /class: 'button stop t-(\w+)'/],
    ['Rest', /class: 'button rest t-(\w+)'/],
    ['a stop that is not confirmed', /h\('b', \{ class: 't-(\w+)' \}, text\('stop.unconfirmed'\)/],
  ])('%s uses such a size', (_name, pattern) => {
    expect(['l', 'read']).toContain(hud.match(pattern)?.[1]);
  });
});

describe('Stop', () => {
  it('is farther than its own height from Squeeze on a touch screen, which is above the strip', () => {
    const input = readFileSync(new URL('../src/input/input.css', import.meta.url), 'utf8');
    expect(Number(input.match(/\.touch-buttons \{[^}]*bottom: calc\(var\(--strip, 104px\) \+ (\d+)px\)/)?.[1])).toBeGreaterThan(68);
  });

  it.each([390, 820])('is farther than its own height from Squeeze on an upright screen of %i px width, too', (width_px) => {
    const input = readFileSync(new URL('../src/input/input.css', import.meta.url), 'utf8');
    const gap_px = Number(input.match(/11 \/ 10\) \{\s*\.touch-buttons \{[^}]*bottom: calc\(var\(--strip, 140px\) \+ (\d+)px\)/)?.[1]);
    const [, perU, plus_px] = css.match(/--u: calc\(100vw \/ 740\); --strip: max\(190 \* var\(--u\), (\d+) \* var\(--t\) \+ (\d+)px\)/) ?? [];
    const u = width_px / 740, t = Math.max(u, 0.6), strip_px = Math.max(190 * u, Number(perU) * t + Number(plus_px));
    // Two lines of text (46u and 38u, line height 1.1), a gap of 10u, then Stop: in the middle of the strip's height.
    const words_px = 1.1 * (46 + 38) * t, stop_px = Math.max(68 * u, 68);
    const above_px = (strip_px - words_px - 10 * u - stop_px) / 2 + words_px + 10 * u;
    expect(above_px + gap_px).toBeGreaterThan(stop_px);
  });

  it('is at least 68 px high and wide on every screen', () => {
    const own = css.match(/:is\(\.button\.stop,[^{]*\{([^}]*)\}/)?.[1] ?? '';
    expect(own).toMatch(/min-height: max\([^;]*, 68px\)/);
    expect(own).toMatch(/min-width: max\([^;]*, 68px\)/);
  });
});

describe('zoomed, or on a telephone', () => {
  it('text is never smaller than 16 px, so that it grows with the zoom', () => {
    const [, u] = css.match(/--u: max\(min\(100vh \/ 800, 100vw \/ 1280\), ([\d.]+)px\)/) ?? [], [, t] = css.match(/--t: max\(var\(--u\), ([\d.]+)px\)/) ?? [];
    for (const least_px of [Math.max(Number(u), Number(t)), Number(t)]) expect(size('s', ':root') * least_px).toBeGreaterThanOrEqual(16);
    // The same size as camera.ts computes it.
    expect([unitOf(844, 390), unitOf(1280, 800), unitOf(370, 800)]).toEqual([Number(u), 1, 0.5]);
  });

  it('every button is at least 44 px high and wide', () => {
    for (const selector of ['.button', '.choice']) expect(rule(`\n${selector}`)).toMatch(/min-height: max\([^;]*, 44px\); min-width: max\([^;]*, 44px\)/);
    expect(rule('\n.tone')).toMatch(/width: max\([^;]*, 44px\); height: max\([^;]*, 44px\)/);
    expect(rule('\n.languages button')).toMatch(/min-height: max\([^;]*, 44px\); min-width: 44px/);
  });

  it('a page that never reconnects has no Stop, which could not work', () => {
    expect(css).toContain('body[data-state=version] .strip .stop { display: none; }');
  });
});
