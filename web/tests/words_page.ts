// Shows every instruction in the game's strip, and reports those that are cut off (browser/words_fit.mjs).
import '../src/shared/tokens.css';
import '../src/game/game.css';
import { text as barText } from '../src/exercises/cocktail_bar/i18n';
import { en as bar } from '../src/exercises/cocktail_bar/i18n/en';
import { text as kitchenText } from '../src/exercises/kitchen/i18n';
import { en as kitchen } from '../src/exercises/kitchen/i18n/en';
import { text as levelText } from '../src/exercises/squeeze_to_level/i18n';
import { en as level } from '../src/exercises/squeeze_to_level/i18n/en';
import { Hud } from '../src/game/hud';
import { setLanguage, text, type Language, type TextKey } from '../src/shared/i18n';
import { en } from '../src/shared/i18n/en';

declare global { interface Window { measureWords(language: Language, titles: readonly string[]): Promise<{ lines: number; cut: string[] }> } }

const TITLES = ['reach', 'squeeze', 'breathe', 'putDown', 'letGo', 'drawBack', 'wrong', 'offGlass', 'tooFar'] as const;
const keysOf = <Key extends string>(texts: Readonly<Record<Key, string>>, begins: RegExp): Key[] => (Object.keys(texts) as Key[]).filter((key) => begins.test(key));

const hud = new Hud(document.body, { help: () => {}, rest: () => {}, stop: () => {}, play: () => {}, answer: () => {} });
const frame = (): Promise<unknown> => new Promise((go) => { requestAnimationFrame(go); });

window.measureWords = async (language, ofFiles) => {
  setLanguage(language);
  hud.words();
  hud.show(null, { shown: true, value: 0.5, low: 0.4, high: 0.6, zone: 'right' }, null);
  await document.fonts.ready;
  await frame();
  const x = barText('inSentence.blueberry');
  const titles = [...ofFiles, ...TITLES.map((key) => barText(key, { x })), ...keysOf(en, /^watch\.(?!.*More)/).map((key) => text(key as TextKey))];
  const more = [
    ...keysOf(bar, /^(reach|grasp|squeeze|breathe|putDown|letGo|drawBack|wrong|offGlass)More$/).map((key) => barText(key, { x })),
    ...keysOf(kitchen, /^more\./).map((key) => kitchenText(key)), ...keysOf(level, /^more\./).map((key) => levelText(key)),
    ...keysOf(en, /^(hint\.(?!pressOnce)|game\.(onItsWay|closing|doesIt|letsGo)|watch\..*More)/).map((key) => text(key as TextKey, { x: text('hint.pressOnce') })),
  ];
  const lines = [...document.querySelectorAll<HTMLElement>('.strip .say:not(.alarm) > *')], cut: string[] = [];
  const count = Math.max(titles.length, more.length);
  for (let i = 0; i < count; i++) {
    hud.writeInstruction(titles[i % titles.length]!, more[i % more.length]!);
    for (const line of lines) if (line.scrollWidth > line.clientWidth) cut.push(line.textContent ?? '');
    const strip = document.querySelector('.strip')!.getBoundingClientRect(), say = lines[0]!.parentElement!.getBoundingClientRect();
    if (say.bottom > strip.bottom + 1 || say.top < strip.top - 1) cut.push(`higher than the strip: ${lines.map(({ textContent }) => textContent).join(' / ')}`);
  }
  return { lines: titles.length + more.length, cut: [...new Set(cut)] };
};
