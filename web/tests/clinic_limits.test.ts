// The limits of a person's movement in the clinic's page: from measured own movement to the records.
// @vitest-environment happy-dom
import { beforeEach, expect, it, vi } from 'vitest';
import { Clinic } from '../src/clinic/clinic';
import type { ClinicContext } from '../src/clinic/clinic_context';
import { LimitsScreen } from '../src/clinic/limits_screen';
import { faultOf, fromOwn, limitsFrom, ownMovement, rangesOf, type LimitAxis } from '../src/clinic/person_limits';
import type { Trial, Visit } from '../src/clinic/records';
import { setLanguage } from '../src/shared/i18n';
import { FakeClinic } from './clinic_fake';

const DEG = Math.PI / 180;
const X: LimitAxis = { name: 'x', turns: false, lower: -0.085, upper: 0.085 };
const FINGERS: LimitAxis = { name: 'finger_flexion', turns: true, lower: 0, upper: Math.PI };

const trial = (began_us: number, results: Trial['results'], exercise = 'own-range'): Trial =>
  ({ item: 0, exercise, level: 1, recording: 'a.h5', began_us, active_s: 60, helped_share: 0, results, state: 'measured' });
const visit = (id: number, trials: readonly Trial[], side: 'right' | 'left' = 'right'): Visit =>
  ({ id, patient: 1, side, began_us: id, ended_us: id + 1, offset_min: 0, state: 'done', account: 1, plan: [], item: 0, trials, pain_before: null, pain_after: null });

it('own movement is the newest value of each end, of the same side', () => {
  const old = visit(100, [trial(100, [{ name: 'own/x_upper', value: 5, unit: 'cm' }, { name: 'own/finger_flexion_upper', value: 150, unit: '°' }])]);
  const later = visit(200, [trial(200, [{ name: 'own/finger_flexion_upper', value: 120, unit: '°' }, { name: 'score', value: 1, unit: '' }])]);
  const left = visit(300, [trial(300, [{ name: 'own/x_upper', value: 1, unit: 'cm' }])], 'left');
  const { of, at_us } = ownMovement({ visits: [old, later, left] }, 'right');
  expect(of.get('x')?.upper).toBeCloseTo(0.05);
  expect(of.get('x')?.lower).toBeUndefined();
  expect(of.get('finger_flexion')?.upper).toBeCloseTo(120 * DEG);
  expect(at_us).toBe(200);
});

it('a limit from own movement keeps the device’s end where nothing was measured, and needs room for its walls', () => {
  expect(fromOwn(X, { upper: 0.05 })).toEqual({ lower: -0.085, upper: 0.05 });
  expect(fromOwn(X, { lower: 0.04, upper: 0.05 })).toBeUndefined();
  expect(fromOwn(X, undefined)).toBeUndefined();
  expect(fromOwn(X, { lower: -0.2, upper: 0.2 })).toEqual({ lower: -0.085, upper: 0.085 });
});

it('limits that cross, leave the device or are too narrow are named', () => {
  expect(faultOf(X, { lower: 0.02, upper: 0.01 })).toBe('crossed');
  expect(faultOf(X, { lower: -0.09, upper: 0.01 })).toBe('outside');
  expect(faultOf(X, { lower: 0, upper: 0.015 })).toBe('narrow');
  expect(faultOf(FINGERS, { lower: 0, upper: 9 * DEG })).toBe('narrow');
  expect(faultOf(FINGERS, { lower: 0, upper: 180 * DEG })).toBeUndefined();
  expect(limitsFrom([X, FINGERS], new Map([['finger_flexion', { lower: 0.1, upper: 4 }]]))).toEqual([{ axis: 'finger_flexion', within_rad: [0.1, 3.1415927] }]);
  expect(limitsFrom([{ ...X, lower: Math.fround(X.lower) }], new Map([['x', { lower: -1, upper: 0 }]]))[0].within_m).toEqual([-0.085, 0]);
  expect(rangesOf([{ axis: 'x', within_m: [-0.01, 0.02] }])).toEqual([['x', { lower: -0.01, upper: 0.02 }]]);
});

let fake: FakeClinic, context: ClinicContext, screen: LimitsScreen, went: unknown;
const find = <T extends HTMLElement>(test: string): T => screen.element.querySelector<T>(`[data-testid="${test}"]`)!;

