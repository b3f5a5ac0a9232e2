import { exerciseWords } from '../console/title_words';
import { texts as consoleTexts } from '../console/i18n';
import { asWords, fixed, significant } from '../shared/format';
import { fill, language } from '../shared/i18n';
import { texts } from './i18n';
import { OWN_END } from './person_limits';
import { isCounting, timeOf_s, type Item, type Result, type Side, type Trial, type Visit } from './records';

/** The locale for dates, with European formats. */
export const locale = (): string => (language() === 'en' ? 'en-GB' : language());

/** A time in the visit's own time zone. */
const ofVisit = (t_us: number, offset_min: number): Date => new Date(t_us / 1000 + offset_min * 60_000);
const DAY = { weekday: 'short', day: 'numeric', month: 'short' } as const;
const CLOCK = { hour: '2-digit', minute: '2-digit', hour12: false } as const;

export const visitDay = ({ began_us, offset_min }: Pick<Visit, 'began_us' | 'offset_min'>): string =>
  ofVisit(began_us, offset_min).toLocaleDateString(locale(), { ...DAY, timeZone: 'UTC', ...(yearNow() === ofVisit(began_us, offset_min).getUTCFullYear() ? {} : { year: 'numeric' }) });
export const visitClock = ({ began_us, offset_min }: Pick<Visit, 'began_us' | 'offset_min'>): string =>
  ofVisit(began_us, offset_min).toLocaleTimeString(locale(), { ...CLOCK, timeZone: 'UTC' });

const yearNow = (): number => new Date().getFullYear();

/** The day of a time, in this machine's time zone. */
export function dayOf(t_us: number): string {
  const at = new Date(t_us / 1000), t = texts();
  if (at.toDateString() === new Date().toDateString()) return t.todayWord;
  return at.toLocaleDateString(locale(), at.getFullYear() === yearNow() ? DAY : { ...DAY, year: 'numeric' });
}
export const shortDay = (t_us: number): string => new Date(t_us / 1000).toLocaleDateString(locale(), { day: 'numeric', month: 'short' });
export const clock = (at: Date): string => at.toLocaleTimeString(locale(), CLOCK);
export const clockOf = (t_us: number): string => clock(new Date(t_us / 1000));

export const bornWords = (day: string): string => new Date(`${day}T00:00:00Z`).toLocaleDateString(locale(), { timeZone: 'UTC', day: 'numeric', month: 'long', year: 'numeric' });

export const sideWords = (side: Side): string => texts().sides[side];
export const itemWords = ({ exercise, level }: Pick<Item, 'exercise' | 'level'>): string => exerciseWords(exercise, level);
export const helpWords = (help: Item['help']): string => texts().helps[help];
export const minutes = (min: number): string => fill(texts().min, { n: fixed(min, min > 0 && min < 1 ? 1 : 0) });

/** A time of a visit in minutes; while a recording is being measured, that it is being counted. */
export const timeWords = (visit: Visit, time: Parameters<typeof timeOf_s>[1] = 'active_s'): string => (isCounting(visit) ? texts().patient.counting : minutes(timeOf_s(visit, time) / 60));
/** The active time of a visit, and the time in which the hand was led, if it was. */
export const activeWords = (visit: Visit): string =>
  isCounting(visit) ? timeWords(visit) : [`${timeWords(visit)} ${texts().patient.active}`, ...(timeOf_s(visit, 'led_s') > 0 ? [`${timeWords(visit, 'led_s')} ${texts().patient.led}`] : [])].join(', ');

/** The name of a limit, and its value in display units. */
export function parameterWords(name: string, value: number): readonly [name: string, value: string] {
  const label = consoleTexts().parameters.names[name] ?? asWords(name);
  if (name.endsWith('_rad')) return [label, `${fixed(value * 180 / Math.PI, 0)}°`];
  if (name.endsWith('_m')) return [label, `${fixed(value * 1000, 0)} mm`];
  if (name.endsWith('_l')) return [label, `${fixed(value * 1000, 0)} ml`];
  if (name.endsWith('_n')) return [label, `${number(value)} N`];
  if (name.endsWith('_s')) return [label, `${number(value)} s`];
  return [label, number(value)];
}

/** A number with up to three significant digits and no superfluous decimals. */
export const number = (value: number): string => significant(value, 3);

/** The name of a result as the exercise's panel has it; for an unknown exercise the raw name without its unit. */
export function resultName(name: string): string {
  const [, axis, end] = OWN_END.exec(name) ?? [];
  if (axis !== undefined) return `${consoleTexts().axesLong[axis] ?? asWords(axis)}, ${texts().limits.ends[end as 'lower' | 'upper'].toLowerCase()}`;
  return texts().results[name] ?? asWords(name.replace(/_(l|s|n|m|rad)$/, ''));
}
export const resultWords = ({ name, value, unit }: Result): string => `${resultName(name)} ${number(value)}${unit === '' ? '' : ` ${unit}`}`;
export const presetName = (id: string): string => texts().presets[id] ?? asWords(id);

/** The results of a trial in one line. */
export function trialWords(trial: Trial): string {
  const t = texts().patient;
  if (trial.state === 'waiting') return t.waiting;
  if (trial.state === 'failed') return fill(t.failedTrial, { why: trial.why ?? '' });
  return [
    ...trial.results.slice(0, 3).map(resultWords), ...(trial.helped_share ? [fill(t.helped, { share: Math.round(100 * trial.helped_share) })] : []),
    ...(trial.led_s ? [`${minutes(trial.led_s / 60)} ${t.led}`] : []), ...(trial.active_s === 0 && !trial.led_s ? [t.notByPerson] : []),
    ...(trial.ended_by === 'broken_off' ? [t.brokenOff] : trial.why ? [t.partly] : []), ...(trial.ended_by === 'fault' ? [t.endedByFault] : []),
  ].join(' · ');
}
