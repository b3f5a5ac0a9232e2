import { choice, h, setText } from '../console/dom';
import { fill } from '../shared/i18n';
import { texts } from './i18n';
import type { Item, Presets } from './records';
import { button, redraw } from './ui';
import { helpWords, itemWords, minutes } from './words';

const MOST_MINUTES = 60;

/** The plan as a list: number, exercise, minutes, help. */
export function planList(items: readonly Item[], now = -1): HTMLElement {
  return h('ol', { class: 'plan' }, ...items.map((item, i) => h('li', { ...(i === now ? { 'aria-current': 'step' } : {}) },
    h('span', { class: 'nr', 'aria-hidden': 'true' }, String(i + 1)), h('span', {}, h('b', {}, itemWords(item)), h('small', {}, fill(texts().helpOf, { help: helpWords(item.help) }))), h('span', { class: 'num' }, minutes(item.minutes)))));
}

/** An editor of the plan: exercise, level, minutes, help, order. */
export class PlanEditor {
  readonly element = h('div', { class: 'plan-editor' });
  private items: Item[];

  constructor(items: readonly Item[], private readonly exercises: Presets['exercises'], private readonly onChange: (items: readonly Item[]) => void) {
    this.items = [...items];
    this.show();
  }

  get value(): readonly Item[] { return this.items; }

  private set(items: Item[]): void {
    this.items = items;
    this.show();
    this.onChange(items);
  }

  private show(): void {
    const t = texts().plan;
    const add = button(t.add, 'plan-add', () => this.set([...this.items, this.items.at(-1) ?? this.first()]), '');
    redraw(this.element, h('ol', { class: 'plan' }, ...this.items.map((item, i) => this.row(item, i))), add);
  }

  private first(): Item { return { exercise: this.exercises[0]?.id ?? '', level: 1, minutes: 10, help: 'full' }; }

  private row(item: Item, i: number): HTMLElement {
    const t = texts().plan, named = { n: i + 1 };
    const change = (part: Partial<Item>): void => this.set(this.items.map((other, k) => (k === i ? { ...other, ...part } : other)));
    const levels = this.exercises.find(({ id }) => id === item.exercise)?.levels ?? Math.max(1, item.level);
    const exercise = select(`plan-exercise-${i}`, fill(t.exercise, named), this.exercises.map(({ id }) => [id, itemWords({ exercise: id, level: 0 })]), item.exercise, (id) => change({ exercise: id, level: 1, parameters: {} }));
    const level = select(`plan-level-${i}`, fill(t.level, named), Array.from({ length: Math.max(1, levels) }, (_, k) => [String(k + 1), String(k + 1)]), String(item.level), (n) => change({ level: Number(n) }));
    const help = choice(fill(t.help, named), (['full', 'some', 'none'] as const).map((key) => ({ key, name: helpWords(key) })), item.help, (key) => change({ help: key as Item['help'] }));
    const shown = h('output', { class: 'num' });
    setText(shown, minutes(item.minutes));
    const step = (by: number, sign: string, words: string): HTMLButtonElement => {
      const press = button(sign, `plan-${by < 0 ? 'less' : 'more'}-${i}`, () => change({ minutes: Math.max(1, Math.min(MOST_MINUTES, item.minutes + by)) }));
      press.setAttribute('aria-label', fill(words, named));
      return press;
    };
    const up = button('↑', `plan-up-${i}`, () => this.set(this.items.map((other, k) => (k === i ? this.items[i - 1] : k === i - 1 ? item : other))));
    up.setAttribute('aria-label', fill(t.up, named));
    up.disabled = i === 0;
    const away = button('×', `plan-remove-${i}`, () => this.set(this.items.filter((_, k) => k !== i)));
    away.setAttribute('aria-label', fill(t.remove, named));
    return h('li', {}, h('span', { class: 'nr', 'aria-hidden': 'true' }, String(i + 1)), h('div', { class: 'what' }, exercise, h('label', {}, `${t.levelShort} `, level)),
      h('div', { class: 'how' }, help.element, h('span', { class: 'steps-of' }, step(-1, '−', t.less), shown, step(1, '+', t.more)), h('span', { class: 'move' }, up, away)));
  }
}

export function select(test: string, words: string, options: readonly (readonly [value: string, name: string])[], chosen: string, onChoice: (value: string) => void): HTMLSelectElement {
  const known = options.some(([value]) => value === chosen) ? options : [[chosen, chosen] as const, ...options];
  const element = h('select', { 'aria-label': words, 'data-testid': test }, ...known.map(([value, name]) => h('option', { value, selected: value === chosen }, name)));
  element.addEventListener('change', () => onChoice(element.value));
  return element;
}
