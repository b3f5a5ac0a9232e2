// Plans from goals, and what was written for the next visit.
// @vitest-environment happy-dom
import { readFileSync } from 'node:fs';
import { resolve } from 'node:path';
import { beforeEach, describe, expect, it } from 'vitest';
import { TodayPanel } from '../src/clinic/begin';
import { Clinic } from '../src/clinic/clinic';
import { goalsOfPlan, MOST_MIN, planOfGoals } from '../src/clinic/goals';
import { moreMinutes, ofCourse } from '../src/clinic/end_screen';
import { de } from '../src/clinic/i18n/de';
import { en } from '../src/clinic/i18n/en';
import { fr } from '../src/clinic/i18n/fr';
import type { ClinicContext } from '../src/clinic/clinic_context';
import type { Item, Patient, PlanPreset, Visit } from '../src/clinic/records';
import { proposals, toggled, wishedPlan } from '../src/clinic/wishes';
import { LANGUAGES, setLanguage } from '../src/shared/i18n';
import { FakeClinic } from './clinic_fake';

beforeEach(() => { setLanguage('en'); });

const TOML = readFileSync(resolve(__dirname, '../../config/clinic/presets.toml'), 'utf8');
const GOALS: PlanPreset[] = TOML.split('[[goals]]').slice(1).map((text) => ({
  id: /id = "([\w-]+)"/.exec(text)![1],
  items: [...text.matchAll(/exercise = "([\w-]+)"\nlevel = (\d+)\nminutes = ([\d.]+)\nhelp = "(\w+)"/g)].map(([, exercise, level, minutes, help]) => ({ exercise: exercise!, level: Number(level), minutes: Number(minutes), help: help as Item['help'] })),
}));
/** Every set of goals but the empty one. */
const CHOICES = Array.from({ length: (1 << GOALS.length) - 1 }, (_, set) => GOALS.filter((_, i) => (set + 1 >> i & 1) === 1).map(({ id }) => id));
const EXERCISES = [...TOML.matchAll(/^\[\[exercises\]\]\nid = "([\w-]+)"\nlevels = (\d+)/gm)].map(([, id, levels]) => ({ id: id!, levels: Number(levels) }));
const item = (exercise: string, level = 1, help: Item['help'] = 'some'): Item => ({ exercise, level, minutes: 10, help });

describe('goals', () => {
  it('have a name in every language', () => {
    expect(GOALS.length).toBeGreaterThanOrEqual(4);
    for (const texts of [en, de, fr]) for (const { id } of GOALS) expect(texts.goals.names[id], id).toBeTruthy();
  });

  it('fill a plan of at most half an hour with each exercise once, whichever are chosen', () => {
    for (const chosen of CHOICES) {
      const plan = planOfGoals(GOALS, chosen);
      const wanted = new Set(GOALS.filter(({ id }) => chosen.includes(id)).flatMap(({ items }) => items.map(({ exercise }) => exercise)));
      expect(new Set(plan.map(({ exercise }) => exercise))).toEqual(wanted);
      expect(plan).toHaveLength(wanted.size);
      expect(plan.reduce((sum, { minutes }) => sum + minutes, 0), chosen.join()).toBeLessThanOrEqual(MOST_MIN);
      expect(Math.min(...plan.map(({ minutes }) => minutes))).toBeGreaterThanOrEqual(1);
    }
  });

  it('are recognized in the plan that they filled, and in no other', () => {
    for (const chosen of CHOICES) expect(goalsOfPlan(GOALS, planOfGoals(GOALS, chosen))).toEqual(chosen);
    expect(goalsOfPlan(GOALS, [item('cocktail-bar')])).toEqual([]);
  });
});

describe('the patient\'s card', () => {
  const visit = (id: number, began_us: number, active_s: number, state: Visit['state'] = 'done'): Visit => ({ id, began_us, state, trials: [{ active_s, state: 'measured' }] }) as unknown as Visit;

  it('counts the visits of the course', () => {
    const course = { weeks: 1, visits_a_week: 3 }, now = visit(4, 40, 60), before = [visit(1, 10, 60), visit(2, 20, 60, 'no_show'), visit(3, 30, 60, 'unfinished')];
    expect(ofCourse(now, [...before, now], course)).toEqual({ n: 3, of: 3 });
    expect(ofCourse(visit(5, 50, 60), [...before, now], course)).toBeUndefined();
    expect(ofCourse(now, before, undefined)).toBeUndefined();
  });

  it('says that the minutes grew only where they did', () => {
    const before = visit(1, 10, 100);
    expect([220, 159, 30].map((active_s) => moreMinutes(visit(2, 20, active_s), [before]))).toEqual([2, 0, 0]);
    expect(moreMinutes(visit(2, 20, 600), [])).toBe(0);
  });
});

