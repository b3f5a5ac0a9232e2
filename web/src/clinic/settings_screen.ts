import { h } from '../console/dom';
import { fill } from '../shared/i18n';
import { BackupPanel } from './backup_panel';
import { texts } from './i18n';
import { keysPanel } from './keys_panel';
import { LogPanel } from './log_panel';
import type { ClinicContext } from './clinic_context';
import { PeoplePanel } from './people_panel';
import { saveText } from './save_text';
import { action, panel, StatusMessage, type Screen } from './ui';

/** Accounts, backup, exports, the log, and locking for the day. */
export class SettingsScreen implements Screen {
  readonly element = h('main', { class: 'settings' });
  private readonly t = texts().settings;
  private readonly backup: BackupPanel;

  constructor(private readonly context: ClinicContext) {
    this.backup = new BackupPanel(context);
    this.element.append(h('div', { class: 'col' }, new PeoplePanel(context).element, new LogPanel(context).element), h('div', { class: 'col' }, this.backup.element, this.exports(), keysPanel(context), this.leaving()));
  }

  who(): readonly [string, string] { return [texts().settings.title, '']; }

  refresh(): void { this.backup.refresh(); }

  private exports(): HTMLElement {
    const { t } = this;
    const message = new StatusMessage();
    const press = action(t.csvAll, 'csv-all', message, async () => {
      const timer = setInterval(() => void this.context.clinic.api.get<{ done: number; of: number }>('/api/export/progress').then(({ done, of }) => { if (of > 0) message.show(fill(t.exported, { done, of })); }, () => {}), 500);
      try {
        await saveText(this.context, '/api/export/all.csv', 'all.csv');
        message.show('');
      } finally { clearInterval(timer); }
    });
    return panel(t.export, 'export', h('p', {}, t.exportWords), message.element, press);
  }

  private leaving(): HTMLElement {
    const { t, context: { clinic } } = this;
    const message = new StatusMessage();
    const out = action(t.signOut, 'sign-out', message, async () => {
      await clinic.api.send('POST', '/api/sign_out').catch(() => {});
      clinic.signedOut();
    });
    const lock = action(t.lock, 'lock', message, async () => {
      await clinic.api.send('POST', '/api/lock');
      clinic.signedOut();
      await clinic.look();
    });
    return panel(t.leaving, 'leaving', h('p', {}, t.lockWords), message.element, h('div', { class: 'pair' }, out, lock));
  }
}
