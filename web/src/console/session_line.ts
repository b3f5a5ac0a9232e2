import { fill, language } from '../shared/i18n';
import { h, say } from './dom';
import { texts } from './i18n';
import type { ConsoleModel, Panel } from './model';

const clock = (at: Date): string => at.toLocaleTimeString(language(), { hour: '2-digit', minute: '2-digit', hour12: false });

/** How long, how often, and after the end what is next: for whoever was called away, too. */
export class SessionLine implements Panel {
  private readonly now = h('b', { class: 'num' });
  private readonly tally = h('span', { class: 'num', 'data-testid': 'tally' });
  private readonly next = h('strong', { 'data-testid': 'what-next' });
  readonly element = h('p', { class: 'session-line' }, this.now, this.tally, this.next);

  constructor(private readonly model: ConsoleModel) { this.refresh(); }

  refresh(): void {
    const t = texts().sessionLine, { tally, status: { name }, state } = this.model;
    const { from, ended, active_s, repetitions } = tally;
    say(this.now, clock(new Date()));
    const words = { at: clock(ended ?? from ?? new Date()), min: Math.floor(active_s / 60), n: repetitions };
    say(this.tally, from ? fill(ended ? t.ended : t.since, words) : '');
    say(this.next, name === 'stopped' && state?.rested ? t.next.rested : t.next[name] ?? '');
  }
}
