import { choice, h } from '../console/dom';
import { fill } from '../shared/i18n';
import { texts } from './i18n';
import type { Item, Presets } from './records';
import { button } from './ui';
import { helpWords, itemWords, minutes } from './words';

const MOST_MINUTES = 60;

/** The plan as a list: number, exercise, minutes, help. */
export function planList(items: readonly Item[], now = -1): HTMLElement {
  return h('ol', { class: 'plan' }, ...items.map((item, i) => h('li', { ...(i === now ? { 'aria-current': 'step' } : {}) },
    h('span', { class: 'nr', 'aria-hidden': 'true' }, String(i + 1)), h('span', {}, h('b', {}, itemWords(item)), h('small', {}, fill(texts().helpOf, { help: helpWords(item.help) }))), h('span', { class: 'num' }, minutes(item.minutes)))));
}

/** An editor of a plan: exercise, level, minutes, help, order. It shows the plan that it was given until it is drawn again. */
export function planEditor(items: readonly Item[], exercises: Presets['exercises'], onChange: (items: readonly Item[]) => void): HTMLElement {
  const t = texts().plan;
  const row = (item: Item, i: number): HTMLElement => {
    const named = { n: i + 1 };
    const change = (part: Partial<Item>): void => onChange(items.map((other, k) => (k === i ? { ...other, ...part } : other)));
    const levels = exercises.find(({ id }) => id === item.exercise)?.levels ?? Math.max(1, item.level);
    const exercise = select(`plan-exercise-${i}`, fill(t.exercise, named), exercises.map(({ id }) => [id, itemWords({ exercise: id, level: 0 })]), item.exercise, (id) => change({ exercise: id, level: 1, parameters: {} }));
    const level = select(`plan-level-${i}`, fill(t.level, named), Array.from({ length: Math.max(1, levels) }, (_, k) => [String(k + 1), String(k + 1)]), String(item.level), (n) => change({ level: Number(n) }));
    const help = choice(fill(t.help, named), (['full', 'some', 'none'] as const).map((key) => ({ key, name: helpWords(key) })), item.help, (key) => change({ help: key as Item['help'] }));
    const press = (sign: string, test: string, words: string, act: () => void, disabled = false): HTMLButtonElement => button(sign, `plan-${test}-${i}`, act, '', { 'aria-label': fill(words, named), disabled });
    const step = (by: number): void => change({ minutes: Math.max(1, Math.min(MOST_MINUTES, item.minutes + by)) });
    return h('li', {}, h('span', { class: 'nr', 'aria-hidden': 'true' }, String(i + 1)), h('div', { class: 'what' }, exercise, h('label', {}, `${t.levelShort} `, level)),
      h('div', { class: 'how' }, help.element, h('span', { class: 'steps-of' }, press('−', 'less', t.less, () => step(-1)), h('output', { class: 'num' }, minutes(item.minutes)), press('+', 'more', t.more, () => step(1))),
        h('span', { class: 'move' }, press('↑', 'up', t.up, () => onChange(items.map((other, k) => (k === i ? items[i - 1] : k === i - 1 ? item : other))), i === 0), press('×', 'remove', t.remove, () => onChange(items.filter((_, k) => k !== i))))));
  };
  const last = items.at(-1) ?? { exercise: exercises[0]?.id ?? '', level: 1, minutes: 10, help: 'full' };
  return h('div', { class: 'plan-editor' }, h('ol', { class: 'plan' }, ...items.map(row)), button(t.add, 'plan-add', () => onChange([...items, last])));
}

export function select(test: string, words: string, options: readonly (readonly [value: string, name: string])[], chosen: string, onChoice: (value: string) => void): HTMLSelectElement {
  const known = options.some(([value]) => value === chosen) ? options : [[chosen, chosen] as const, ...options];
  const element = h('select', { 'aria-label': words, 'data-testid': test }, ...known.map(([value, name]) => h('option', { value, selected: value === chosen }, name)));
  element.addEventListener('change', () => onChoice(element.value));
  return element;
}
