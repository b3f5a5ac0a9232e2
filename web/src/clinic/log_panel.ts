import { columns, h } from '../console/dom';
import { texts } from './i18n';
import { accountName } from './notes';
import type { ClinicContext } from './clinic_context';
import type { LogEntry } from './records';
import { action, button, panel, StatusMessage } from './ui';
import { clockOf, dayOf } from './words';

/** Entries that are shown at first; a second press shows all that were read. */
const FIRST = 20;

/** Who did what with the records, by the patients' codes. It is read when somebody asks for it. */
export class LogPanel {
  readonly element: HTMLElement;
  private readonly t = texts().log;
  private readonly list = h('div', {});
  private readonly message = new StatusMessage();

  constructor(private readonly context: ClinicContext) {
    const read = action(this.t.read, 'read-log', this.message, async () => {
      this.message.show('');
      this.show((await context.clinic.api.get<{ log: readonly LogEntry[] }>('/api/log')).log, FIRST);
    });
    this.element = panel(this.t.title, 'log', h('p', {}, this.t.words), this.message.element, h('div', { class: 'pair' }, read), this.list);
  }

  private show(log: readonly LogEntry[], first: number): void {
    const { t } = this, name = accountName(this.context);
    this.list.replaceChildren(h('table', { class: 'table', 'data-testid': 'log' }, columns([t.when, t.who, t.what, t.whose]),
      h('tbody', {}, ...log.slice(0, first).map(({ at_us, account, what, code }) => h('tr', {}, h('td', { class: 'num' }, `${dayOf(at_us)}, ${clockOf(at_us)}`), h('td', {}, account === 0 ? t.program : name(account)), h('td', {}, t.whats[what] ?? what), h('td', {}, code))))),
    ...(log.length > first ? [button(t.more, 'more-log', () => this.show(log, log.length), 'wide')] : []));
  }
}
