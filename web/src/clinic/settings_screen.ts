import { h } from '../console/dom';
import { fill } from '../shared/i18n';
import { BackupPanel } from './backup_panel';
import { texts } from './i18n';
import { keysPanel } from './keys_panel';
import { LogPanel } from './log_panel';
import type { ClinicContext } from './clinic_context';
import { PeoplePanel } from './people_panel';
import { saveText } from './save_text';
import { button, once, panel, problemWords, StatusMessage, type Screen } from './ui';

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
    const press = button(t.csvAll, 'csv-all', () => once(press, async () => {
      const timer = setInterval(() => void this.context.clinic.api.get<{ done: number; of: number }>('/api/export/progress').then(({ done, of }) => { if (of > 0) message.show(fill(t.exported, { done, of })); }, () => {}), 500);
      try {
        await saveText(this.context, '/api/export/all.csv', 'all.csv');
        message.show('');
      } catch (problem) { message.show(problemWords(problem)); } finally { clearInterval(timer); }
    }));
    return panel(t.export, 'export', h('p', {}, t.exportWords), message.element, press);
  }

  private leaving(): HTMLElement {
    const { t, context: { clinic } } = this;
    const message = new StatusMessage();
    const out = button(t.signOut, 'sign-out', () => once(out, async () => {
      await clinic.api.send('POST', '/api/sign_out').catch(() => {});
      clinic.signedOut();
    }));
    const lock = button(t.lock, 'lock', () => once(lock, async () => {
      try {
        await clinic.api.send('POST', '/api/lock');
        clinic.signedOut();
        await clinic.look();
      } catch (problem) { message.showProblem(problem); }
    }));
    return panel(t.leaving, 'leaving', h('p', {}, t.lockWords), message.element, h('div', { class: 'pair' }, out, lock));
  }
}