describe('what comes next', () => {
  it.each(LANGUAGES)('proposes the next level and less help, and understands both, in %s', (language) => {
    setLanguage(language);
    const plan = [item('squeeze-to-level'), item('cocktail-bar', 1, 'full'), item('cocktail-bar-free')];
    for (const { words, item: wish } of proposals(plan, EXERCISES)) {
      const at = plan.findIndex(({ exercise }) => exercise === wish.exercise);
      expect(wishedPlan(words, plan, EXERCISES), words).toEqual(plan.map((other, i) => (i === at ? wish : other)));
    }
  });

  it('understands words that a therapist types', () => {
    const plan = [item('squeeze-to-level'), item('cocktail-bar')];
    expect(wishedPlan('Level 2 next time', plan, EXERCISES)).toEqual([plan[0], item('cocktail-bar', 2)]);
    expect(wishedPlan('more of the same, and the drawer', plan, EXERCISES)).toEqual([...plan, { exercise: 'drawer', level: 1, minutes: 5, help: 'some' }]);
    expect(wishedPlan('Cocktail bar, level 9', plan, EXERCISES)).toBeUndefined();
    expect(wishedPlan('left hand, too', plan, EXERCISES)).toBeUndefined();
    expect(wishedPlan('Cocktail bar, Level 1', plan, EXERCISES)).toBeUndefined();
  });

  it('is written and removed by one touch beside other words', () => {
    expect(toggled('left hand, too', 'Drawer, Level 2')).toBe('left hand, too; Drawer, Level 2');
    expect(toggled('left hand, too; Drawer, Level 2', 'Drawer, Level 2')).toBe('left hand, too');
  });

  it('stands in Today with a button that takes it into the plan', async () => {
    const { today, find, plan } = await todayOf('Squeeze to a level, Level 2');
    const take = find('take-wish')!;
    expect(take.textContent).toBe('Take into the plan: Squeeze to a level, Level 2');
    expect(today.element.textContent).toContain('visit 2 of 18');
    take.click();
    expect(today.element.querySelector('.plan')!.textContent).toContain('Squeeze to a level, Level 2');
    expect(find('take-wish')).toBeNull();
    expect(plan()![0]!.level).toBe(2);
  });
});

it('the editor of today\'s plan keeps the focus on the pressed control, and marks the goals of the plan', async () => {
  const { today, find, plan } = await todayOf('');
  document.body.replaceChildren(today.element);
  find('change-plan')!.click();
  const press = (test: string): void => { find(test)!.focus(); find(test)!.click(); };
  press('plan-more-0');
  press('plan-more-0');
  expect(plan()!.map(({ minutes }) => minutes)).toEqual([7, 10]);
  expect(document.activeElement).toBe(find('plan-more-0'));
  expect(find('goal-reach')!.getAttribute('aria-pressed')).toBe('false');
  press('plan-remove-0');
  expect(find('goal-reach')!.getAttribute('aria-pressed')).toBe('true');
  expect(document.activeElement).toBe(find('plan-remove-0'));
  press('goal-reach');
  expect(plan()).toEqual([]);
  expect(find<HTMLButtonElement>('begin-visit')!.disabled).toBe(true);
});

/** Today of a patient with one visit, at which this was wished. */
async function todayOf(wish: string) {
  const fake = new FakeClinic(() => 1.8e15);
  fake.clinic = 'open';
  fake.tiles = [{ id: 1, name: 'A', colour: '#0B6B58', pin: '1234' }];
  const clinic = new Clinic('127.0.0.1', () => undefined, () => undefined, () => 0, fake.fetch);
  await clinic.signedIn(fake.signIn(1));
  await clinic.look(fake.fetch);
  const person = fake.add({ name: 'B' }), visit = fake.open(person.id, 'right', person.plan, 'done', 1.7e15);
  const note = { id: 5, visit: visit.id, at_us: 1.7e15, account: 1, kind: 'next', text: wish };
  const patient = { ...person, visits: [{ ...visit, notes: [note] }], notes: [], today: person.plan, curves: [] } as unknown as Patient;
  const today = new TodayPanel({ clinic } as unknown as ClinicContext, patient);
  const find = <Control extends HTMLElement = HTMLElement>(test: string) => today.element.querySelector<Control>(`[data-testid=${test}]`);
  return { today, find, plan: () => clinic.drafts.get<Item[]>('today', person.id) };
}
