// Goals of a training: what shall become easier. Chosen goals fill a plan.
import { h } from '../console/dom';
import { texts } from './i18n';
import type { Item, PlanPreset } from './records';
import { button } from './ui';

/** A visit that goals fill lasts at most this long [min]. */
export const MOST_MIN = 30;
const LEAST_MIN = 3;

/** The items of the chosen goals, each exercise once at its highest level, shortened to half an hour. */
export function planOfGoals(goals: readonly PlanPreset[], chosen: readonly string[]): Item[] {
  const items: Item[] = [];
  for (const item of goals.filter(({ id }) => chosen.includes(id)).flatMap((goal) => goal.items)) {
    const at = items.findIndex(({ exercise }) => exercise === item.exercise), there = items[at];
    if (!there) items.push(item);
    else items[at] = { ...there, level: Math.max(there.level, item.level), minutes: Math.max(there.minutes, item.minutes) };
  }
  const total = items.reduce((sum, { minutes }) => sum + minutes, 0);
  return total <= MOST_MIN ? items : items.map((item) => ({ ...item, minutes: Math.max(LEAST_MIN, Math.floor(item.minutes * MOST_MIN / total)) }));
}

/** The goals whose items make up this plan; none where a plan was changed by hand. */
export function goalsOfPlan(goals: readonly PlanPreset[], plan: readonly Item[]): string[] {
  const same = (chosen: readonly string[]): boolean => JSON.stringify(planOfGoals(goals, chosen).map(bare)) === JSON.stringify(plan.map(bare));
  const all = goals.map(({ id }) => id);
  for (let set = 1; set < 1 << all.length; set += 1) {
    const chosen = all.filter((_, i) => (set >> i & 1) === 1);
    if (same(chosen)) return chosen;
  }
  return [];
}

const bare = ({ exercise, level, minutes, help }: Item): readonly unknown[] => [exercise, level, minutes, help];

/** Buttons of the goals, with those of a plan pressed; pressing one fills the plan anew. */
export function goalChoice(goals: readonly PlanPreset[], plan: readonly Item[], onPlan: (plan: Item[]) => void): HTMLElement {
  const t = texts().goals, chosen = goalsOfPlan(goals, plan);
  return h('div', { class: 'goals', role: 'group', 'aria-label': t.title, hidden: goals.length === 0 }, h('span', { class: 'label' }, t.title), h('div', {}, ...goals.map(({ id }) => {
    const others = chosen.filter((other) => other !== id), pressed = others.length < chosen.length;
    return button(t.names[id] ?? id, `goal-${id}`, () => onPlan(planOfGoals(goals, pressed ? others : [...chosen, id])), '', { 'aria-pressed': String(pressed) });
  })));
}
