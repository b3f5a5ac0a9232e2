// The alarm over every page: the robot does not answer, or has not obeyed a stop. It comes from the program, which knows
// when the loop last ticked (WorldState.silent), and it stays while the page hears nothing newer.
import type { Connection } from '../net/connection';
import type { WorldStateT } from '../protocol';
import { h, setText } from './dom';
import { hasHardware } from './hardware';
import { onLanguage, text } from './i18n';

/** The part of the state that the alarm depends on. */
export type AlarmState = Pick<WorldStateT, 'silent' | 'stopUnconfirmed' | 'device' | 'qM' | 'intention'>;

/** Whether a robot is behind the program; before the first tick of a session only `device` shows it. */
function hasRobot(state: AlarmState): boolean { return state.device !== null || hasHardware(state); }

/** The words of the alarm; empty: none. */
export function alarmWords(state: AlarmState | null): string {
  if (!state?.silent) return '';
  const words = text(hasRobot(state) ? 'silent.robot' : 'silent.simulation');
  return state.stopUnconfirmed ? `${text('silent.stop')} ${words}` : words;
}

/** The words of the alarm as a title and what follows it, for a bar that would stand empty beside the alarm. */
export function alarmTitle(state: AlarmState | null): [title: string, more: string] {
  const words = alarmWords(state), end = words.indexOf('. ');
  return end < 0 ? [words, ''] : [words.slice(0, end + 1), words.slice(end + 2)];
}

/** Shows the alarm over the page from now on. Presses go through it, so that it hides no button. */
export function showAlarm(connection: Connection): void {
  const element = h('div', { class: 'alarm-over', role: 'alert', 'data-testid': 'alarm' });
  const show = (): void => setText(element, alarmWords(connection.latestState));
  document.body.append(element);
  connection.on('state', show);
  onLanguage(show);
  show();
}
