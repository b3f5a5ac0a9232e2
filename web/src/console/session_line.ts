import { fill, language } from '../shared/i18n';
import { h, setText } from './dom';
import { texts } from './i18n';
import type { ConsoleModel, Panel } from './model';

const clock = (at: Date): string => at.toLocaleTimeString(language(), { hour: '2-digit', minute: '2-digit', hour12: false });

/** Duration and repetitions of the session, and the next step after its end. */
export class SessionLine implements Panel {
  private readonly now = h('b', { class: 'num' });
  private readonly counters = h('span', { class: 'num', 'data-testid': 'tally' });
  private readonly next = h('strong', { 'data-testid': 'what-next' });
  readonly element = h('p', { class: 'session-line' }, this.now, this.counters, this.next);

  constructor(private readonly model: ConsoleModel) { this.refresh(); }

  refresh(): void {
    const t = texts().sessionLine, { counters, status: { name }, state } = this.model;
    const { from, ended, active_s, repetitions } = counters;
    setText(this.now, clock(new Date()));
    const words = { at: clock(ended ?? from ?? new Date()), min: Math.floor(active_s / 60), n: repetitions };
    setText(this.counters, from ? fill(ended ? t.ended : t.since, words) : '');
    setText(this.next, name === 'stopped' && state?.rested ? t.next.rested : t.next[name] ?? '');
  }
}
