import { h } from '../console/dom';
import { fill } from '../shared/i18n';
import { texts } from './i18n';
import type { ClinicContext } from './page';
import { saveText } from './save_text';
import { COLOURS, colourChoice, goodPin, inColour } from './sign_in';
import { button, Field, once, panel, problemWords, StatusMessage, textInput, type Screen } from './ui';
import { clockOf, dayOf } from './words';

/** A backup older than this is reported [ms]. */
const OLD_MS = 2 * 86_400_000;

/** Accounts, backup, exports, and locking for the day. */
export class SettingsScreen implements Screen {
  readonly element = h('main', { class: 'settings' });
  private readonly t = texts().settings;
  private readonly backup = h('p', {});

  constructor(private readonly context: ClinicContext) {
    this.element.append(h('div', { class: 'col' }, this.people()), h('div', { class: 'col' }, panel(this.t.backup, 'backup', this.backup), this.exports(), this.leaving()));
    this.refresh();
  }

  who(): readonly [string, string] { return [texts().settings.title, '']; }

  refresh(): void {
    const { t } = this, backup = this.context.clinic.state?.backup;
    const old = !backup || backup.problem !== undefined || backup.last_us === 0 || Date.now() - backup.last_us / 1000 > OLD_MS;
    const words = !backup || backup.folder === '' ? t.noFolder : backup.last_us === 0 ? fill(t.noBackup, { folder: backup.folder }) : fill(t.lastBackup, { day: dayOf(backup.last_us), at: clockOf(backup.last_us), folder: backup.folder });
    this.backup.className = old ? 'warning' : '';
    const message = backup?.problem ? `${words} ${fill(t.backupProblem, { why: backup.problem })}` : words;
    if (this.backup.textContent !== message) this.backup.textContent = message;
  }

  private people(): HTMLElement {
    const { t, context: { clinic } } = this;
    const name = new Field(t.name, textInput('account-name', '', { maxlength: 60 }));
    const pin = new Field(texts().first.pin, textInput('account-pin', '', { type: 'password', inputmode: 'numeric', maxlength: 8, autocomplete: 'new-password' }), { hint: texts().first.pinHint });
    const colour = colourChoice(COLOURS[(clinic.state?.tiles.length ?? 0) % COLOURS.length]);
    const message = new StatusMessage();
    const list = h('ul', { class: 'people' });
    const show = (): void => list.replaceChildren(...(clinic.state?.tiles ?? []).map((tile) => h('li', {}, h('i', { style: inColour(tile.colour) }), tile.name)));
    const add = h('button', { type: 'submit', class: 'b go', 'data-testid': 'add-account' }, t.add);
    const form = h('form', {}, h('h3', {}, t.newPerson), name.element, colour.element, pin.element, message.element, add);
    form.addEventListener('submit', (event) => {
      event.preventDefault();
      name.refuse(name.input.value.trim() === '' ? texts().first.noName : '');
      pin.refuse(goodPin(pin.input.value) ? '' : texts().first.badPin);
      if ([name, pin].some(({ input }) => input.getAttribute('aria-invalid') === 'true')) return;
      void once(add, async () => {
        try {
          await clinic.api.send('POST', '/api/accounts', { name: name.input.value.trim(), colour: colour.value(), pin: pin.input.value });
          message.show('');
          name.input.value = pin.input.value = '';
          await clinic.look();
          show();
        } catch (problem) { message.showProblem(problem); }
      });
    });
    show();
    return panel(t.people, 'people', list, form);
  }

  private exports(): HTMLElement {
    const { t } = this;
    const message = new StatusMessage();
    const press = button(t.csvAll, 'csv-all', () => once(press, async () => {
      try { await saveText(this.context, '/api/export/all.csv', 'all.csv'); } catch (problem) { message.show(problemWords(problem)); }
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
