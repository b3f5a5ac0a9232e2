// The settings of a clinic in a page without a screen: backup by hand, colleagues, the log.
// @vitest-environment happy-dom
import { readdirSync, readFileSync } from 'node:fs';
import { resolve } from 'node:path';
import { beforeEach, describe, expect, it, vi } from 'vitest';
import { Clinic } from '../src/clinic/clinic';
import { de } from '../src/clinic/i18n/de';
import { en } from '../src/clinic/i18n/en';
import { fr } from '../src/clinic/i18n/fr';
import type { ClinicContext } from '../src/clinic/clinic_context';
import { SettingsScreen } from '../src/clinic/settings_screen';
import { WhoScreen } from '../src/clinic/sign_in';
import { setLanguage } from '../src/shared/i18n';
import { FakeClinic } from './clinic_fake';

let fake: FakeClinic, clinic: Clinic, context: ClinicContext, screen: SettingsScreen;
const find = <T extends HTMLElement>(test: string): T => screen.element.querySelector<T>(`[data-testid="${test}"]`)!;
const type = (test: string, words: string): void => { find<HTMLInputElement>(test).value = words; };

beforeEach(async () => {
  setLanguage('en');
  fake = new FakeClinic(() => 1.8e15);
  fake.clinic = 'open';
  fake.tiles = [{ id: 1, name: 'A. Keller', colour: '#0B6B58', pin: '1234' }, { id: 2, name: 'B. Rossi', colour: '#1F5FC4', pin: '4321' }];
  fake.places = [...fake.places, { folder: '/media/anna/STICK', own: false, last_us: 0, free_bytes: 1e9 }];
  fake.log = [{ at_us: 1.8e15, account: 2, what: 'opened', code: 'P-001', visit: 0 }, { at_us: 1.7e15, account: 0, what: 'backed up', code: '', visit: 0 }];
  clinic = new Clinic('127.0.0.1', () => undefined, () => undefined, () => 0, fake.fetch);
  await clinic.signedIn(fake.signIn(1));
  await clinic.look(fake.fetch);
  context = { clinic } as ClinicContext;
  screen = new SettingsScreen(context);
});

it('a backup goes to a stick by one press, and its place is told', async () => {
  await vi.waitFor(() => expect(find('back-up-1')).not.toBeNull());
  expect(screen.element.textContent).toContain('STICK');
  find('back-up-1').click();
  await vi.waitFor(() => expect(find('backup-done').textContent).toBe('Backed up and read back: /media/anna/STICK/clinic-1.db'));
});

it('a stick that is plugged in later appears by itself', async () => {
  fake.places = fake.places.slice(0, 1);
  screen = new SettingsScreen(context);
  await vi.waitFor(() => expect(screen.element.textContent).toContain('Plug in a USB stick'));
  fake.places = [...fake.places, { folder: '/media/anna/BLUE', own: false, last_us: 0, free_bytes: 1e9 }];
  const now = vi.spyOn(performance, 'now').mockReturnValue(performance.now() + 10_000);
  screen.refresh();
  await vi.waitFor(() => expect(screen.element.textContent).toContain('BLUE'));
  now.mockRestore();
});

it('a colleague who has left stands on no tile, but at the notes', async () => {
  find('leave-2').click();
  find('leave-2-yes').click();
  await vi.waitFor(() => expect(clinic.state?.tiles[1].left).toBe(true));
  expect(find('leave-2')).toBeNull();
  clinic.signedOut();
  expect(new WhoScreen(context).element.textContent).not.toContain('B. Rossi');
});

it('nobody can take themselves off the list', () => { expect(find('leave-1')).toBeNull(); });

it('the PIN is changed with the present one only', async () => {
  type('pin-now', '9999');
  type('pin-new', '2468');
  find('change-pin').closest('form')!.requestSubmit();
  await vi.waitFor(() => expect(screen.element.textContent).toContain('Wrong PIN'));
  expect(fake.tiles[0].pin).toBe('1234');
  type('pin-now', '1234');
  find('change-pin').closest('form')!.requestSubmit();
  await vi.waitFor(() => expect(find('pin-changed').textContent).toBe('The new PIN holds from now on.'));
  expect(fake.tiles[0].pin).toBe('2468');
});

it('the log names people and codes', async () => {
  find('read-log').click();
  await vi.waitFor(() => expect(find('log')).not.toBeNull());
  expect(find('log').textContent).toContain('B. RossiopenedP-001');
  expect(find('log').textContent).toContain('the programdaily backup');
});

describe('the log has words', () => {
  const SOURCES = ['src/clinic', 'apps/clinic'].map((folder) => resolve(__dirname, '../..', folder));
  const text = SOURCES.flatMap((folder) => readdirSync(folder).filter((name) => name.endsWith('.cpp')).map((name) => readFileSync(resolve(folder, name), 'utf8'))).join('\n').replace(/"\s*"/g, '');
  const whats = new Set([...text.matchAll(/\b(?:log|tryToLog)\([\w.>\-()]+,\s*"([^"]+)"/g), ...text.matchAll(/INSERT INTO log [^;]*?0, '([^']+)'/g)].map(([, what]) => what!));
  it('of every entry that the records write', () => {
    expect(whats.size).toBeGreaterThan(25);
    for (const texts of [en, de, fr]) expect([...whats].filter((what) => texts.log.whats[what] === undefined)).toEqual([]);
  });
});
