// What is rarely done in the clinic, by its screens: a visit at the wrong patient, a double, an erasing, the recovery code.
// @vitest-environment happy-dom
import { beforeEach, expect, it, vi } from 'vitest';
import { Clinic } from '../src/clinic/clinic';
import type { ClinicContext } from '../src/clinic/clinic_context';
import { PatientScreen } from '../src/clinic/patient_screen';
import type { Route } from '../src/clinic/routes';
import { UnlockScreen } from '../src/clinic/sign_in';
import type { Screen } from '../src/clinic/ui';
import { setLanguage } from '../src/shared/i18n';
import { FakeClinic } from './clinic_fake';

let fake: FakeClinic, clinic: Clinic, context: ClinicContext, screen: Screen, told: string, went: Route | undefined;
const find = <T extends HTMLElement>(test: string): T => screen.element.querySelector<T>(`[data-testid="${test}"]`)!;
const seen = (test: string): Promise<void> => vi.waitFor(() => expect(find(test), test).not.toBeNull());
async function press(test: string): Promise<void> { await seen(test); find(test).click(); }

beforeEach(async () => {
  setLanguage('en');
  [told, went] = ['', undefined];
  fake = new FakeClinic(() => 1.8e15);
  fake.clinic = 'open';
  fake.tiles = [{ id: 1, name: 'A. Keller', colour: '#0B6B58', pin: '1234' }];
  clinic = new Clinic('127.0.0.1', () => undefined, () => undefined, () => 0, fake.fetch);
  await clinic.signedIn(fake.signIn(1));
  await clinic.look(fake.fetch);
  context = { clinic, go: (route: Route) => { went = route; }, showMessage: (words: string) => { told = words; } } as unknown as ClinicContext;
});

it('a moved visit is followed to its patient, and the page says so', async () => {
  const maria = fake.add({ name: 'Maria Huber' }), ben = fake.add({ name: 'Ben Frei' }), visit = fake.open(maria.id, 'right', maria.plan, 'done');
  screen = new PatientScreen(context, maria.id);
  for (const step of [`move-${visit.id}`, `pick-${ben.id}`, 'pick-yes']) await press(step);
  await vi.waitFor(() => expect(went).toEqual({ at: 'patient', patient: ben.id }));
  expect(told).toBe('The visit is now at Ben Frei, P-002.');
  expect(visit.patient).toBe(ben.id);
});

it('a double is joined, and the page says so', async () => {
  const maria = fake.add({ name: 'Maria Huber' }), double = fake.add({ name: 'Maria Hubert' });
  fake.open(double.id, 'right', double.plan, 'done');
  screen = new PatientScreen(context, maria.id);
  for (const step of ['merge', `pick-${double.id}`, 'pick-yes']) await press(step);
  await vi.waitFor(() => expect(told).toBe('Maria Hubert, P-002 was joined with this patient.'));
  await vi.waitFor(() => expect(find('visits').children).toHaveLength(1));
  expect(fake.patients).toEqual([maria]);
});

it('everything of a person is erased by the code of that person only', async () => {
  const maria = fake.add({ name: 'Maria Huber' });
  fake.add({ name: 'Ben Frei' });
  screen = new PatientScreen(context, maria.id);
  await seen('erase-code');
  const code = find<HTMLInputElement>('erase-code');
  code.value = 'P-002';
  await press('erase-yes');
  expect(screen.element.textContent).toContain('That is another code.');
  expect(fake.patients).toHaveLength(2);
  code.value = ' P-001 ';
  await press('erase-yes');
  await vi.waitFor(() => expect(went).toEqual({ at: 'patients' }));
  expect(fake.patients.map(({ name }) => name)).toEqual(['Ben Frei']);
});

it('the recovery code opens the records in place of the pass phrase; a wrong one does not', async () => {
  fake.clinic = 'locked';
  screen = new UnlockScreen(context);
  await press('unlock-other');
  for (const [code, opens] of [['TRAY-7KQM-WOLF-29XD-MINX', false], [` ${fake.code} `, true]] as const) {
    find<HTMLInputElement>('unlock-words').value = code;
    find('unlock').closest('form')!.requestSubmit();
    await vi.waitFor(() => expect(find('unlock').getAttribute('aria-busy')).toBeNull());
    expect(fake.clinic).toBe(opens ? 'open' : 'locked');
    if (!opens) expect(screen.element.textContent).toContain('That is not the pass phrase, nor the recovery code.');
  }
});
