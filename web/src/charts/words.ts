import { texts as consoleTexts } from '../console/i18n';
import { texts as reportTexts } from '../report/i18n';
import { fill } from '../shared/i18n';
import type { PageText } from './chart_page_data';
import { texts } from './i18n';

const axisWord = (name: string): string => consoleTexts().axesLong[name] ?? name;

/** A placeholder's value; names of axes, exercises and stages are translated. */
function inPlace(place: string, value: string): string {
  if (place === 'axes') return value.split(', ').map((name, _i, all) => (all.length > 1 ? consoleTexts().axes[name] ?? name : axisWord(name))).join(', ');
  if (place === 'stage') return reportTexts().stages.names[value] ?? value;
  return value;
}

/** A text in the current language. */
export function wordsOf(text: PageText): string {
  if (typeof text === 'string') return text;
  const known = (texts().sentences as Readonly<Record<string, string>>)[text.sentence] ?? text.sentence;
  return fill(known, Object.fromEntries(Object.entries(text.with).map(([place, value]) => [place, inPlace(place, value)])));
}
