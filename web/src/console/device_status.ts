import { ReleaseReason, type DeviceStateT } from '../protocol';
import { fill } from '../shared/i18n';
import { fixed } from '../shared/format';
import type { ConsoleTexts } from './i18n/en';

/** The shown fields of a real device. */
export type ReportedDevice = Pick<DeviceStateT, 'enabled' | 'homed' | 'silenced' | 'temperatureKnown' | 'temperatureC' | 'sampleAgeS' | 'hosted' | 'hostAgeS' | 'letGo'>;

/** The state of a real device in three lines. */
export interface DeviceLines {
  /** Enabled or not, homed or not. */
  state: string;
  /** Temperature, ages and work. */
  figures: string;
  /** Why the host disabled the device; empty if it did not. */
  letGo: string;
}

/** An age above this is shown in seconds [s]. */
const SECONDS_FROM_S = 1;

const REASONS: Readonly<Record<Exclude<ReleaseReason, ReleaseReason.None>, keyof ConsoleTexts['device']['reasons']>> = {
  [ReleaseReason.LoopSilent]: 'loopSilent',
  [ReleaseReason.SilentAtNeutral]: 'silentAtNeutral',
  [ReleaseReason.BadCommand]: 'badCommand',
  [ReleaseReason.LoopEnded]: 'loopEnded',
  [ReleaseReason.HostEnds]: 'hostEnds',
  [ReleaseReason.NeverCommanded]: 'neverCommanded',
};

function age(age_s: number, t: ConsoleTexts['device']): string {
  if (!(age_s >= 0)) return t.nothingYet;
  return age_s < SECONDS_FROM_S ? `${fixed(1e3 * age_s, 0)} ms` : `${fixed(age_s, 1)} s`;
}

/**
 * The lines, or undefined where the device is simulated. @param silent the loop or the device does not answer
 * @param work_j of the device in this session
 */
export function deviceLines(device: ReportedDevice | null | undefined, texts: ConsoleTexts, silent = false, work_j = 0): DeviceLines | undefined {
  if (!device) return undefined;
  const t = texts.device;
  const words = [device.enabled ? t.enabled : t.notEnabled, device.homed ? t.homed : t.notHomed];
  if (device.silenced) words.push(t.silenced);
  const temperature = device.temperatureKnown ? `${fixed(device.temperatureC, 0)} °C` : t.notKnown;
  const figures = [fill(t.temperature, { value: temperature }), fill(t.sample, { age: age(device.sampleAgeS, t) })];
  if (device.hosted) figures.push(fill(t.host, { age: age(device.hostAgeS, t) }));
  figures.push(fill(t.work, { value: fixed(work_j, 2) }));
  const reason = device.letGo === ReleaseReason.None ? undefined : REASONS[device.letGo];
  return { state: silent ? t.silent : words.join(', '), figures: figures.join(' · '), letGo: reason ? fill(t.letGo, { why: t.reasons[reason] }) : '' };
}