beforeEach(async () => {
  setLanguage('en');
  fake = new FakeClinic(() => 1.8e15);
  fake.clinic = 'open';
  fake.tiles = [{ id: 1, name: 'A. Keller', colour: '#0B6B58', pin: '1234' }];
  const row = fake.add({ name: 'Maria Huber', side: 'right', hands: { right: { length_m: 0.18, breadth_m: 0.08 } } });
  fake.visits = [{ ...visit(100, [trial(1.7e15, [{ name: 'own/x_lower', value: -6, unit: 'cm' }, { name: 'own/x_upper', value: 5, unit: 'cm' }, { name: 'own/finger_flexion_lower', value: 30, unit: '°' }])]), patient: row.id }];
  const clinic = new Clinic('127.0.0.1', () => undefined, () => undefined, () => 0, fake.fetch);
  await clinic.signedIn(fake.signIn(1));
  await clinic.look(fake.fetch);
  const axes = [X, FINGERS].map(({ name, turns, lower, upper }) => ({ name, unit: turns ? 'rad' : 'm', lower, upper }));
  context = { clinic, model: { scene: { axes } }, go: (route: unknown) => { went = route; }, showMessage: () => undefined } as unknown as ClinicContext;
  screen = new LimitsScreen(context, row.id);
  document.body.replaceChildren(screen.element);
  await vi.waitFor(() => expect(find('take-all')).not.toBeNull());
});

it('own movement is taken, narrowed by hand, and saved with the hand', async () => {
  find('take-all').click();
  expect(find<HTMLInputElement>('limit-x-upper').value).toBe('5.0');
  expect(find<HTMLInputElement>('limit-finger_flexion-lower').value).toBe('30');
  expect(find<HTMLInputElement>('limit-finger_flexion-upper').value).toBe('180');
  find<HTMLInputElement>('limit-x-upper').value = '3.5';
  find('limit-x-upper').dispatchEvent(new Event('change'));
  find('free-finger_flexion').click();
  find('save-limits').click();
  await vi.waitFor(() => expect(went).toEqual({ at: 'patient', patient: fake.patients[0].id }));
  const [limit, ...others] = fake.patients[0].hands.right!.limits!;
  expect(others).toEqual([]);
  expect(limit.axis).toBe('x');
  expect(limit.within_m![0]).toBeCloseTo(-0.06);
  expect(limit.within_m![1]).toBeCloseTo(0.035);
  expect(fake.patients[0].hands.right!.length_m).toBe(0.18);
});

it('what was typed for one hand is still there after a look at the other', async () => {
  fake.patients[0] = { ...fake.patients[0], side: 'both', hands: { right: { length_m: 0.18, breadth_m: 0.08 }, left: { length_m: 0.18, breadth_m: 0.08 } } };
  screen = new LimitsScreen(context, fake.patients[0].id);
  document.body.replaceChildren(screen.element);
  await vi.waitFor(() => expect(find('take-all')).not.toBeNull());
  find('own-x').click();
  screen.element.querySelector<HTMLElement>('[data-key=left]')!.click();
  expect(find<HTMLInputElement>('limit-x-upper').value).toBe('');
  screen.element.querySelector<HTMLElement>('[data-key=right]')!.click();
  expect(find<HTMLInputElement>('limit-x-upper').value).toBe('5.0');
});

it('a limit beyond the device is not saved and says the device’s range', () => {
  find('take-all').click();
  find<HTMLInputElement>('limit-x-upper').value = '12';
  find('limit-x-upper').dispatchEvent(new Event('change'));
  find('save-limits').click();
  expect(fake.asked.some((request) => request.startsWith('PUT'))).toBe(false);
  expect(screen.element.textContent).toContain('The device goes from −8.5 to 8.5 cm.');
  expect(document.activeElement).toBe(find('limit-x-upper'));
});

it('the picture is told in words', () => {
  find('own-x').click();
  expect(screen.element.querySelector('[data-axis="x"] svg')!.getAttribute('aria-label')).toBe('x, away: device −8.5 – 8.5 cm, own movement −6.0 – 5.0 cm, limit −6.0 – 5.0 cm');
});
