// What comes next: proposed at the end of a visit by one touch, understood in the next Today, and taken into the plan by one touch.
import { fill } from '../shared/i18n';
import { texts as consoleTexts } from '../console/i18n';
import { texts } from './i18n';
import type { Item, Presets } from './records';
import { helpWords, itemWords } from './words';

const MOST_PROPOSALS = 4;
const LESS: Readonly<Record<Item['help'], Item['help']>> = { full: 'some', some: 'none', none: 'none' };
type Exercises = Presets['exercises'];

const levelsOf = (exercises: Exercises, id: string): number => exercises.find((exercise) => exercise.id === id)?.levels ?? 1;

/** A wish: the words that are written into the note, and the item that they stand for. */
export interface Wish { readonly words: string; readonly item: Item }

/** One step harder for each trained item: the next level, or less help. */
export function proposals(trained: readonly Item[], exercises: Exercises): Wish[] {
  return trained.flatMap((item): Wish[] => {
    const level = item.level + 1, help = LESS[item.help];
    return [
      ...(level <= levelsOf(exercises, item.exercise) ? [{ words: itemWords({ ...item, level }), item: { ...item, level } }] : []),
      ...(help !== item.help ? [{ words: [itemWords({ ...item, level: 0 }), fill(texts().helpOf, { help: helpWords(help) })].join(', '), item: { ...item, help } }] : []),
    ];
  }).slice(0, MOST_PROPOSALS);
}

/** Adds a proposed wish to a text, or removes it. */
export function toggled(text: string, wish: string): string {
  const parts = text.split(';').map((part) => part.trim()).filter(Boolean);
  return (parts.includes(wish) ? parts.filter((part) => part !== wish) : [...parts, wish]).join('; ');
}

const escaped = (words: string): string => words.replace(/[.*+?^${}()|[\]\\]/g, '\\$&');

/** The plan with what a text wishes: exercises by their names, levels, help. Undefined where it changes nothing, or is not understood. */
export function wishedPlan(text: string, plan: readonly Item[], exercises: Exercises): Item[] | undefined {
  let items = [...plan];
  // The longest name first: one name may begin another.
  const named = exercises.map(({ id }) => ({ id, name: itemWords({ exercise: id, level: 0 }) })).sort((a, b) => b.name.length - a.name.length);
  for (const part of text.split(/[;.\n]/)) {
    const id = named.find(({ name }) => part.toLowerCase().includes(name.toLowerCase()))?.id;
    const level = Number(new RegExp(escaped(consoleTexts().level).replace('\\{n\\}', '(\\d+)'), 'i').exec(part)?.[1] ?? 0);
    const help = (['full', 'some', 'none'] as const).find((key) => part.toLowerCase().includes(fill(texts().helpOf, { help: helpWords(key) }).toLowerCase()));
    // A level without a name is that of the first item that has such a level.
    const at = id === undefined ? items.findIndex(({ exercise }) => level > 1 && levelsOf(exercises, exercise) >= level) : items.findIndex(({ exercise }) => exercise === id);
    const good = level > 0 && level <= levelsOf(exercises, id ?? items[at]?.exercise ?? '');
    const change = { ...(good ? { level } : {}), ...(help ? { help } : {}) };
    if (at >= 0 && (id !== undefined || good)) items = items.map((item, i) => (i === at ? { ...item, ...change } : item));
    else if (id !== undefined) items = [...items, { exercise: id, level: 1, minutes: 5, help: items[0]?.help ?? 'some', ...change }];
  }
  return JSON.stringify(items) === JSON.stringify(plan) ? undefined : items;
}
